"""The time of each part of a tick, measured at its border, without the calls that it makes to other parts."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

import numpy as np

from clean_swarm_env.world.worlds import Worlds
from selforg.mechanisms import MovementMechanism

PARTS = ("physics", "buffer", "mechanisms", "network", "selector", "sensors and cargo")
ROUNDS = 41


class Stopwatch:
    """Time by part, wall time unless another clock is given; a call from one part to another stops the first one's."""

    def __init__(self, clock: Callable[[], float] = perf_counter) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._clock = clock
        self._asked: list[str] = []
        self._since = 0.0

    def watch(self, owner: Any, method: str, part: str) -> None:
        """Count the time of `owner.method` for `part` from now on."""
        call: Callable[..., Any] = getattr(owner, method)

        def watched(*given: Any, **named: Any) -> Any:
            self._switch(part)
            try:
                return call(*given, **named)
            finally:
                self._switch(None)

        setattr(owner, method, watched)

    def _switch(self, part: str | None) -> None:
        now = self._clock()
        if self._asked:
            self.seconds[self._asked[-1]] += now - self._since
        if part is None:
            self._asked.pop()
        else:
            self._asked.append(part)
        self._since = self._clock()


def borders_of(worlds: Worlds) -> Iterator[tuple[object, str, str]]:
    """Yield (owner, method, part) of every call that leads from one part of a tick into another."""
    yield worlds, "tick", "sensors and cargo"
    yield worlds.floor, "move", "physics"
    for buffer in (
        worlds.minds.buffers["items"],
        worlds.minds.buffers["pheromones"],
        worlds.minds.buffers["gradients"],
    ):
        for method in ("store_static", "extinguish", "deposit"):
            yield buffer, method, "buffer"
    yield worlds.minds.poses, "update", "buffer"
    contents = [content for coordinator in worlds.coordinators for content in coordinator.contents]
    inner = [mechanism for content in contents for mechanism in content.mechanisms.values()]
    for mechanism in (worlds.task.movers.mechanisms["MoveToGarbage"], worlds.task.movers.mechanisms["Patrol"], *inner):
        if isinstance(mechanism, MovementMechanism):
            yield mechanism, "move_into", "mechanisms"
    for network in (worlds.network, *(content.network for content in contents)):
        yield network, "step", "network"
    for coordinator in worlds.coordinators:
        for method in ("sense", "act", "leave"):
            yield coordinator, method, "selector"


def parts_of_a_tick(worlds: Worlds, ticks: int) -> dict[str, float]:
    """Return the wall microseconds of each part of a tick, from ROUNDS rounds of `ticks` ticks.

    Wall time, because reading the CPU clock costs more than some parts. Rounds are short and the lower quartile counts,
    so that rounds in which another process had the core drop out. The watches stay on the worlds and slow them.
    """
    watch = Stopwatch()
    for owner, method, part in borders_of(worlds):
        watch.watch(owner, method, part)
    rounds = []
    for _ in range(ROUNDS):
        watch.seconds = dict.fromkeys(PARTS, 0.0)
        for _ in range(ticks):
            worlds.tick()
        rounds.append(watch.seconds)
    return {part: 1e6 * float(np.quantile([taken[part] for taken in rounds], 0.25)) / ticks for part in PARTS}
