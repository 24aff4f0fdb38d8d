"""Measures: the figures of success in a task, and achievements, for which robots are counted."""

import re
from dataclasses import dataclass
from typing import Final, Literal

MOST_RATIO: Final = 100.0
"""Largest ratio of a measure and its target that counts."""


@dataclass(frozen=True)
class Measure:
    """A figure of success in a task.

    Attributes:
        name: name of the figure.
        unit: "-" for a pure number.
        better: whether lower or higher values are better.
        target: value to reach in the task's own mission, stated before anything was run.
        reason: reason for the target.
        guard: whether the figure is a price: it has to meet its target, but need not beat the baseline.

    """

    name: str
    unit: str
    better: Literal["lower", "higher"]
    target: float
    reason: str
    guard: bool = False

    def met(self, value: float) -> bool:
        """Return whether a value reaches the target."""
        return value <= self.target if self.better == "lower" else value >= self.target

    def ratio(self, value: float) -> float:
        """Return a value by the target, 1 where it is just met and less where it is better, from 0.01 to 100."""
        target, least = abs(self.target) or 1.0, 1.0 / MOST_RATIO
        by_target = value / target if self.better == "lower" else target / max(value, target / MOST_RATIO)
        if self.guard and by_target <= 1.0:
            return least
        return min(max(by_target, least), MOST_RATIO)


@dataclass(frozen=True)
class Achievement:
    """Something that robots do for their task; each time is counted: infos and rewards have it as `own_NAME`.

    Attributes:
        name: a verb for what was done, such as "dumped".
        about: what is counted of a robot in a decision period, as infos say it.
        team: what is counted of its team, which infos and rewards then have as `NAME`; empty: nothing.

    """

    name: str
    about: str
    team: str = ""


def key_of(measure: str) -> str:
    """Return the name of a measure as infos and rewards have it: letters, digits and underscores."""
    return re.sub(r"\W+", "_", measure)
