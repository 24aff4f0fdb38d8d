"""Terms about the robot itself and its mission: avoidance, movement, progress, and the options it holds."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from clean_swarm_env.learning.observation.around import Around
from clean_swarm_env.learning.observation.term import AROUND_TERMS, TERMS, CompiledTerm, Observed, Term
from clean_swarm_env.learning.progress import MEMORY
from selforg.arrays import READ, Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.network.state import EXECUTING

FORGOTTEN = 0.37
"""What is left of one collision when the robot forgets it: 1/e, rounded up [-]."""


@AROUND_TERMS.term("avoidance", "avoidance_length", "avoiding")
def write_avoidance(around: Around, row: int, out: Floats) -> None:
    """Length of the avoidance vector by the reach of a pose, and whether the robot avoids others just now."""
    if around.avoidance >= 0:
        out[0] = min(around.readings[row, around.avoidance] / around.reach, 1.0)
    if around.avoiding >= 0:
        out[1] = around.marks[row, EXECUTING, around.avoiding]


@AROUND_TERMS.term("movement", "speed", "turn_rate")
def write_movement(around: Around, row: int, out: Floats) -> None:
    """Speed and turn rate of the drive, by the largest ones."""
    out[0] = min(around.speed[row] / around.max_speed[row], 1.0)
    out[1] = min(max(around.turn_rate[row] / around.max_turn_rate[row], -1.0), 1.0)


@AROUND_TERMS.term("time", "time_left")
def write_time(around: Around, row: int, out: Floats) -> None:
    """Share of the time limit that is left."""
    world = row // around.robots
    out[0] = max(1.0 - around.ticks[world] / around.limits[world], 0.0)


@AROUND_TERMS.term("idle", "idle")
def write_idle(around: Around, row: int, out: Floats) -> None:
    """Time since the robot last achieved something that its task counts, by `patience`."""
    out[0] = min(around.idle[row] / around.patience, 1.0)


@TERMS.register
class StopsTerm(Term):
    """One flag: no own collision within about two minutes, or some that did not stop the robot, or some that did; then
    how many, by `many`, and the share of this time for which they stopped it. What is counted fades.
    """  # noqa: D205

    name = "stops"
    components = ("collided_not", "collided_freely", "collided_stopped", "collisions", "stopped")

    def __init__(self, observed: Observed, *, many: float = 6.0) -> None:
        super().__init__(observed)
        self.many = many

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags, the number and the share."""
        progress = self.observed.progress
        collided, stopped = progress.collided[rows], progress.stopped[rows]
        recent = collided > FORGOTTEN
        flags = ~recent, recent & (stopped == 0.0), recent & (stopped > 0.0)
        share = stopped * self.observed.worlds.period / MEMORY
        for place, values in enumerate((*flags, np.minimum(collided / self.many, 1.0), np.minimum(share, 1.0))):
            out[place, rows] = values


@TERMS.register
class ModelTerm(Term):
    """One flag for each model of the mission's robots: is the robot of it?"""  # noqa: D400

    name = "model"
    _models: Annotated[Ints, "R", READ]

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        mission = observed.worlds.mission
        self.components = tuple(f"model_{model.model}" for model in mission.robots.models)
        self._models = np.tile(mission.models, observed.worlds.worlds)

    def write(self, rows: Ints, out: Floats) -> None:
        """Set the flag of the robot's model."""
        out[self._models[rows], rows] = 1.0


@AROUND_TERMS.register
class HoldsTerm(CompiledTerm):
    """One flag for each option of each coordinated goal: is it held?"""  # noqa: D400

    name = "holds"

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        goals = {coordinator.model.goal: coordinator.model.options for coordinator in observed.worlds.coordinators}
        several = len(goals) > 1  # then the goal is part of the name
        self.components = tuple(
            f"holds_{goal}_{option}" if several else f"holds_{option}" for goal in goals for option in goals[goal]
        )

    @staticmethod
    @inlined
    def write_row(around: Around, row: int, out: Floats) -> None:
        for goal in range(around.held.shape[0]):
            out[around.first_options[goal] + around.held[goal, row]] = 1.0
