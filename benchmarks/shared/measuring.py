"""Ways to measure: CPU time, contestants by turns, medians, and the growth of a cost with size."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from time import process_time
from typing import TypeVar

import numpy as np

REPEATS = 7
Name = TypeVar("Name")


@dataclass(frozen=True)
class Figure:
    """One measured figure: the median of its repeats, and their spread.

    Attributes:
        value: median.
        spread: largest distance of the middle half of the repeats from the median, as a share of it [-].

    """

    value: float
    spread: float

    @staticmethod
    def of(repeats: Sequence[float]) -> "Figure":
        """Return the figure of some repeats."""
        low, middle, high = np.quantile(repeats, (0.25, 0.5, 0.75))
        return Figure(float(middle), float(max(high - middle, middle - low) / abs(middle)) if middle else 0.0)


def by_turns(contestants: Mapping[Name, Callable[[], float]], repeats: int = REPEATS) -> dict[Name, list[float]]:
    """Return the figures (repeats,) of each contestant; they take turns, after one round that loads compiled code."""
    rounds = [{name: contestant() for name, contestant in contestants.items()} for _ in range(repeats + 1)][1:]
    return {name: [figures[name] for figures in rounds] for name in contestants}


def seconds_per_call(call: Callable[[], object], calls: int) -> float:
    """Return the CPU seconds of one call."""
    begin = process_time()
    for _ in range(calls):
        call()
    return (process_time() - begin) / calls


def ratio(repeats: Sequence[float], floor: Sequence[float]) -> Figure:
    """Return the ratio of a cost to the floor, round by round: a busy machine slows both."""
    return Figure.of([one / other for one, other in zip(repeats, floor, strict=True)])


def growth(sizes: Sequence[float], costs: Sequence[float]) -> tuple[float, float]:
    """Return exponent and R^2 of the straight line through log cost by log size."""
    x, y = np.log(sizes), np.log(costs)
    exponent, offset = np.polyfit(x, y, 1)
    off = y - (exponent * x + offset)
    total = ((y - y.mean()) ** 2).sum()
    return float(exponent), float(1.0 - (off**2).sum() / total) if total else 1.0


def middle(repeats: Sequence[float]) -> float:
    """Return the median."""
    return float(median(repeats))
