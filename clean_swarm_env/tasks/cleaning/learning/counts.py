"""What cleaning robots are counted for in each tick, and what it adds to the cost of their mission (compiled).

Shapes: W worlds, N robots a world, R = W * N rows, M items a world, K collision distances.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from clean_swarm_env.learning.progress import Followed, Period, open_followed, open_period
from clean_swarm_env.physics.collisions import Counts, open_counts
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
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel, long_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.plugins import is_own
from selforg.program import COUNTING, Rows, Step

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
    over: Annotated[Flags, "W", READ]  # worlds into which no more garbage will come
    arrived: Annotated[Ints, "W", READ]  # items that have come
    length: float  # of a tick [s]


open_paid = opening(PaidWork)


class CleaningCounts:
    """Counts the achievements of cleaning, and its costs; see `learning.progress.MissionCounts`."""

    _terms: Annotated[Floats, "W 6", KEPT]

    def __init__(self, worlds: Worlds, period: Packed[Period], followed: Packed[Followed]) -> None:
        task: Any = worlds.task
        self._worlds, self._period, self._followed = worlds, period, followed
        self._floor: Packed[FloorRecord] = task.site.packed
        self._terms = np.zeros((worlds.worlds, len(CostTerms._fields)))
        self._paid = Packed(
            PaidWork(
                paid=task.garbage.paid,
                had=np.full(worlds.rows, NOTHING, dtype=np.int64),
                had_recycled=np.zeros(worlds.rows, dtype=np.int64),
                had_done=np.zeros(worlds.worlds, dtype=np.int64),
                had_price=np.zeros(worlds.worlds),
                collisions=worlds.collisions.events,
                samples=worlds.collisions.samples,
                terms=self._terms,
                over=task.comings.over,
                arrived=task.garbage.arrived,
                length=worlds.period,
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

    def finishing(self) -> Step:
        """Return the step that notes which worlds are done, before a tick is counted."""
        worlds, done = self._worlds, self._followed.record.done
        rows, records = Rows.of(worlds.world.every_row), (self._floor, self._paid, self._followed)
        if is_own(type(worlds.task)):  # which may be done otherwise
            return Step(COUNTING, lambda now, _: np.copyto(done, worlds.task.done()), rows)
        return Step(COUNTING, note_done, rows, note_done, records)

    def counting(self) -> Step:
        """Return the step that adds what a tick brought in worlds where it counts."""
        records = self._period, self._followed, self._floor, self._paid, self._worlds.collisions.packed
        return Step(COUNTING, count_cleaning, Rows.of(self._worlds.world.every_row), count_cleaning, records)


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


@lean_kernel
def note_done(
    now: float, rows: Ints, floor: Handle[FloorRecord], paid: Handle[PaidWork], followed: Handle[Followed]
) -> int:
    """Note the worlds where all that has come is dumped, and no more will come; a step, see `selforg.program`."""
    f, a, o = open_floor(floor), open_paid(paid), open_followed(followed)
    for world in range(f.done.shape[0]):
        o.done[world] = a.over[world] and f.done[world] == a.arrived[world]
    return 0


@long_kernel
def count_cleaning(
    now: float,
    rows: Ints,
    period: Handle[Period],
    followed: Written[Followed],
    floor: Handle[FloorRecord],
    paid: Written[PaidWork],
    counts: Handle[Counts],
) -> int:
    """Add what robots achieved in a tick, and its cost, to the period of worlds in which it counts.

    This is a step, see `selforg.program`. Lost cargo is not dumped. An item is paid for only the first time it is
    picked: otherwise a robot could pick and drop the same item forever.
    """
    p, o, f, a = open_period(period), open_followed(followed), open_floor(floor), open_paid(paid)
    entered, in_contact = open_counts(counts).entered_in_tick, open_counts(counts).in_contact
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
            p.bumps[row] += a.terms[world, EVENT] * entered[row] + a.terms[world, SAMPLE] * in_contact[row]
            a.had[row] = f.cargo[row]
            a.had_recycled[row] = f.recycled[row]
        dumped_now = f.done[world] - a.had_done[world]
        p.team[DUMPINGS, world] += dumped_now
        a.had_done[world] = f.done[world]
        add_cost(world, dumped_now, a.length, p, f, a)
    return 0
