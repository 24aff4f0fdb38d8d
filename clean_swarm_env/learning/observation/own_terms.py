"""Terms about the robot itself and its mission: avoidance, movement, progress, and the options it holds."""

from __future__ import annotations

from clean_swarm_env.learning.observation.task_terms import raise_flags
from clean_swarm_env.learning.observation.team_terms import write_shares
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.learning.progress import avoidance_column
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel


@TERMS.register
class AvoidanceTerm(Term):
    """Length of the avoidance vector by the reach of a pose, and whether the robot avoids others just now."""

    name = "avoidance"
    components = ("avoidance_length", "avoiding")

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        robots = observed.worlds.mission.robots
        self._reach = max(robots.pose_diffusion + robots.pose_goal_radius, 1e-9)  # [m]
        self._length = observed.worlds.network.model.sensor_index.get("rep_len", -1)
        self._avoiding = avoidance_column(observed.worlds)

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components; 0 in missions whose robots have no such sensor or coordinator."""
        network = self.observed.worlds.network
        if self._length >= 0:
            write_length(network.readings, self._length, rows, self._reach, out)
        if self._avoiding >= 0:
            write_avoiding(network.executing, self._avoiding, rows, out)


@lean_kernel
def write_length(readings: Floats, sensor: int, rows: Ints, reach: float, out: Floats) -> None:
    """Write the column `sensor` of `readings` (R, S), by `reach` [m], into the first line of `out` (2, R)."""
    for row in rows:
        out[0, row] = min(readings[row, sensor] / reach, 1.0)


@lean_kernel
def write_avoiding(executing: Ints, behaviour: int, rows: Ints, out: Floats) -> None:
    """Write the column `behaviour` of `executing` (R, B) into the second line of `out` (2, R)."""
    for row in rows:
        out[1, row] = float(executing[row, behaviour])


@TERMS.register
class MovementTerm(Term):
    """Speed and turn rate of the drive, by the largest ones."""

    name = "movement"
    components = ("speed", "turn_rate")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        worlds = self.observed.worlds
        drive, robots = worlds.drive, worlds.mission.robots
        write_movement(drive.speed, drive.turn_rate, rows, robots.max_speed, robots.max_turn_rate, out)


@lean_kernel
def write_movement(
    speed: Floats, turn_rate: Floats, rows: Ints, max_speed: float, max_turn_rate: float, out: Floats
) -> None:
    """Write the components of `MovementTerm` into `out` (2, R); speed (R,) [m/s] and turn rate (R,) [rad/s]."""
    for row in rows:
        out[0, row] = min(speed[row] / max_speed, 1.0)
        out[1, row] = min(max(turn_rate[row] / max_turn_rate, -1.0), 1.0)


@TERMS.register
class MissionTerm(Term):
    """Share of the items dumped of those that arrived, and of the time limit that is left."""

    name = "mission"
    components = ("garbage_done", "time_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        worlds, limits = self.observed.worlds, self.observed.progress.limits
        write_mission(worlds.garbage.done, worlds.garbage.arrived, worlds.ticks, limits, rows, out)


@lean_kernel
def write_mission(done: Ints, arrived: Ints, ticks: Ints, limits: Ints, rows: Ints, out: Floats) -> None:
    """Write the components of `MissionTerm` into `out` (2, R); the other arrays (W,), ticks and their `limits`."""
    robots = out.shape[1] // done.shape[0]
    for row in rows:
        world = row // robots
        out[0, row] = done[world] / max(arrived[world], 1)
        out[1, row] = max(1.0 - ticks[world] / limits[world], 0.0)


@TERMS.register
class IdleTerm(Term):
    """Time since the robot last picked, recycled or dumped something, by `patience`."""

    name = "idle"
    components = ("idle",)

    def __init__(self, observed: Observed, *, patience: float) -> None:
        super().__init__(observed)
        self._patience = max(patience / observed.worlds.period, 1.0)  # [ticks]

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_shares(self.observed.progress.idle[None], rows, self._patience, out)


@TERMS.register
class HoldsTerm(Term):
    """One flag for each option of each coordinated goal: is it held?"""  # noqa: D400

    name = "holds"

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        goals = {coordinator.model.goal: coordinator.model.options for coordinator in observed.worlds.coordinators}
        several = len(goals) > 1  # then the goal is part of the name
        self.components = tuple(
            f"holds_{goal}_{option}" if several else f"holds_{option}" for goal in goals for option in goals[goal]
        )

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        first = 0
        for coordinator in self.observed.worlds.coordinators:
            raise_flags(coordinator.held, rows, out[first:])
            first += len(coordinator.model.options)
