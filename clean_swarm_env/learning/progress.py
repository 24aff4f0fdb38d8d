"""What happened in the decision period that is running, counted tick by tick, and how long ago each robot got on.

Shapes: W worlds, N robots a world, R = W * N rows.
"""

from __future__ import annotations

import numpy as np

from clean_swarm_env.world.garbage import NOTHING
from clean_swarm_env.world.robot import GOAL
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Flags, Ints
from selforg.compiler.decorators import kernel

EVENTS = ("picked", "recycled", "dumped", "collision", "contact", "avoiding")
"""Rows of `Progress.events`: items picked, recycled and dumped by the robot, collision events in which it took part,
ticks at whose end somebody was closer than the collision distance, ticks in which it avoided others."""
PICKED, RECYCLED, DUMPED, COLLISION, CONTACT, AVOIDING = range(6)
RUNS, COMPLETED, TIMED_OUT = range(3)


class Progress:
    """Counts of a batch of worlds; what a world does after its mission is over does not count.

    Attributes:
        events: (E, R) int64, in the order of EVENTS, since the beginning of the period.
        ticks: (W,) int64, ticks of the period that counted.
        dumped: (W,) int64, items that the team dumped since the beginning of the period.
        elapsed: (W,) int64, ticks since the mission began, up to its end.
        outcome: (W,) int64, RUNS, COMPLETED (all garbage dumped) or TIMED_OUT.
        limits: (W,) int64, ticks after which each mission is over.
        took_part: (R,) bool, robots that were at work in the period.
        idle: (R,) int64, ticks since the robot last picked, recycled or dumped, or since the mission began.
        ended: (K,) int64, worlds whose missions ended with the last tick.

    """

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self._avoiding = avoidance_column(worlds)
        self.limits: Ints = np.ones(worlds.worlds, dtype=np.int64)
        self.events: Ints = np.zeros((len(EVENTS), worlds.rows), dtype=np.int64)
        self.ticks: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.dumped: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.elapsed: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.outcome: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.took_part: Flags = np.zeros(worlds.rows, dtype=np.bool_)
        self.idle: Ints = np.zeros(worlds.rows, dtype=np.int64)
        self._cargo: Ints = np.full(worlds.rows, NOTHING, dtype=np.int64)
        self._recycled: Ints = np.zeros(worlds.rows, dtype=np.int64)
        self._ended: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.ended = self._ended[:0]
        self._done: Ints = np.zeros(worlds.worlds, dtype=np.int64)

    def reset(self, world: int) -> None:
        """Begin anew with a world that has just been reset."""
        mission, rows = self._worlds.missions[world], self._worlds.rows_of(world)
        self.limits[world] = max(round(mission.time_limit * mission.world.control_rate), 1)
        self.outcome[world] = RUNS
        self.idle[rows] = 0
        self._cargo[rows] = self._worlds.garbage.cargo[rows]
        self._recycled[rows] = self._worlds.garbage.recycled[rows]
        self._done[world] = self._worlds.garbage.done[world]

    def stay(self, world: int) -> None:
        """Let a world that has nothing to do count no more until it is reset; how its last mission ended remains."""
        if self.outcome[world] == RUNS:
            self.outcome[world] = TIMED_OUT

    def begin_period(self) -> None:
        """Set the counts of the period to zero."""
        for counts in (self.events, self.ticks, self.dumped):
            counts.fill(0)
        np.copyto(self.took_part, self._worlds.team.working)

    def note(self, entered: Ints) -> bool:
        """Count what the last tick brought, `entered` (R,) being its collision events; return whether missions ended.

        A mission that ended stays ended, and counts no more, until its world is reset.
        """
        worlds, garbage = self._worlds, self._worlds.garbage
        count = count_tick(
            entered, worlds.collisions.in_contact, worlds.network.executing, self._avoiding, garbage.cargo,
            garbage.recycled, garbage.done, worlds.team.working, worlds.cleaned, worlds.ticks, self.limits,
            self._cargo, self._recycled, self._done, self.events, self.ticks, self.dumped, self.elapsed, self.outcome,
            self.took_part, self.idle, self._ended,
        )  # fmt: skip
        self.ended = self._ended[:count]
        return count > 0


def avoidance_column(worlds: Worlds) -> int:
    """Return which behaviour of the robots' networks is the coordinator that avoids others; -1 without one."""
    return next((coordinator.index for coordinator in worlds.coordinators if coordinator.model.goal == GOAL), -1)


@kernel
def count_tick(
    entered: Ints, in_contact: Flags, executing: Ints, avoidance: int, cargo: Ints, recycled: Ints, done: Ints,
    working: Flags, cleaned: Flags, ticks: Ints, limits: Ints, had: Ints, had_recycled: Ints, had_done: Ints,
    events: Ints, counted: Ints, dumped_now: Ints, elapsed: Ints, outcome: Ints, took_part: Flags,
    idle: Ints, ends: Ints,
) -> int:  # fmt: skip
    """Add one tick to `events` (E, R) of the worlds that run; list those that end and return their number.

    executing (R, B): `avoidance` is the column of avoiding, -1 without one. A robot that is not `working` (R,) has lost
    its cargo, not dumped it. had, had_recycled (R,) and had_done (W,): cargo and items done at the tick before.
    """
    ended = 0
    robots = cargo.shape[0] // outcome.shape[0]
    for world in range(outcome.shape[0]):
        if outcome[world] != RUNS:
            continue
        counted[world] += 1
        for row in range(world * robots, (world + 1) * robots):
            picked = had[row] == NOTHING and cargo[row] != NOTHING
            dumped = working[row] and had[row] != NOTHING and cargo[row] == NOTHING and had_recycled[row] == 1
            reworked = cargo[row] != NOTHING and not picked and recycled[row] > had_recycled[row]
            took_part[row] |= working[row]
            idle[row] = 0 if picked or dumped or reworked else idle[row] + 1
            events[PICKED, row] += picked
            events[RECYCLED, row] += reworked
            events[DUMPED, row] += dumped
            events[COLLISION, row] += entered[row]
            events[CONTACT, row] += in_contact[row]
            if avoidance >= 0:
                events[AVOIDING, row] += executing[row, avoidance]
            had[row] = cargo[row]
            had_recycled[row] = recycled[row]
        dumped_now[world] += done[world] - had_done[world]
        had_done[world] = done[world]
        elapsed[world] = ticks[world]
        completed = cleaned[world]
        if completed or ticks[world] >= limits[world]:
            outcome[world] = COMPLETED if completed else TIMED_OUT
            ends[ended] = world
            ended += 1
    return ended
