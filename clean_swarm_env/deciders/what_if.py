"""What if: the next seconds of a mission for each option that one robot could take, in a copy of the world.

The copy has the random numbers of its world, and the other robots decide as they do there. So what is foretold is what
then happens if the robot takes the option and nothing else is done by hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import Decider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission_end import RUNNING
from selector.documents.fields import JOINT
from selforg.arrays import Ints

FORETOLD: Final = 5.0
"""Time that is foretold [s]."""


def actions_of(decided: DecidedGoal, decider: Decider, observations: Observations, by_hand: Ints) -> NDArray[Any]:
    """Return the actions of rows that do what a decider says, or hold the options (R,) `by_hand`, -1 for none."""
    actions, held = decided.decide(decider, observations), by_hand >= 0
    if held.any():
        actions[held, : decided.goals] = decided.actions(by_hand[held])
    return actions


class WhatIf:
    """Foretells what one robot of the only world of a batch brings about by each option.

    Args:
        batch: the world; its mission goes on as if nobody had asked.
        decided: the goals that are decided in it.
        observation, directories: those of the batch.

    Raises:
        ConfigurationError: its robots are driven, and hold no options.

    """

    def __init__(
        self,
        batch: Batch,
        decided: DecidedGoal,
        observation: ObservationConfig | None,
        directories: tuple[Path, ...] = (),
    ) -> None:
        if batch.action.mode == "velocity":
            raise ConfigurationError("what if: expected robots that hold options, got robots that are driven")
        self._batch, self._decided = batch, decided
        self._copy = Batch(
            batch.mission,
            begin_anew=False,
            observation=observation,
            action=batch.action,
            directories=directories,
            explained=batch.worlds.network.explained,
        )
        self._ahead = DecidedGoal(self._copy, JOINT.join(decided.names))

    def options(self, robot: int, decider: Decider, observations: Observations, by_hand: Ints) -> list[dict[str, Any]]:
        """Return for each option of the first goal what happens within `FORETOLD` if a robot takes it now.

        `decider`, `observations` (R, F) and `by_hand` (R,) are those with which the batch would go on.
        """
        worlds = self._batch.worlds
        if not 0 <= robot < worlds.robots or not worlds.team.working[robot]:
            raise ConfigurationError(f"robot {robot}: expected a robot at work")
        state, told = self._batch.get_state(), []
        for option in self._decided.parts[0]:
            self._copy.set_state(state)
            held = by_hand.copy()
            held[robot] = self._decided.number_of(option)
            self._ahead.hold(np.array([robot]), held[robot])
            told.append({"option": option, **self._foretold(robot, deepcopy(decider), observations, held)})
        return told

    def _foretold(self, robot: int, decider: Decider, observations: Observations, held: Ints) -> dict[str, Any]:
        """Return what the copy does next: way of the robot, collisions, items, cost, and the measures at the end."""
        copy, worlds = self._copy, self._copy.worlds
        before, own, path = self._figures(), 0, [worlds.physics.positions[robot].tolist()]
        for _ in self._ticks(decider, observations, held):
            own += int(worlds.collisions.entered_in_tick[robot])
            path.append(worlds.physics.positions[robot].tolist())
        collisions, items, cost = (after - first for after, first in zip(self._figures(), before, strict=True))
        measures = {name: float(values[0]) for name, values in worlds.task.result().items()}
        return {
            "seconds": round((len(path) - 1) * copy.period, 9),
            "collisions": int(collisions),
            "own_collisions": own,
            "items": int(items),
            "cost_s": round(cost, 9),
            "path": path,
            **({"measures": measures} if measures else {}),
        }

    def _figures(self) -> tuple[float, ...]:
        """Return collisions and items of the copy so far, and what it has cost [s]."""
        worlds, task = self._copy.worlds, self._copy.worlds.task
        items = sum(int(count[0]) for count in task.totals().values())
        return int(worlds.collisions.events[0, 0]), items, task.cost_so_far(0, task.result())

    def _ticks(self, decider: Decider, observations: Observations, held: Ints) -> Iterator[None]:
        """Run the copy for the time that is foretold, or to the end of the mission; yield after each control period."""
        copy, left = self._copy, round(FORETOLD / self._copy.period)
        per = round(copy.decision_period / copy.period)
        begun = int(copy.worlds.ticks[0])
        for _ in range(min(-begun % per, left)):  # up to the end of the period
            copy.tick()
            left -= 1
            yield
            if copy.progress.outcome[0] != RUNNING:
                return
        if begun and left:
            observations = copy.end_period().observations
        while left and copy.progress.outcome[0] == RUNNING:
            for _ in copy.ticks(actions_of(self._ahead, decider, observations, held)):
                left -= 1
                yield
                if not left:
                    return
            observations = copy.end_period().observations
