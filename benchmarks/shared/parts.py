"""The time of each part of a tick, step by step of its program, and a stopwatch for parts of other code."""

from collections import defaultdict
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Ints
from selforg.compiler.steps import run_steps
from selforg.program import Program, Step

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


def part_of(step: Step) -> str:
    """Return the part to which a step of a tick belongs, by the file of its function."""
    module = str((step.kernel or step.python).__module__)
    if module.startswith("clean_swarm_env.physics"):
        return "physics"
    if module.startswith("selforg.gradients") or module == "clean_swarm_env.world.minds":
        return "buffer"
    if module.startswith(("selforg.components", "selector")):
        return "selector"
    found = [part for part in ("mechanisms", "network") if module.startswith(f"selforg.{part}")]
    return found[0] if found else "sensors and cargo"


class WatchedProgram(Program):
    """A program that runs step by step and adds up how long each part takes [s], less what a call by itself takes."""

    __slots__ = ("seconds",)

    def repeat(self, ticks: Ints, length: float, times: int, without: int = 0) -> None:
        """Run all steps once."""
        now = float(ticks[0] * length)
        for at, step in enumerate(self.steps):
            alone, begin = self._table[: at + 1], perf_counter()
            run_steps(now, at + 1, without, alone)
            between = perf_counter()
            reached, result = run_steps(now, at, without, alone)
            if reached == at:
                step.python(now, step.rows.now, *(() if step.kernel is None else (result,)))
            self.seconds[part_of(step)] += perf_counter() - between - (between - begin)


def parts_of_a_tick(worlds: Worlds, ticks: int) -> dict[str, float]:
    """Return the wall microseconds of each part of a tick, from ROUNDS rounds of `ticks` ticks.

    Wall time, because reading the CPU clock costs more than some parts. Rounds are short and the lower quartile counts,
    so that rounds in which another process had the core drop out. The watch stays on the worlds and slows them.
    """
    program = worlds.program = WatchedProgram(worlds.steps)
    rounds = []
    for _ in range(ROUNDS):
        program.seconds = dict.fromkeys(PARTS, 0.0)
        for _ in range(ticks):
            worlds.tick()
        rounds.append(program.seconds)
    return {part: 1e6 * float(np.quantile([taken[part] for taken in rounds], 0.25)) / ticks for part in PARTS}
