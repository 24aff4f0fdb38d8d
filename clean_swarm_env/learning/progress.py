"""Counts of the events in a decision period, and its cost, tick by tick; the time since each robot achieved something.

Shapes: W worlds, N robots a world, R = W * N rows, E kinds of events.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.tasks.cleaning.cost import (
    EVENT,
    ITEMS,
    LEFT,
    LIMIT,
    NO_ITEM,
    SAMPLE,
    WORTH,
    CostTerms,
    collision_price,
    cost_terms,
)
from clean_swarm_env.tasks.cleaning.garbage import DONE, NOTHING
from clean_swarm_env.world.mission_end import RUNNING, TIME_OVER, mission_state
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, long_kernel
from selforg.compiler.records import Recording, Written

EVENTS = ("picked", "recycled", "dumped", "collision", "contact", "avoiding")
"""Rows of `Period.events`: items picked that nobody had picked before, recycled and dumped by the robot, collision
events in which it took part, ticks at whose end another robot was closer than the collision distance, ticks in which it
avoided others."""
PICKINGS, RECYCLINGS, DUMPINGS, COLLISIONS, CONTACTS, AVOIDINGS = range(6)

MEMORY = 120.0
"""Time after which 1/e is left of what a robot remembers of its collisions [s]."""


class Period(NamedTuple):
    """The counts of a decision period."""

    events: Annotated[Ints, "E R", SCRATCH]  # in the order of EVENTS
    ticks: Annotated[Ints, "W", SCRATCH]  # ticks that counted
    dumped: Annotated[Ints, "W", SCRATCH]  # items that the team dumped
    outcome: Annotated[Ints, "W", KEPT]  # RUNNING, COMPLETED (all garbage dumped) or TIME_OVER, at the end
    took_part: Annotated[Flags, "R", SCRATCH]  # robots that were at work
    cost: Annotated[Floats, "W", SCRATCH]  # what the period added to the cost of the mission, without collisions [s]
    price: Annotated[Floats, "W", SCRATCH]  # what its collisions added [s]
    bumps: Annotated[Floats, "R", SCRATCH]  # price of the robot's collisions, one by one: its share of `price`


class Followed(NamedTuple):
    """Arrays of the worlds, and their values at the tick before, from which events are counted."""

    working: Annotated[Flags, "R", READ]  # robots at work
    in_contact: Annotated[Flags, "R", READ]  # another robot is closer than the collision distance
    stage: Annotated[Ints, "W M", READ]  # LYING, CARRIED, DONE or ABSENT
    paid: Annotated[
        Ints, "W M", KEPT
    ]  # 1 once somebody has been paid for picking the item, or has put it down for others
    under: Annotated[Ints, "W M", READ]  # the item below a carried one in its load, or NOTHING
    cargo: Annotated[Ints, "R", READ]  # item on top of what the robot carries, NOTHING without one
    recycled: Annotated[Ints, "R", READ]  # 1 where the cargo has been recycled
    done: Annotated[Ints, "W", READ]  # items dumped
    had: Annotated[Ints, "R", KEPT]  # cargo at the tick before
    had_recycled: Annotated[Ints, "R", KEPT]  # recycled at the tick before
    had_done: Annotated[Ints, "W", KEPT]  # done at the tick before
    collisions: Annotated[Ints, "W K", READ]  # events at each distance since the mission began
    samples: Annotated[Ints, "W K", READ]  # pairs closer than each distance, summed over all counts
    terms: Annotated[Floats, "W 6", READ]  # `CostTerms` of each mission
    had_price: Annotated[Floats, "W", KEPT]  # what collisions had cost at the tick before [s]
    limits: Annotated[Ints, "W", READ]  # ticks after which each mission is over
    elapsed: Annotated[Ints, "W", KEPT]  # ticks since the mission began, up to its end
    idle: Annotated[
        Ints, "R", KEPT
    ]  # ticks since the robot last picked, recycled or dumped, or since the mission began
    ended: Annotated[Ints, "W", SCRATCH]  # the first of them: worlds whose missions ended with the last tick
    standing: Annotated[Ints, "R", READ]  # ticks for which a collision stops the robot, that of the collision included
    collided: Annotated[Floats, "R", KEPT]  # the robot's collision events, which fade
    stopped: Annotated[Floats, "R", KEPT]  # ticks for which they stopped it, which fade alike
    fading: float  # factor by which both shrink in a tick


PERIOD_RECORD = Recording(Period)
FOLLOWED_RECORD = Recording(Followed)
open_period, open_followed = PERIOD_RECORD.open, FOLLOWED_RECORD.open


class MissionProgress:
    """Counts of a batch of worlds. A world whose mission is over counts no more.

    Attributes:
        period: the record `Period`, with its words; its arrays are attributes here too: `events` (E, R), `ticks` (W,),
            `dumped` (W,), `outcome` (W,), `took_part` (R,), `cost` (W,), `price` (W,), `bumps` (R,).
        acted: (R, C) bool, whether the behaviour of each coordinated goal ran in the period.
        elapsed: (W,) int64, ticks since the mission began, up to its end.
        idle: (R,) int64, ticks since the robot last picked, recycled or dumped, or since the mission began.
        ended: (K,) int64, worlds whose missions ended with the last tick.
        collided: (R,) float64, collision events of the robot in this mission, which fade: 1/e is left after MEMORY.
        stopped: (R,) float64, ticks for which they stopped the robot, which fade alike.

    """

    acted: Annotated[Flags, "R C", SCRATCH]
    _terms: Annotated[Floats, "W 6", KEPT]
    ended: Annotated[Ints, "K", SCRATCH]

    def __init__(self, worlds: Worlds) -> None:
        def numbers(*shape: int) -> Ints:
            return np.zeros(shape, dtype=np.int64)

        self._worlds = worlds
        self._avoiding = avoidance_column(worlds)
        count, rows, items = worlds.worlds, worlds.rows, worlds.task.item_arrays()
        self._coordinated = [coordinator.index for coordinator in worlds.coordinators]
        self.acted = np.zeros((rows, len(self._coordinated)), dtype=np.bool_)
        self.period = PERIOD_RECORD.pack(
            Period(
                events=numbers(len(EVENTS), rows),
                ticks=numbers(count),
                dumped=numbers(count),
                outcome=numbers(count),
                took_part=np.zeros(rows, dtype=np.bool_),
                cost=np.zeros(count),
                price=np.zeros(count),
                bumps=np.zeros(rows),
            )
        )
        self.events, self.ticks, self.dumped, self.outcome, self.took_part = self.period.record[:5]
        self.cost, self.price, self.bumps = self.period.record[5:]
        self._terms = np.zeros((count, len(CostTerms._fields)))
        self.elapsed, self.idle = numbers(count), numbers(rows)
        self.collided, self.stopped = np.zeros(rows), np.zeros(rows)
        self.ended = numbers(0)
        self._followed = FOLLOWED_RECORD.pack(
            Followed(
                working=worlds.team.working,
                in_contact=worlds.collisions.in_contact,
                stage=items.stage,
                paid=items.paid,
                under=items.under,
                cargo=items.cargo,
                recycled=items.recycled,
                done=items.done,
                had=numbers(rows) + NOTHING,
                had_recycled=numbers(rows),
                had_done=numbers(count),
                collisions=worlds.collisions.events,
                samples=worlds.collisions.samples,
                terms=self._terms,
                had_price=np.zeros(count),
                limits=worlds.world.limits,
                elapsed=self.elapsed,
                idle=self.idle,
                ended=numbers(count),
                standing=items.standing,
                collided=self.collided,
                stopped=self.stopped,
                fading=max(1.0 - worlds.period / MEMORY, 0.0),
            )
        )

    def reset(self, world: int) -> None:
        """Begin the counts of a world that has just been reset."""
        mission, rows, followed = self._worlds.missions[world], self._worlds.rows_of(world), self._followed.record
        self.outcome[world] = RUNNING
        self.idle[rows] = self.collided[rows] = self.stopped[rows] = 0
        followed.had[rows] = followed.cargo[rows]
        followed.had_recycled[rows] = followed.recycled[rows]
        followed.had_done[world] = followed.done[world]
        self._terms[world] = cost_terms(mission)
        followed.had_price[world] = 0.0

    def stay(self, world: int) -> None:
        """Stop counting a world without a next scenario until it is reset; its last outcome remains."""
        if self.outcome[world] == RUNNING:
            self.outcome[world] = TIME_OVER

    def reset_period(self) -> None:
        """Set the counts of the period to zero."""
        for counts in (self.events, self.ticks, self.dumped, self.cost, self.price, self.bumps):
            counts.fill(0)
        self.acted.fill(False)
        np.copyto(self.took_part, self._worlds.team.working)

    def note(self, entered: Ints) -> bool:
        """Count the last tick, whose collision events are `entered` (R,); return whether missions ended.

        A mission that ended counts no more until its world is reset.
        """
        worlds, executing = self._worlds, self._worlds.network.executing
        self.acted |= executing[:, self._coordinated] != 0
        avoids = executing[:, self._avoiding] if self._avoiding >= 0 else np.zeros_like(entered)
        period, followed = self.period.words, self._followed.words
        count = count_tick(period, followed, entered, avoids, worlds.done, worlds.ticks, worlds.period)
        self.ended = self._followed.record.ended[:count].copy()
        return count > 0


def avoidance_column(worlds: Worlds) -> int:
    """Return which behaviour of the robots' networks is the coordinator that avoids others; -1 without one."""
    return next((coordinator.index for coordinator in worlds.coordinators if coordinator.model.goal == AVOIDANCE), -1)


@inlined
def add_cost(world: int, dumped: int, tick: float, p: Period, f: Followed) -> None:
    """Add what a tick of `tick` [s], in which `dumped` items were dumped, added to the cost of a world's mission."""
    limit = f.terms[world, LIMIT]
    priced = f.terms[world, EVENT] * f.collisions[world, 0] + f.terms[world, SAMPLE] * f.samples[world, 0]
    price = collision_price(priced, limit)
    p.price[world] += price - f.had_price[world]
    f.had_price[world] = price
    p.cost[world] += tick - f.terms[world, WORTH] * dumped
    if p.outcome[world] == TIME_OVER and f.terms[world, WORTH] == 0.0:
        p.cost[world] += f.terms[world, LEFT] * max(f.terms[world, ITEMS] - f.done[world], 0.0)
    elif p.outcome[world] == TIME_OVER:  # what is missing to the cost of an item, for all that were expected
        whole, worth = limit + price, f.terms[world, WORTH]
        p.cost[world] += limit / worth * whole / max(f.done[world], NO_ITEM) - (whole - worth * f.done[world])


@long_kernel
def count_tick(
    period: Written[Period],
    followed: Written[Followed],
    entered: Ints,
    avoids: Ints,
    cleaned: Flags,
    ticks: Ints,
    length: float,
) -> int:
    """Add one tick to the period of the worlds that run; list those that end and return their number.

    entered, avoids (R,): collision events of the robot, and whether it avoids others. cleaned, ticks (W,): whether all
    garbage has arrived and is dumped, and ticks since the reset. length: of a tick [s]. Lost cargo is not dumped. An
    item is paid for only the first time it is picked: otherwise a robot could pick and drop the same item forever.
    """
    p, f = open_period(period), open_followed(followed)
    ended, robots = 0, f.cargo.shape[0] // ticks.shape[0]
    for world in range(ticks.shape[0]):
        if p.outcome[world] != RUNNING:
            continue
        p.ticks[world] += 1
        for row in range(world * robots, (world + 1) * robots):
            picked = f.cargo[row] != NOTHING and f.cargo[row] != f.had[row]
            lost = f.had[row] != NOTHING and f.cargo[row] == NOTHING
            dumped = lost and f.stage[world, f.had[row]] == DONE
            recycled = f.cargo[row] != NOTHING and not picked and f.recycled[row] > f.had_recycled[row]
            p.took_part[row] |= f.working[row]
            f.idle[row] = 0 if picked or dumped or recycled else f.idle[row] + 1
            if picked:
                p.events[PICKINGS, row] += f.paid[world, f.cargo[row]] == 0
                f.paid[world, f.cargo[row]] = 1
            p.events[RECYCLINGS, row] += recycled
            item = f.had[row] if dumped else NOTHING
            while item != NOTHING:
                p.events[DUMPINGS, row] += 1
                item = f.under[world, item]
            p.events[COLLISIONS, row] += entered[row]
            p.events[CONTACTS, row] += f.in_contact[row]
            p.events[AVOIDINGS, row] += avoids[row]
            p.bumps[row] += f.terms[world, EVENT] * entered[row] + f.terms[world, SAMPLE] * f.in_contact[row]
            f.collided[row] = f.fading * f.collided[row] + entered[row]
            f.stopped[row] = f.fading * f.stopped[row] + (f.standing[row] > 1)
            f.had[row] = f.cargo[row]
            f.had_recycled[row] = f.recycled[row]
        dumped_now = f.done[world] - f.had_done[world]
        p.dumped[world] += dumped_now
        f.had_done[world] = f.done[world]
        f.elapsed[world] = ticks[world]
        p.outcome[world] = mission_state(cleaned[world], ticks[world], f.limits[world])
        add_cost(world, dumped_now, length, p, f)
        if p.outcome[world] != RUNNING:
            f.ended[ended] = world
            ended += 1
    return ended
