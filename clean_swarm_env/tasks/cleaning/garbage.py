"""Garbage and cargo: where each item lies, which robot carries it, whether it is dumped, and when others arrive.

An item is lying, then carried by a robot (to the recycling station, then its leftovers to the dump), then done. It lies
again where its robot is lost, loses it, or puts it down for others. Rows of items that are absent or done are free for
items that arrive later.

Items arrive as a Poisson process. An item arrives when the number expected since the last arrival reaches an
exponential draw. So a change of the rate keeps the waiting time that has passed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil
from typing import Annotated

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import draw_places
from clean_swarm_env.config.types import Point
from clean_swarm_env.world.mission_end import NO_TICK
from clean_swarm_env.world.parts.things import TaskState
from selforg.arrays import KEPT, Floats, Ints, Within

LYING, CARRIED, DONE, ABSENT = range(4)
NOTHING = -1


class Garbage(TaskState):
    """Items of W worlds with M items and N robots each; rows are robots, R = W * N."""

    positions: Annotated[Floats, "W M 2", KEPT]  # where an item lies or was picked [m]
    stage: Annotated[Ints, "W M", KEPT]  # LYING, CARRIED, DONE or ABSENT
    leftover: Annotated[Ints, "W M", KEPT]  # 1 where what lies has been recycled already
    paid: Annotated[Ints, "W M", KEPT]  # 1 once somebody was paid for picking an item, or has put it down for others
    under: Annotated[Ints, "W M", KEPT, Within(NOTHING, "M")]  # the item below a carried one in its load, or NOTHING
    found: Annotated[Ints, "W M", KEPT]  # ticks for which robots that carry nothing know the item
    cargo: Annotated[Ints, "R", KEPT, Within(NOTHING, "M")]  # the item on top of what a robot carries, or NOTHING
    recycled: Annotated[Ints, "R", KEPT]  # 1 once the cargo has been recycled
    leg: Annotated[Floats, "R", KEPT]  # way to the next station from where the cargo was picked or recycled [m]
    blind: Annotated[Ints, "R", KEPT]  # ticks for which the robot sees no item that lies
    done: Annotated[Ints, "W", KEPT]  # items dumped
    arrived: Annotated[Ints, "W", KEPT]  # items that have come into the world

    def __init__(self, worlds: int, items: int, robots: int) -> None:
        self.robots = robots
        super().__init__({"W": worlds, "M": items, "R": worlds * robots})
        self.cargo[:] = self.under[:] = NOTHING

    def place(self, world: int, positions: Floats) -> None:
        """Put the items of a world at `positions` (up to M, 2) [m], in the first rows; no robot carries anything."""
        rows = slice(world * self.robots, (world + 1) * self.robots)
        self.reset(world, rows)
        self.positions[world, : len(positions)] = positions
        self.stage[world] = ABSENT
        self.stage[world, : len(positions)] = LYING
        self.under[world] = self.cargo[rows] = NOTHING
        self.arrived[world] = len(positions)

    def arrive(self, world: int, position: Floats) -> bool:
        """Put an item that comes into a world at `position` (2,) [m]; return whether there was a free row for it."""
        free = np.flatnonzero(self.stage[world] >= DONE)
        if not len(free):
            return False
        self.positions[world, free[0]] = position
        self.stage[world, free[0]] = LYING
        self.leftover[world, free[0]] = self.paid[world, free[0]] = self.found[world, free[0]] = 0
        self.arrived[world] += 1
        return True

    def load(self, row: int) -> Ints:
        """Return the items (K,) that a robot carries, the last one picked first."""
        items, world = [int(self.cargo[row])], row // self.robots
        while items[-1] != NOTHING:
            items.append(int(self.under[world, items[-1]]))
        return np.array(items[:-1], dtype=np.int64)

    def drop(self, row: int, position: Floats) -> bool:
        """Put the cargo of a robot, recycled or not, at `position` (2,) [m]; return whether it carried anything."""
        items, world = self.load(row), row // self.robots
        if not len(items):
            return False
        self.positions[world, items] = position
        self.stage[world, items] = LYING
        self.leftover[world, items] = self.recycled[row]
        self.found[world, items] = 0
        self.cargo[row] = NOTHING
        self.recycled[row] = 0
        return True

    def hand_over(self, row: int, position: Floats, blind: int) -> bool:
        """Drop the cargo of a robot for others; the robot sees no item for `blind` ticks."""
        items = self.load(row)
        if not self.drop(row, position):
            return False
        self.paid[row // self.robots, items] = 1
        self.blind[row] = blind
        return True


class Arrivals:
    """The times at which items arrive in one world, and their places.

    Attributes:
        due: tick of the next arrival.

    """

    def __init__(self, rng: np.random.Generator, rate: float, ticks_per_minute: float) -> None:
        self._rng = rng
        self._ticks_per_minute = ticks_per_minute
        self._expected = float(rng.exponential())  # number of items expected until the next one arrives
        self._count_from(0.0, rate)

    def until(self, tick: int, spots: Sequence[Point], mission: MissionConfig) -> Iterator[Floats]:
        """Yield the place (1, 2) [m] of each item that has arrived by `tick`."""
        while self.due <= tick:
            yield draw_places(1, self._rng, mission, spots)
            self._expected = float(self._rng.exponential())
            self._count_from(self._next_time, self._rate)

    def set_rate(self, rate: float, tick: int) -> None:
        """Change the rate to `rate` [1/min] from `tick` on."""
        passed = (tick - self._since) * self._rate / self._ticks_per_minute
        self._expected = max(self._expected - passed, 0.0)
        self._count_from(float(tick), rate)

    def _count_from(self, since: float, rate: float) -> None:
        """Compute the next arrival at `rate` [1/min]; the expected items count from the time `since` [ticks]."""
        self._rate, self._since = rate, since
        self._next_time = since + self._expected * self._ticks_per_minute / rate if rate > 0.0 else float(NO_TICK)
        self.due = ceil(self._next_time)
