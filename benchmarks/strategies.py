"""Speed of the decision strategies: one decision and one update of R rows, CPU time of each row.

Run with `python -m benchmarks.strategies`. Medians. Exit code 1 if a strategy needs more than a few microseconds a row.
"""

import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create
from selector.strategies.streams import row_keys
from tests.selector.strategies.policies import exported

ROWS, FEATURES, REPEATS = 320, 24, 100
LIMIT = 8e-6
"""Most that decision and update of one row together may cost, with 24 features and a policy of two layers of 64 [s]."""


def seconds_a_row(name: str, parameters: dict[str, Any], problem: Problem, own: bool) -> tuple[float, float]:
    """Return the cost of a decision and of an update for each row [s]; `own`: each row learns by itself."""
    generator = np.random.default_rng(0)
    groups = np.arange(ROWS) if own else np.zeros(ROWS, dtype=np.int64)
    strategy = create(name, problem, row_keys(np.random.SeedSequence(0), ROWS), parameters, groups=groups)
    deciding, learning = [], []
    for _ in range(REPEATS + 3):
        context = generator.normal(size=(ROWS, FEATURES))
        reward = np.round(generator.normal(size=ROWS), 1)  # many alike, as in missions
        start = time.process_time()
        option = strategy.select(context)
        between = time.process_time()
        strategy.update(option, reward, context)
        deciding.append(between - start)
        learning.append(time.process_time() - between)
    return median(deciding[3:]) / ROWS, median(learning[3:]) / ROWS


def main() -> int:
    """Print the table and return the exit code."""
    features = tuple(f"x{k}" for k in range(FEATURES))
    problem = Problem("AvoidCollision", ("one", "two", "three"), np.array([1.0, 0.5, 0.2]), features)
    missed = False
    print(f"{ROWS} rows, {FEATURES} features [us/row]      shared: decide  learn    own: decide  learn")
    with TemporaryDirectory() as directory:
        exported(Path(directory), problem.goal, problem.options, features, hidden=(64, 64))
        needed = {"Fixed": {"option": "two"}}
        for name in STRATEGIES.names():
            costs = [seconds_a_row(name, needed.get(name, {}), problem, own) for own in (False, True)]
            late = max(sum(cost) for cost in costs) > LIMIT
            missed |= late
            figures = "".join(f"{decide * 1e6:15.2f}{learn * 1e6:7.2f}" for decide, learn in costs)
            print(f"{name:32s}{figures}{'  MISSED' if late else ''}")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
