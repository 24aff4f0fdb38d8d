"""The goal of a mission for which a learner or a pilot chooses options; other goals keep the option of highest score.

Shapes: R rows, C goals that the mission coordinates, in the order of the robot's document.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.cleaning_robot import GOAL
from selector.documents.errors import DocumentError
from selforg.arrays import Ints
from selforg.registry import unknown
from train.running.model_pilots import VectorPilot
from train.running.pilots import AnyPilot


class DecidedGoal:
    """One goal of a batch and its options as actions.

    Args:
        batch: the worlds.
        goal: name of the goal; the goal that `named_goal` returns unless given.

    Attributes:
        problem: goal, options and scores; the features are all components of the observation.

    Raises:
        DocumentError: the mission does not coordinate the goal, or has several goals of which none is named.

    """

    def __init__(self, batch: Batch, goal: str | None = None) -> None:
        models = {coordinator.model.goal: coordinator.model for coordinator in batch.worlds.coordinators}
        name = named_goal(tuple(models), goal)
        self._column = list(models).index(name)
        self.problem = models[name].problem(batch.observer.names)
        self._default, self._recorder = batch.choices.default, batch.recorder

    def decide(self, pilot: AnyPilot, observations: Observations) -> NDArray[Any]:
        """Return the actions of a batch whose pilot sees `observations` (R, F); a recording notes its opinions."""
        if isinstance(pilot, VectorPilot):
            return pilot.choose(observations)
        options = pilot.choose(observations)
        if self._recorder is not None:
            self._recorder.think(self.problem.goal, pilot.opinions())
        return self.actions(options)

    def actions(self, options: Ints) -> Ints:
        """Return the actions (R, C) of a batch in which `options` (R,) serve the goal."""
        actions = np.tile(self._default, (len(options), 1))
        actions[:, self._column] = options
        return actions


def named_goal(known: Sequence[str], wanted: str | None) -> str:
    """Return the goal `wanted` if given, else AvoidCollision if it is `known`, else the only known goal."""
    if wanted is not None:
        if wanted not in known:
            raise DocumentError(f"goal: {unknown('goal', wanted, known)}")
        return wanted
    if GOAL in known or len(known) == 1:
        return GOAL if GOAL in known else known[0]
    raise DocumentError(f"goal: expected the name of one of {', '.join(known)}")
