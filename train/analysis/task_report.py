"""The measures of a task under each strategy, beside the targets and beside the baseline of the task.

Shapes: K scenarios.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from clean_swarm_env.world.parts.measure import Measure
from selforg.arrays import Floats
from train.analysis.flips import ALPHA, Flips, fewest, holm
from train.analysis.statistics import Summary, summarise


@dataclass(frozen=True)
class MeasuredStrategy:
    """One measure under one strategy."""

    strategy: str
    measure: Measure
    own: Summary
    """Over the scenarios."""
    baseline: Summary | None
    """The same measure of the baseline; None without one, or for the baseline itself."""
    difference: Summary | None
    """Own minus baseline, scenario by scenario."""
    flips: Flips | None = None
    """The test of these differences; None for a measure that need not be better."""
    beats: bool | None = None
    """Whether the strategy is shown to be better than the baseline; None where there are too few scenarios."""

    @property
    def met(self) -> bool:
        """Whether the mean reaches the target."""
        return self.measure.met(self.own.mean)

    @property
    def content(self) -> dict[str, Any]:
        """Plain data for JSON."""
        measure = self.measure
        return {
            "name": measure.name,
            "unit": measure.unit,
            "better": measure.better,
            "target": measure.target,
            "target_from": measure.reason,
            "target_met": self.met,
            "beats_baseline": self.beats,
            "own": asdict(self.own),
            "baseline": None if self.baseline is None else asdict(self.baseline),
            "difference": None if self.difference is None else asdict(self.difference),
        }


def measured_strategies(
    measures: Sequence[Measure], values: Mapping[str, Mapping[str, Floats]], baseline: str
) -> list[MeasuredStrategy]:
    """Return every measure under every strategy.

    Args:
        measures: measures of the task.
        values: strategy -> measure -> its values on the scenarios (K,).
        baseline: the strategy with which the others are compared, if it is among them.

    """
    found = []
    for strategy, own in values.items():
        rival = values.get(baseline) if strategy != baseline else None
        for measure in measures:
            name = measure.name
            one = MeasuredStrategy(strategy, measure, summarise(own[name]), None, None)
            if rival is not None:
                away = own[name] - rival[name]
                flips = None if measure.guard else Flips(away)
                one = replace(one, baseline=summarise(rival[name]), difference=summarise(away), flips=flips)
            found.append(one)
    tests = [one.flips for one in found if one.flips is not None]
    ps = iter(holm([test.p for test in tests], [test.least for test in tests]))
    return [one if one.flips is None else replace(one, beats=_beats(one, next(ps), len(tests))) for one in found]


def _beats(one: MeasuredStrategy, p: float, tests: int) -> bool | None:
    """Return whether a measure is shown to be better; `p` is corrected for the number of `tests` of its table."""
    if one.flips is None or len(one.flips.differences) < fewest(tests):
        return None
    return p < ALPHA and (one.flips.sign < 0.0) == (one.measure.better == "lower")


def by_strategy(measured: Sequence[MeasuredStrategy]) -> dict[str, Any]:
    """Return plain data for JSON under the key `measures`; nothing without measures."""
    found: dict[str, list[Any]] = {}
    for one in measured:
        found.setdefault(one.strategy, []).append(one.content)
    return {"measures": found} if found else {}
