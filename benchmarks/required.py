"""Requirements on the stack, and the effect of a change on them: `python -m benchmarks.required [BASELINE.json]`.

Compares `results.json` with the committed one (or with BASELINE), figure by figure. Only ratios are compared, because
they hold on another machine and on a busy one. Exit code 1 if a figure became worse by more than its noise. A missed
requirement is shown, but does not change the exit code.
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.shared.record import RESULTS

NOISE = 0.2
"""Share by which a figure may be worse without an alarm; four times its spread if that is larger."""


@dataclass(frozen=True)
class Requirement:
    """One figure in the results, and the value that it must reach.

    Attributes:
        what: name for people.
        path: keys of the figure in the results.
        limit: value to reach.
        spread: keys of its spread.
        most: whether `limit` is the largest value allowed (else the smallest).
        absolute: whether it is a time of this machine, which is shown but not compared.

    """

    what: str
    path: tuple[str, ...]
    limit: float
    spread: tuple[str, ...] = ()
    most: bool = True
    absolute: bool = False

    def reached(self, value: float) -> bool:
        """Whether a value is good enough."""
        return value <= self.limit if self.most else value >= self.limit

    def worse(self, value: float, before: float) -> float:
        """Return the share by which a value is worse than the one before (negative: better)."""
        return value / before - 1.0 if self.most else before / value - 1.0


def tick_of(size: str, limit: float) -> Requirement:
    """Return the requirement on the tick of one size."""
    return Requirement(
        f"tick / floor, {size}", ("tick", "tick / floor", size), limit, ("tick", "spread of tick / floor", size)
    )


REQUIREMENTS = (
    Requirement("tick of one world [us]", ("tick", "tick [us]", "1 x 5"), 250.0, absolute=True),
    tick_of("1 x 5", 5.0),
    tick_of("64 x 5", 3.0),
    tick_of("1 x 1000", 4.0),
    Requirement(
        "tick of 10,000 robots in one world [us]", ("tick", "tick [us]", "1 x 10000"), 200_000.0, absolute=True
    ),
    Requirement("growth from 50 to 10,000 robots, exponent", ("tick", "growth", "exponent"), 1.2),
    Requirement("growth from 1,000 to 10,000 robots, exponent", ("tick", "growth", "exponent from 1,000 robots"), 1.05),
    Requirement("late tick / floor, 64 x 5", ("late", "64 x 5", "late tick / floor"), 3.0),
    *(
        Requirement(f"64 x 5, {what}", ("walls", what, "ratio"), limit, ("walls", what, "spread"))
        for what, limit in {"20 walls, to none": 1.5, "8 rays among 20 walls, to none": 1.5}.items()
    ),
    Requirement("late / early, 1 x 5", ("late", "1 x 5", "late / early"), 1.5),
    Requirement("late / early, 64 x 5", ("late", "64 x 5", "late / early"), 1.5),
    Requirement(
        "PettingZoo, times simple_spread",
        ("border", "5 agents", "times simple_spread"),
        3.0,
        ("border", "5 agents", "spread of times simple_spread"),
        most=False,
    ),
    Requirement(
        "PettingZoo, step beyond the tick [us]", ("border", "5 agents", "beyond the tick [us]"), 60.0, absolute=True
    ),
    Requirement("memory of the first world [MB]", ("costs", "memory", "first world [MB]"), 350.0),
    Requirement("memory of each further world [MB]", ("costs", "memory", "each further world [MB]"), 1.0),
    Requirement("memory of a robot among 10,000 [kB]", ("costs", "memory", "a robot among 10,000 [kB]"), 40.0),
    Requirement("very first start, CPU [s]", ("costs", "start", "first start, CPU [s]"), 30.0, absolute=True),
    Requirement("second start, CPU [s]", ("costs", "start", "second start, CPU [s]"), 2.0, absolute=True),
)


def value_at(results: Any, path: tuple[str, ...]) -> float | None:
    """Return the value at a path of keys, None if there is none."""
    for key in path:
        if not isinstance(results, dict) or key not in results:
            return None
        results = results[key]
    return float(results)


def committed() -> Any:
    """Return the results of the last commit."""
    told = subprocess.run(
        ["git", "show", f"HEAD:./{RESULTS.name}"], cwd=RESULTS.parent, check=True, capture_output=True, text=True
    )
    return json.loads(told.stdout)


def compared(results: Any, baseline: Any) -> Iterator[tuple[str, bool]]:
    """Yield a line for each figure, and whether it became worse beyond its noise."""
    for one in REQUIREMENTS:
        value, before = value_at(results, one.path), value_at(baseline, one.path)
        if value is None:
            yield f"{one.what:42} not measured", False
            continue
        line = f"{one.what:42}{value:9.2f}  {'<=' if one.most else '>='} {one.limit:g}"
        line += "" if one.reached(value) else "  MISSED"
        if before is None or one.absolute:
            yield line, False
            continue
        spread = max(value_at(told, one.spread) or 0.0 for told in (results, baseline)) if one.spread else 0.0
        change, noise = one.worse(value, before), max(NOISE, 4.0 * spread)
        bad = change > noise
        yield f"{line}  was {before:.2f}{f', WORSE by {change:.0%} (noise {noise:.0%})' if bad else ''}", bad


def main(arguments: list[str]) -> int:
    """Print the comparison; return 1 if something became worse."""
    baseline = json.loads(Path(arguments[0]).read_text(encoding="utf-8")) if arguments else committed()
    lines = list(compared(json.loads(RESULTS.read_text(encoding="utf-8")), baseline))
    print("\n".join(line for line, _ in lines))
    return int(any(bad for _, bad in lines))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
