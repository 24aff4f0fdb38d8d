"""Counts of the events in a decision period, tick by tick, and the time since each robot last achieved something.

Shapes: W worlds, N robots a world, R = W * N rows, E kinds of events.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.world.cleaning_robot import GOAL
from clean_swarm_env.world.garbage import NOTHING
from clean_swarm_env.world.mission_end import RUNNING, TIME_OVER, mission_state, tick_limit
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Flags, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Recording, Words

EVENTS = ("picked", "recycled", "dumped", "collision", "contact", "avoiding")
"""Rows of `Period.events`: items picked, recycled and dumped by the robot, collision events in which it took part,
ticks at whose end another robot was closer than the collision distance, ticks in which it avoided others."""
PICKINGS, RECYCLINGS, DUMPINGS, COLLISIONS, CONTACTS, AVOIDINGS = range(6)


class Period(NamedTuple):
    """The counts of a decision period."""

    events: Annotated[Ints, "E R"]  # in the order of EVENTS
    ticks: Annotated[Ints, "W"]  # ticks that counted
    dumped: Annotated[Ints, "W"]  # items that the team dumped
    outcome: Annotated[Ints, "W"]  # RUNNING, COMPLETED (all garbage dumped) or TIME_OVER, at the end
    took_part: Annotated[Flags, "R"]  # robots that were at work


class Followed(NamedTuple):
    """Arrays of the worlds, and their values at the tick before, from which events are counted."""

    working: Annotated[Flags, "R"]  # robots at work
    in_contact: Annotated[Flags, "R"]  # another robot is closer than the collision distance
    cargo: Annotated[Ints, "R"]  # item that the robot carries, NOTHING without one
    recycled: Annotated[Ints, "R"]  # 1 where the cargo has been recycled
    done: Annotated[Ints, "W"]  # items dumped
    had: Annotated[Ints, "R"]  # cargo at the tick before
    had_recycled: Annotated[Ints, "R"]  # recycled at the tick before
    had_done: Annotated[Ints, "W"]  # done at the tick before
    limits: Annotated[Ints, "W"]  # ticks after which each mission is over
    elapsed: Annotated[Ints, "W"]  # ticks since the mission began, up to its end
    idle: Annotated[Ints, "R"]  # ticks since the robot last picked, recycled or dumped, or since the mission began
    ended: Annotated[Ints, "W"]  # the first of them: worlds whose missions ended with the last tick


PERIOD_RECORD = Recording(Period)
FOLLOWED_RECORD = Recording(Followed)
open_period, open_followed = PERIOD_RECORD.open, FOLLOWED_RECORD.open


class MissionProgress:
    """Counts of a batch of worlds. A world whose mission is over counts no more.

    Attributes:
        period: the record `Period`, with its words; its arrays are attributes here too: `events` (E, R), `ticks` (W,),
            `dumped` (W,), `outcome` (W,), `took_part` (R,).
        elapsed: (W,) int64, ticks since the mission began, up to its end.
        limits: (W,) int64, ticks after which each mission is over.
        idle: (R,) int64, ticks since the robot last picked, recycled or dumped, or since the mission began.
        ended: (K,) int64, worlds whose missions ended with the last tick.

    """

    def __init__(self, worlds: Worlds) -> None:
        def numbers(*shape: int) -> Ints:
            return np.zeros(shape, dtype=np.int64)

        self._worlds = worlds
        self._avoiding = avoidance_column(worlds)
        count, rows, garbage = worlds.worlds, worlds.rows, worlds.garbage
        self.events, self.ticks, self.dumped = numbers(len(EVENTS), rows), numbers(count), numbers(count)
        self.outcome, self.took_part = numbers(count), np.zeros(rows, dtype=np.bool_)
        self.period = PERIOD_RECORD.pack(Period(self.events, self.ticks, self.dumped, self.outcome, self.took_part))
        self.limits, self.elapsed, self.idle = numbers(count) + 1, numbers(count), numbers(rows)
        self.ended: Ints = numbers(0)
        self._followed = FOLLOWED_RECORD.pack(
            Followed(
                working=worlds.team.working,
                in_contact=worlds.collisions.in_contact,
                cargo=garbage.cargo,
                recycled=garbage.recycled,
                done=garbage.done,
                had=numbers(rows) + NOTHING,
                had_recycled=numbers(rows),
                had_done=numbers(count),
                limits=self.limits,
                elapsed=self.elapsed,
                idle=self.idle,
                ended=numbers(count),
            )
        )

    def reset(self, world: int) -> None:
        """Begin the counts of a world that has just been reset."""
        mission, rows, followed = self._worlds.missions[world], self._worlds.rows_of(world), self._followed.record
        self.limits[world] = tick_limit(mission)
        self.outcome[world] = RUNNING
        self.idle[rows] = 0
        followed.had[rows] = followed.cargo[rows]
        followed.had_recycled[rows] = followed.recycled[rows]
        followed.had_done[world] = followed.done[world]

    def of_rows(self) -> tuple[Ints, ...]:
        """Return what robots hand on to the next period: arrays (R,)."""
        return self.idle, self._followed.record.had, self._followed.record.had_recycled

    def of_worlds(self) -> tuple[Ints, ...]:
        """Return what worlds hand on to the next period: arrays (W,)."""
        return self.limits, self.elapsed, self.outcome, self._followed.record.had_done

    def stay(self, world: int) -> None:
        """Stop counting a world without a next scenario until it is reset; its last outcome remains."""
        if self.outcome[world] == RUNNING:
            self.outcome[world] = TIME_OVER

    def begin_period(self) -> None:
        """Set the counts of the period to zero."""
        for counts in (self.events, self.ticks, self.dumped):
            counts.fill(0)
        np.copyto(self.took_part, self._worlds.team.working)

    def note(self, entered: Ints) -> bool:
        """Count the last tick, whose collision events are `entered` (R,); return whether missions ended.

        A mission that ended counts no more until its world is reset.
        """
        worlds, executing = self._worlds, self._worlds.network.executing
        avoids = executing[:, self._avoiding] if self._avoiding >= 0 else np.zeros_like(entered)
        count = count_tick(self.period.words, self._followed.words, entered, avoids, worlds.cleaned, worlds.ticks)
        self.ended = self._followed.record.ended[:count]
        return count > 0


def avoidance_column(worlds: Worlds) -> int:
    """Return which behaviour of the robots' networks is the coordinator that avoids others; -1 without one."""
    return next((coordinator.index for coordinator in worlds.coordinators if coordinator.model.goal == GOAL), -1)


@lean_kernel
def count_tick(
    period: Words[Period], followed: Words[Followed], entered: Ints, avoids: Ints, cleaned: Flags, ticks: Ints
) -> int:
    """Add one tick to the period of the worlds that run; list those that end and return their number.

    entered, avoids (R,): collision events of the robot, and whether it avoids others. cleaned, ticks (W,): whether the
    world is clean for good, and ticks since its reset. A robot that does not work has lost its cargo, not dumped it.
    """
    p, f = open_period(period), open_followed(followed)
    ended, robots = 0, f.cargo.shape[0] // ticks.shape[0]
    for world in range(ticks.shape[0]):
        if p.outcome[world] != RUNNING:
            continue
        p.ticks[world] += 1
        for row in range(world * robots, (world + 1) * robots):
            picked = f.had[row] == NOTHING and f.cargo[row] != NOTHING
            lost = f.had[row] != NOTHING and f.cargo[row] == NOTHING
            dumped = f.working[row] and lost and f.had_recycled[row] == 1
            recycled = f.cargo[row] != NOTHING and not picked and f.recycled[row] > f.had_recycled[row]
            p.took_part[row] |= f.working[row]
            f.idle[row] = 0 if picked or dumped or recycled else f.idle[row] + 1
            p.events[PICKINGS, row] += picked
            p.events[RECYCLINGS, row] += recycled
            p.events[DUMPINGS, row] += dumped
            p.events[COLLISIONS, row] += entered[row]
            p.events[CONTACTS, row] += f.in_contact[row]
            p.events[AVOIDINGS, row] += avoids[row]
            f.had[row] = f.cargo[row]
            f.had_recycled[row] = f.recycled[row]
        p.dumped[world] += f.done[world] - f.had_done[world]
        f.had_done[world] = f.done[world]
        f.elapsed[world] = ticks[world]
        p.outcome[world] = mission_state(cleaned[world], ticks[world], f.limits[world])
        if p.outcome[world] != RUNNING:
            f.ended[ended] = world
            ended += 1
    return ended
