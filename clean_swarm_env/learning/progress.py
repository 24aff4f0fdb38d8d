"""Counts of the events in a decision period, and its cost, tick by tick; the time since each robot achieved something.

What robots achieve, and what a tick costs, their task says: see `MissionCounts`.

Shapes: W worlds, N robots a world, R = W * N rows, A achievements of the task, E = A + 3 kinds of events.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.physics.clock import Ticks, open_ticks
from clean_swarm_env.physics.collisions import Counts, open_counts
from clean_swarm_env.world.mission_end import RUNNING, TIME_OVER, mission_state
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel, long_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.declared import arrays_of
from selforg.network.state import EXECUTING, RowStates, open_states
from selforg.program import COUNTING, FINISHING, Rows, Step

EVENTS = ("collision", "contact", "avoiding")
"""The last rows of `Period.events`, behind the achievements of the task: collision events in which the robot took part,
ticks at whose end another robot was closer than the collision distance, ticks in which it avoided others."""
COLLISIONS, CONTACTS, AVOIDINGS = -3, -2, -1

MEMORY = 120.0
"""Time after which 1/e is left of what a robot remembers of its collisions [s]."""


class Period(NamedTuple):
    """The counts of a decision period."""

    events: Annotated[Ints, "E R", SCRATCH]  # the task's achievements in their order, then EVENTS
    team: Annotated[Ints, "A W", SCRATCH]  # achievements of the team
    ticks: Annotated[Ints, "W", SCRATCH]  # ticks that counted
    outcome: Annotated[Ints, "W", KEPT]  # RUNNING, COMPLETED (the task is done) or TIME_OVER, at the end
    took_part: Annotated[Flags, "R", SCRATCH]  # robots that were at work
    cost: Annotated[Floats, "W", SCRATCH]  # what the period added to the cost of the mission, without collisions [s]
    price: Annotated[Floats, "W", SCRATCH]  # what its collisions added [s]
    bumps: Annotated[Floats, "R", SCRATCH]  # price of the robot's collisions, one by one: its share of `price`


class Followed(NamedTuple):
    """Arrays of the worlds from which events are counted, and counts that go on from period to period."""

    working: Annotated[Flags, "R", READ]  # robots at work
    limits: Annotated[Ints, "W", READ]  # ticks after which each mission is over
    elapsed: Annotated[Ints, "W", KEPT]  # ticks since the mission began, up to its end
    idle: Annotated[Ints, "R", KEPT]  # ticks since the robot last achieved something, or since the mission began
    counts: Annotated[Flags, "W", SCRATCH]  # worlds in which the last tick counted
    ended: Annotated[Ints, "W", SCRATCH]  # the first of them: worlds whose missions ended with the last tick
    standing: Annotated[Ints, "R", READ]  # ticks for which a collision stops the robot, that of the collision included
    collided: Annotated[Floats, "R", KEPT]  # the robot's collision events, which fade
    stopped: Annotated[Floats, "R", KEPT]  # ticks for which they stopped it, which fade alike
    fading: float  # factor by which both shrink in a tick
    done: Annotated[Flags, "W", SCRATCH]  # worlds whose task is done
    number: Annotated[Ints, "1", SCRATCH]  # number of worlds in `ended`
    avoiding: int  # behaviour of the network that avoids others, -1 for none
    coordinated: Annotated[Ints, "C", READ]  # behaviours that are coordinators
    acted: Annotated[Flags, "R C", SCRATCH]  # whether each of these ran in the period


open_period, open_followed = opening(Period), opening(Followed)


class MissionCounts:
    """Counts what robots achieve, by `Task.achieved`, and how `Task.cost` grows where the task is priced.

    A task may have a class of its own in this place, `Task.Counts`, which writes into the records.
    """

    _cost: Annotated[Floats, "W", KEPT]  # of each mission at the tick before [s]

    def __init__(self, worlds: Worlds, period: Packed[Period], followed: Packed[Followed]) -> None:
        self._worlds, self._period, self._followed = worlds, period, followed
        self._cost = np.zeros(worlds.worlds)

    def reset(self, world: int) -> None:
        """Begin the counts of a world that has just been reset."""
        if self._worlds.task.priced:
            self._cost[world] = self._worlds.task.cost(world, self._worlds.task.result())

    def finishing(self) -> Step:
        """Return the step that notes which worlds are done, before a tick is counted."""
        done, task = self._followed.record.done, self._worlds.task
        return Step(COUNTING, lambda now, _: np.copyto(done, task.done()), Rows.of(self._worlds.world.every_row))

    def counting(self) -> Step:
        """Return the step that adds what a tick brought in worlds where it counts."""
        return Step(COUNTING, lambda now, _: self._count(), Rows.of(self._worlds.world.every_row))

    def _count(self) -> None:
        task, period, followed = self._worlds.task, self._period.record, self._followed.record
        idle, counts = followed.idle, followed.counts
        achieved = task.achieved()
        for number, achievement in enumerate(task.achievements):
            times = np.where(counts[self._worlds.world.of_row], achieved[achievement.name], 0)
            period.events[number] += times
            period.team[number] += self._worlds.world.by_world(times).sum(axis=1)
            idle[times > 0] = 0
        for world in np.flatnonzero(counts).tolist() if task.priced else ():
            cost = task.cost(world, task.result())
            period.cost[world] += cost - self._cost[world]
            self._cost[world] = cost


class MissionProgress:
    """Counts of a batch of worlds. A world whose mission is over counts no more.

    Attributes:
        period: the record `Period`, with its handle; its arrays are attributes here too: `events` (E, R), `team`
            (A, W), `ticks` (W,), `outcome` (W,), `took_part` (R,), `cost` (W,), `price` (W,), `bumps` (R,).
        acted: (R, C) bool, whether the behaviour of each coordinated goal ran in the period.
        elapsed: (W,) int64, ticks since the mission began, up to its end.
        idle: (R,) int64, ticks since the robot last achieved something, or since the mission began.
        ended: (K,) int64, worlds whose missions ended with the last tick.
        collided: (R,) float64, collision events of the robot in this mission, which fade: 1/e is left after MEMORY.
        stopped: (R,) float64, ticks for which they stopped the robot, which fade alike.

    """

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        count, rows, achievements = worlds.worlds, worlds.rows, len(worlds.task.achievements)
        coordinated = np.array([coordinator.index for coordinator in worlds.coordinators], dtype=np.int64)
        sizes = {"E": achievements + len(EVENTS), "A": achievements, "R": rows, "W": count, "C": len(coordinated)}
        self.period = Packed(Period(**arrays_of(Period, **sizes)))
        self.events, self.team, self.ticks, self.outcome, self.took_part = self.period.record[:5]
        self.cost, self.price, self.bumps = self.period.record[5:]
        self._followed = Packed(
            Followed(
                working=worlds.team.working,
                limits=worlds.world.limits,
                standing=worlds.task.standing,
                fading=max(1.0 - worlds.period / MEMORY, 0.0),
                avoiding=avoidance_column(worlds),
                coordinated=coordinated,
                **arrays_of(Followed, **sizes),
            )
        )
        followed = self._followed.record
        self.elapsed, self.idle, self.acted = followed.elapsed, followed.idle, followed.acted
        self.collided, self.stopped = followed.collided, followed.stopped
        self._counts = (worlds.task.Counts or MissionCounts)(worlds, self.period, self._followed)

    def reset(self, world: int) -> None:
        """Begin the counts of a world that has just been reset."""
        rows = self._worlds.rows_of(world)
        self.outcome[world] = RUNNING
        self.idle[rows] = self.collided[rows] = self.stopped[rows] = 0
        self._counts.reset(world)

    def stay(self, world: int) -> None:
        """Stop counting a world without a next scenario until it is reset; its last outcome remains."""
        if self.outcome[world] == RUNNING:
            self.outcome[world] = TIME_OVER

    def reset_period(self) -> None:
        """Set the counts of the period to zero."""
        for counts in (self.events, self.team, self.ticks, self.cost, self.price, self.bumps):
            counts.fill(0)
        self.acted.fill(False)
        np.copyto(self.took_part, self._worlds.team.working)

    @property
    def ended(self) -> Ints:
        """The worlds (K,) whose missions ended with the last tick."""
        record = self._followed.record
        return record.ended[: record.number[0]].copy()

    def steps(self) -> list[Step]:
        """Return the steps that count a tick. A mission that ended counts no more until its world is reset."""
        worlds, counts = self._worlds, self._counts
        records = worlds.clock.packed, worlds.collisions.packed, worlds.network.packed, self.period, self._followed
        ticking = Step(COUNTING, count_tick, Rows.of(worlds.world.every_row), count_tick, records)
        return [counts.finishing(), ticking, counts.counting()]

    def ending(self, then: Callable[[], object]) -> Step:
        """Return the step that calls a function after a tick with which missions ended."""
        rows, records = Rows.of(self._worlds.world.every_row), (self._followed,)
        return Step(FINISHING, lambda now, _, number: then(), rows, have_ended, records)


def avoidance_column(worlds: Worlds) -> int:
    """Return which behaviour of the robots' networks is the coordinator that avoids others; -1 without one."""
    return next((coordinator.index for coordinator in worlds.coordinators if coordinator.model.goal == AVOIDANCE), -1)


@long_kernel
def count_tick(
    now: float,
    rows: Ints,
    clock: Handle[Ticks],
    counts: Handle[Counts],
    network: Handle[RowStates],
    period: Written[Period],
    followed: Written[Followed],
) -> int:
    """Add one tick to the period of the worlds that run, and list those that end; a step, see `selforg.program`.

    What robots achieved and what the tick cost `MissionCounts` adds afterwards.
    """
    p, f, t, k = open_period(period), open_followed(followed), open_ticks(clock), open_counts(counts)
    marks, collisions = open_states(network).marks, p.events.shape[0] - 3
    robots, f.number[0] = rows.shape[0] // t.begun.shape[0], 0
    for row in rows:
        for goal in range(f.coordinated.shape[0]):
            f.acted[row, goal] |= marks[row, EXECUTING, f.coordinated[goal]] != 0
    for world in range(t.begun.shape[0]):
        f.counts[world] = p.outcome[world] == RUNNING
        if not f.counts[world]:
            continue
        p.ticks[world] += 1
        for row in range(world * robots, (world + 1) * robots):
            p.took_part[row] |= f.working[row]
            f.idle[row] += 1
            p.events[collisions, row] += k.entered_in_tick[row]
            p.events[collisions + 1, row] += k.in_contact[row]
            if f.avoiding >= 0:
                p.events[collisions + 2, row] += marks[row, EXECUTING, f.avoiding]
            f.collided[row] = f.fading * f.collided[row] + k.entered_in_tick[row]
            f.stopped[row] = f.fading * f.stopped[row] + (f.standing[row] > 1)
        f.elapsed[world] = t.ticks[0] - t.begun[world]
        p.outcome[world] = mission_state(f.done[world], f.elapsed[world], f.limits[world])
        if p.outcome[world] != RUNNING:
            f.ended[f.number[0]] = world
            f.number[0] += 1
    return 0


@lean_kernel
def have_ended(now: float, rows: Ints, followed: Handle[Followed]) -> int:
    """Return how many missions have ended with the last tick; a step, see `selforg.program`."""
    return int(open_followed(followed).number[0])
