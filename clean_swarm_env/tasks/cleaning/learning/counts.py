"""What cleaning robots are counted for in each tick, and what it adds to the cost of their mission (compiled).

Shapes: W worlds, N robots a world, R = W * N rows, M items a world, K collision distances.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from clean_swarm_env.learning.progress import Followed, Period, open_followed, open_period
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
from clean_swarm_env.tasks.cleaning.records import FloorRecord, open_floor
from clean_swarm_env.world.mission_end import TIME_OVER
from clean_swarm_env.world.parts.measure import Achievement
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import KEPT, READ, Floats, Ints
from selforg.compiler.decorators import inlined, long_kernel
from selforg.compiler.records import Handle, Packed, Recording, Written

ACHIEVEMENTS = (
    Achievement("picked", "Items that the robot picked in the period and nobody had picked before."),
    Achievement("recycled", "Items that the robot recycled in the period."),
    Achievement("dumped", "Items that the robot dumped in the period.", "Items that the team dumped in the period."),
)
PICKINGS, RECYCLINGS, DUMPINGS = range(3)
"""Rows of `Period.events`."""


class PaidWork(NamedTuple):
    """What is paid for, and its values at the tick before, from which achievements are counted."""

    paid: Annotated[Ints, "W M", KEPT]  # 1 once somebody was paid for picking the item, or has put it down for others
    had: Annotated[Ints, "R", KEPT]  # cargo at the tick before
    had_recycled: Annotated[Ints, "R", KEPT]  # recycled at the tick before
    had_done: Annotated[Ints, "W", KEPT]  # items dumped at the tick before
    had_price: Annotated[Floats, "W", KEPT]  # what collisions had cost at the tick before [s]
    collisions: Annotated[Ints, "W K", READ]  # events at each distance since the mission began
    samples: Annotated[Ints, "W K", READ]  # pairs closer than each distance, summed over all counts
    terms: Annotated[Floats, "W 6", READ]  # `CostTerms` of each mission


PAID_RECORD = Recording(PaidWork)
open_paid = PAID_RECORD.open


class CleaningCounts:
    """Counts the achievements of cleaning, and its costs; see `learning.progress.Counts`."""

    _terms: Annotated[Floats, "W 6", KEPT]

    def __init__(self, worlds: Worlds, period: Packed[Period], followed: Packed[Followed]) -> None:
        task: Any = worlds.task
        self._worlds, self._period, self._followed = worlds, period, followed
        self._floor: Packed[FloorRecord] = task.site.packed
        self._terms = np.zeros((worlds.worlds, len(CostTerms._fields)))
        self._paid = PAID_RECORD.pack(
            PaidWork(
                paid=task.garbage.paid,
                had=np.full(worlds.rows, NOTHING, dtype=np.int64),
                had_recycled=np.zeros(worlds.rows, dtype=np.int64),
                had_done=np.zeros(worlds.worlds, dtype=np.int64),
                had_price=np.zeros(worlds.worlds),
                collisions=worlds.collisions.events,
                samples=worlds.collisions.samples,
                terms=self._terms,
            )
        )

    def reset(self, world: int) -> None:
        """Begin the counts of a world that has just been reset."""
        rows, floor, paid = self._worlds.rows_of(world), self._floor.record, self._paid.record
        paid.had[rows] = floor.cargo[rows]
        paid.had_recycled[rows] = floor.recycled[rows]
        paid.had_done[world] = floor.done[world]
        paid.had_price[world] = 0.0
        self._terms[world] = cost_terms(self._worlds.missions[world])

    def count(self, entered: Ints) -> None:
        """Add the last tick, whose collision events are `entered` (R,), in worlds where it counts."""
        records = self._period.handle, self._followed.handle, self._floor.handle, self._paid.handle
        count_cleaning(*records, entered, self._worlds.period)


@inlined
def add_cost(world: int, dumped: int, tick: float, p: Period, f: FloorRecord, a: PaidWork) -> None:
    """Add what a tick of `tick` [s], in which `dumped` items were dumped, added to the cost of a world's mission."""
    limit = a.terms[world, LIMIT]
    priced = a.terms[world, EVENT] * a.collisions[world, 0] + a.terms[world, SAMPLE] * a.samples[world, 0]
    price = collision_price(priced, limit)
    p.price[world] += price - a.had_price[world]
    a.had_price[world] = price
    p.cost[world] += tick - a.terms[world, WORTH] * dumped
    if p.outcome[world] == TIME_OVER and a.terms[world, WORTH] == 0.0:
        p.cost[world] += a.terms[world, LEFT] * max(a.terms[world, ITEMS] - f.done[world], 0.0)
    elif p.outcome[world] == TIME_OVER:  # what is missing to the cost of an item, for all that were expected
        whole, worth = limit + price, a.terms[world, WORTH]
        p.cost[world] += limit / worth * whole / max(f.done[world], NO_ITEM) - (whole - worth * f.done[world])


@long_kernel
def count_cleaning(
    period: Handle[Period],
    followed: Written[Followed],
    floor: Handle[FloorRecord],
    paid: Written[PaidWork],
    entered: Ints,
    length: float,
) -> None:
    """Add what robots achieved in a tick of `length` [s], and its cost, to the period of worlds in which it counts.

    entered (R,): collision events of the robot. Lost cargo is not dumped. An item is paid for only the first time it is
    picked: otherwise a robot could pick and drop the same item forever.
    """
    p, o, f, a = open_period(period), open_followed(followed), open_floor(floor), open_paid(paid)
    robots = f.cargo.shape[0] // f.done.shape[0]
    for world in range(f.done.shape[0]):
        if not o.counts[world]:
            continue
        for row in range(world * robots, (world + 1) * robots):
            picked = f.cargo[row] != NOTHING and f.cargo[row] != a.had[row]
            lost = a.had[row] != NOTHING and f.cargo[row] == NOTHING
            dumped = lost and f.stage[world, a.had[row]] == DONE
            recycled = f.cargo[row] != NOTHING and not picked and f.recycled[row] > a.had_recycled[row]
            if picked or dumped or recycled:
                o.idle[row] = 0
            if picked:
                p.events[PICKINGS, row] += a.paid[world, f.cargo[row]] == 0
                a.paid[world, f.cargo[row]] = 1
            p.events[RECYCLINGS, row] += recycled
            item = a.had[row] if dumped else NOTHING
            while item != NOTHING:
                p.events[DUMPINGS, row] += 1
                item = f.under[world, item]
            p.bumps[row] += a.terms[world, EVENT] * entered[row] + a.terms[world, SAMPLE] * o.in_contact[row]
            a.had[row] = f.cargo[row]
            a.had_recycled[row] = f.recycled[row]
        dumped_now = f.done[world] - a.had_done[world]
        p.team[DUMPINGS, world] += dumped_now
        a.had_done[world] = f.done[world]
        add_cost(world, dumped_now, length, p, f, a)
