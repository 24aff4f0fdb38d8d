"""Which goal of a mission a learner or a pilot chooses options for; the other goals keep what the expert rates highest.

Shapes: R rows, C goals that the mission coordinates, in the order of the robot's document.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.robot import GOAL
from selector.documents.errors import DocumentError
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from selforg.registry import unknown


class DecidedGoal:
    """One goal of a batch and its options as actions.

    Args:
        batch: the worlds.
        goal: name of the goal; `named_goal` chooses unless given.

    Attributes:
        problem: goal, options and scores; its features are all components of the observation.

    Raises:
        DocumentError: a goal that the mission does not coordinate, or a choice that has to be named.

    """

    def __init__(self, batch: Batch, goal: str | None = None) -> None:
        models = [coordinator.model for coordinator in batch.worlds.coordinators]
        name = named_goal([model.goal for model in models], goal)
        self._column = [model.goal for model in models].index(name)
        model = models[self._column]
        self.problem = Problem(model.goal, model.options, model.scores, batch.observer.names)
        self._default = batch.choices.default

    def actions(self, options: Ints) -> Ints:
        """Return the actions (R, C) of a batch in which `options` (R,) serve the goal."""
        actions = np.tile(self._default, (len(options), 1))
        actions[:, self._column] = options
        return actions


def named_goal(known: Sequence[str], wanted: str | None) -> str:
    """Return the goal that is wanted, else AvoidCollision, else the only one of those `known`."""
    if wanted is not None:
        if wanted not in known:
            raise DocumentError(f"goal: {unknown('goal', wanted, known)}")
        return wanted
    if GOAL in known or len(known) == 1:
        return GOAL if GOAL in known else known[0]
    raise DocumentError(f"goal: expected the name of one of {', '.join(known)}")
