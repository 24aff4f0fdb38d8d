"""The measures of a task under each strategy, beside the targets and beside the baseline of the task.

Shapes: K scenarios.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from clean_swarm_env.world.parts.measure import Measure
from selforg.arrays import Floats
from train.analysis.flips import ALPHA, Flips, fewest, holm
from train.analysis.intervals import cells
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
    beats: bool | None
    """Whether it is shown to be better than the baseline; None with too few scenarios, or where it need not be."""

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
    measures: Sequence[Measure], tables: Mapping[str, Mapping[str, Floats]], baseline: str
) -> list[MeasuredStrategy]:
    """Return every measure under every strategy.

    Args:
        measures: measures of the task.
        tables: measure -> strategy -> its values (K,) or (S, K, V), of which the mean of each scenario counts.
        baseline: the strategy with which the others are compared, if it is among them.

    """
    means = {(label, one): cells(own).mean(axis=(0, 2)) for one in measures for label, own in tables[one.name].items()}
    labels = dict.fromkeys(label for label, _ in means)
    rivals = {one: means[baseline, one] for one in measures} if baseline in labels else {}
    away = {key: own - rivals[key[1]] for key, own in means.items() if rivals and key[0] != baseline}
    tests = {key: Flips(own) for key, own in away.items() if not key[1].guard}  # which need not be better
    ps = holm([test.p for test in tests.values()], [test.least for test in tests.values()])
    beats = {
        key: p < ALPHA and (test.sign < 0.0) == (key[1].better == "lower")
        for (key, test), p in zip(tests.items(), ps, strict=True)
        if len(test.differences) >= fewest(len(tests))
    }
    found = []
    for label, one in itertools.product(labels, measures):
        key, own = (label, one), summarise(means[label, one])
        beside = (summarise(rivals[one]), summarise(away[key])) if key in away else (None, None)
        found.append(MeasuredStrategy(label, one, own, beside[0], beside[1], beats.get(key)))
    return found


def by_strategy(measured: Sequence[MeasuredStrategy]) -> dict[str, Any]:
    """Return plain data for JSON under the key `measures`; nothing without measures."""
    names = dict.fromkeys(one.strategy for one in measured)
    found = {name: [one.content for one in measured if one.strategy == name] for name in names}
    return {"measures": found} if found else {}
