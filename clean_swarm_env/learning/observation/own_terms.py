"""Terms about the robot itself and its mission: avoidance, movement, progress, and the options it holds."""

from __future__ import annotations

from clean_swarm_env.learning.observation.around import Around, open_around
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm, Observed
from selforg.arrays import Floats
from selforg.compiler.decorators import part
from selforg.compiler.records import Words
from selforg.network.state.state import EXECUTING


@TERMS.register
class AvoidanceTerm(CompiledTerm):
    """Length of the avoidance vector by the reach of a pose, and whether the robot avoids others just now."""

    name = "avoidance"
    components = ("avoidance_length", "avoiding")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        if a.avoidance >= 0:
            out[0] = min(a.readings[row, a.avoidance] / a.reach, 1.0)
        if a.avoiding >= 0:
            out[1] = a.marks[row, EXECUTING, a.avoiding]


@TERMS.register
class MovementTerm(CompiledTerm):
    """Speed and turn rate of the drive, by the largest ones."""

    name = "movement"
    components = ("speed", "turn_rate")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0] = min(a.speed[row] / a.max_speed, 1.0)
        out[1] = min(max(a.turn_rate[row] / a.max_turn_rate, -1.0), 1.0)


@TERMS.register
class MissionTerm(CompiledTerm):
    """Share of the items dumped of those that arrived, and of the time limit that is left."""

    name = "mission"
    components = ("garbage_done", "time_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        world = row // (a.present.shape[0] // a.team.shape[0])
        out[0] = a.done[world] / max(a.arrived[world], 1)
        out[1] = max(1.0 - a.ticks[world] / a.limits[world], 0.0)


@TERMS.register
class IdleTerm(CompiledTerm):
    """Time since the robot last picked, recycled or dumped something, by `patience`."""

    name = "idle"
    components = ("idle",)

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0] = min(a.idle[row] / a.patience, 1.0)


@TERMS.register
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
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        for goal in range(a.held.shape[0]):
            out[a.first_options[goal] + a.held[goal, row]] = 1.0
