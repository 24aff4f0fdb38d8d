"""The committed table of what tests take, `tests/durations.csv`, and what follows from it.

`make durations` (`python -m tests.rings.durations`) measures the gate and the other steps of CI anew; `make long`
measures the long ring. The order of test files and CONTRIBUTING's table of minutes come from here.
"""

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from docs.figures.stored import put
from tests.paths import ROOT
from tests.rings.timing import TIMES, measured

TABLE = ROOT / "tests" / "durations.csv"
CONTRIBUTING = ROOT / "CONTRIBUTING.md"
LEAST = 0.5
"""CPU seconds below which a fixture is not listed."""
GATE = (sys.executable, "-m", "pytest", "-q", "-n", "2", "--dist", "loadfile")
STEPS = {"make lint": ("make", "lint"), "make docs": ("make", "docs")}
"""The steps of CI that are no tests."""


class Row(NamedTuple):
    """What one test file, fixture or step takes."""

    ring: str
    """`gate`, `long` or `step`."""
    kind: str
    """`file`, `fixture`, `step` or `whole`."""
    name: str
    tests: int
    cpu_s: float
    """Of all its processes."""
    wall_s: float


def read(path: Path = TABLE) -> list[Row]:
    """Return the rows of a table; none if there is no file."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    return [Row(*row[:3], int(row[3]), float(row[4]), float(row[5])) for row in rows]


def summed(ring: str, lines: Iterable[str]) -> list[Row]:
    """Return a row for each file and fixture that the lines of `timing` name."""
    sums: dict[tuple[str, str], list[float]] = {}
    for line in lines:
        kind, name, *numbers = json.loads(line)
        known = sums.setdefault((kind, name), [0, 0.0, 0.0])
        sums[kind, name] = [have + more for have, more in zip(known, numbers, strict=True)]
    rows = [Row(ring, *key, int(n), round(cpu, 1), round(wall, 1)) for key, (n, cpu, wall) in sums.items()]
    return [row for row in rows if row.kind != "fixture" or row.cpu_s >= LEAST]


def replace(rings: Iterable[str], rows: Iterable[Row], path: Path = TABLE) -> None:
    """Put rows in place of those of some rings, the longest first, and write the minutes into CONTRIBUTING."""
    kept = [row for row in read(path) if row.ring not in rings]
    every = sorted([*kept, *rows], key=lambda row: (row.ring, row.kind, -row.cpu_s, row.name))
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([Row._fields, *every])
    if path == TABLE:
        page = CONTRIBUTING.read_text(encoding="utf-8")
        CONTRIBUTING.write_text(put(page, "minutes", minutes(every)), encoding="utf-8")


def minutes(rows: Iterable[Row]) -> str:
    """Return CONTRIBUTING's table of minutes."""
    lines = ["| what | tests | CPU minutes | minutes on two cores |", "|---|---|---|---|"]
    for row in rows:
        if row.kind in ("whole", "step"):
            lines.append(f"| {row.name} | {row.tests or ''} | {row.cpu_s / 60:.1f} | {row.wall_s / 60:.1f} |")
    return "\n".join(lines)


def order() -> dict[str, int]:
    """Return the place of each test file, those that take longest first, so that no worker is alone at the end."""
    files = sorted((row for row in read() if row.kind == "file"), key=lambda row: -row.cpu_s)
    return {row.name: place for place, row in enumerate(files)}


def run(words: Iterable[str], ring: str, name: str) -> tuple[int, list[Row]]:
    """Run pytest with `words`; return its exit code and the rows of what it took."""
    with tempfile.TemporaryDirectory() as folder:
        times = Path(folder) / "times"
        os.environ[TIMES] = str(times)
        with measured("whole", name):
            code = subprocess.run([*words, "-p", "tests.rings.timing"], cwd=ROOT, check=False).returncode
        rows = summed(ring, times.read_text(encoding="utf-8").splitlines())
    tests = sum(row.tests for row in rows)
    return code, [row._replace(tests=tests) if row.kind == "whole" else row for row in rows]


def main() -> int:
    """Measure the gate and the steps, and write the table; return 1 if anything of it fails."""
    code, rows = run(GATE, "gate", "`make test`, the gate")
    failed = [] if code == 0 else ["gate"]
    for name, words in STEPS.items():
        with tempfile.NamedTemporaryFile("r") as times:
            os.environ[TIMES] = times.name
            with measured("step", f"`{name}`"):
                failed += [name] * (subprocess.run(words, cwd=ROOT, check=False).returncode != 0)
            rows += summed("step", times.read().splitlines())
    if failed:
        print(f"failed, so nothing is written: {', '.join(failed)}")
        return 1
    replace({"gate", "step"}, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
