"""Verdicts: the sentences that say what a comparison found, and how sure that is.

Two strategies can be told apart if sign flips of paired log ratios, or of shares of unfinished missions, say so after
Holm's correction for all pairs (`train.analysis.flips`), so that the luckiest of many is not called the best. Intervals
of ratios of means are for all pairs at once, too (Bonferroni).

Shapes: S trainings of a strategy, K scenarios, V worlds of each.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from selforg.arrays import Floats
from train.analysis.flips import ALPHA, TAIL, fewest
from train.analysis.intervals import (
    NO_SPREAD,
    TOLD,
    Estimate,
    Interval,
    Ratio,
    about_number,
    cells,
    corrected_ps,
    heavy_tailed,
    share_interval,
)

TIMES = 1.5
"""Ratio from which on a difference is said by a factor, not in per cent."""
LOG_FROM = 8.0
"""Ratio of the largest to the least value from which the scale of a table or a figure is logarithmic."""
LARGEST_RATIO = 1_000
"""Ratios and ends of their intervals beyond this one say nothing: there are too few scenarios."""
MOST_NAMED = 3
"""Most strategies that a sentence lists by name."""
RANDOM, CHANCE = "Random", "chance"
"""Label of the strategy that takes any option in each decision period, and its name where others are told from it."""


@dataclass(frozen=True)
class Ranking:
    """Strategies by their means of one figure, the lowest first."""

    missions: Mapping[str, Floats]
    """Label -> (S, K, V) the figure."""
    left: Mapping[str, Floats] = field(default_factory=dict)
    """Label -> 1 where a mission was not completed (S, K, V), else 0; nothing where that means nothing."""
    verb: str = "costs"
    """What a strategy does of the figure."""
    spoken: Mapping[str, str] = field(default_factory=dict)
    """Label -> what it is called in a sentence, where that differs."""

    @classmethod
    def of(
        cls,
        values: Mapping[str, Floats],
        verb: str = "costs",
        *,
        left: Mapping[str, Floats] | None = None,
        spoken: Mapping[str, str] | None = None,
    ) -> Ranking:
        """Rank labels by `values` (K,), (S, K) or (S, K, V)."""
        order = sorted(values, key=lambda label: float(values[label].mean()))
        return cls({label: cells(values[label]) for label in order}, left or {}, verb, spoken or {})

    @property
    def labels(self) -> list[str]:
        """The labels in their order."""
        return list(self.missions)

    @cached_property
    def values(self) -> dict[str, Floats]:
        """Label -> mean over worlds (S, K)."""
        return {label: own.mean(axis=2) for label, own in self.missions.items()}

    @property
    def heavy(self) -> list[str]:
        """Labels whose intervals are too narrow, as a few scenarios have most of the cost."""
        return [label for label, own in self.values.items() if heavy_tailed(own.mean(axis=0))]

    @property
    def scenarios(self) -> int:
        """K."""
        return int(self.values[self.labels[0]].shape[1])

    @property
    def tail(self) -> float:
        """Probability of each tail outside of an interval, so that those of all pairs hold together."""
        return TAIL / self.pairs

    @property
    def pairs(self) -> int:
        """Number of comparisons; 1 at least."""
        return max(math.comb(len(self.missions), 2), 1)

    @cached_property
    def means(self) -> dict[str, Estimate]:
        """Label -> mean with its own 95 % interval."""
        return {label: Estimate.of_amounts(own) for label, own in self.values.items()}

    def ratio(self, label: str, to: str) -> Ratio:
        """Return the ratio of the means of two."""
        return Ratio.between(label, to, self.missions, self.left)

    def interval(self, label: str, to: str) -> Interval | None:
        """Return the interval of the ratio of two, which holds together with those of all pairs."""
        return self.ratio(label, to).interval(self.tail)

    @cached_property
    def ps(self) -> dict[frozenset[str], float | None]:
        """Pair of labels -> p-value corrected for all pairs; None where there are too few scenarios for a statement."""
        pairs = list(itertools.combinations(self.labels, 2))
        return dict(zip(map(frozenset, pairs), corrected_ps([self.ratio(b, a) for a, b in pairs]), strict=True))

    def apart(self, label: str, other: str) -> bool:
        """Return whether two can be told apart."""
        p = self.ps[frozenset((label, other))]
        return p is not None and p < ALPHA

    def name(self, label: str) -> str:
        """Return what a strategy is called in a sentence."""
        return self.spoken.get(label, label.removeprefix("fixed:"))

    def sentences(self, yardsticks: Sequence[str] = (), tried: Sequence[str] = ()) -> list[str]:
        """Return one sentence on the best, and at most one on those that cannot be told from it or from chance.

        Args:
            yardsticks: labels that the best is compared with, the first of them that is there and is not the best;
                the last of all unless one is.
            tried: labels that ought to differ from `RANDOM`.

        """
        best, *others = self.labels
        mean = f"{amount(self.means[best].value)} s a mission{interval_words(self.means[best].ci95, amount)}"
        mean += " (too narrow: heavy tails)" if best in self.heavy else ""
        if not others:
            return [f"{self.name(best)} {self.verb} {mean}; nothing is compared with it."]
        yardstick = next((label for label in (*yardsticks, others[-1]) if label in others), others[-1])
        if self.scenarios < fewest(self.pairs):
            below = int((self.values[best].mean(axis=0) < self.values[yardstick].mean(axis=0)).sum())
            many = f"{self.scenarios} scenario{'s' * (self.scenarios > 1)}"
            return [
                f"{self.name(best)} {self.verb} least: {mean}, less than {self.name(yardstick)} in {below} of {many}.",
                f"{many} cannot tell {len(self.labels)} strategies apart: {fewest(self.pairs)} may"
                f"{self._needed(others[0], best, TOLD)}.",
            ]
        alike = [label for label in others if not self.apart(label, best)]
        if len(alike) == len(others):
            return [
                f"{listed([self.name(label) for label in self.labels])} cannot be told apart "
                f"{self._would_tell(best, others)}; {self.name(best)} has the lowest mean, {mean}."
            ]
        found = [f"{self.name(best)} {self.verb} least: {mean}, {self._less(best, yardstick)}."]
        random = [label for label in tried if label not in alike and label != best and not self.apart(label, RANDOM)]
        parts = [
            f"{listed([self.name(label) for label in own])} cannot be told from {what} {self._would_tell(to, own)}"
            for own, what, to in ((alike, "it", best), (random, CHANCE, RANDOM))
            if own
        ]
        return [*found, *([f"{'; '.join(parts)}."] if parts else [f"Next is {self._next(others[0], best)}."])]

    def _next(self, label: str, best: str) -> str:
        ratio, said = self.ratio(label, best).ratio, f"{self.name(label)}, {amount(self.means[label].value)} s"
        ends = interval_words(self.interval(label, best), ratio_words)
        return said if ratio is None else f"{said}, {ratio_words(ratio)} times as much{ends}"

    def _less(self, best: str, other: str) -> str:
        if not self.apart(other, best):
            return f"which cannot be told from {self.name(other)} {self._would_tell(best, [other])}"
        ratio, ends = self.ratio(other, best).ratio, self.interval(other, best)
        if ratio is None or ends is None:
            return f"{self.name(other)} {amount(self.means[other].value)} s"
        if ratio >= TIMES:
            return f"{amount(ratio)} times less than {self.name(other)}{interval_words(ends, amount)}"
        low, high = (1.0 - 1.0 / end for end in ends)
        return f"{1.0 - 1.0 / ratio:.0%} less than {self.name(other)} [{low:.0%}, {high:.0%}]"

    def _would_tell(self, label: str, others: Sequence[str]) -> str:
        """Return in brackets how many scenarios there are, and how many would tell the one that differs most."""
        far = max(others, key=lambda other: abs(self.means[other].value - self.means[label].value))
        ratio = self.ratio(far, label)
        if np.array_equal(self.values[far], self.values[label]):
            return "(the same in every scenario)"
        effect = abs(math.log(ratio.ratio)) if ratio.ratio is not None and ratio.ratio > 0.0 else TOLD
        return f"({self.scenarios} scenarios{self._needed(far, label, max(effect, TOLD))})"

    def _needed(self, label: str, other: str, effect: float) -> str:
        test = self.ratio(label, other).tests[0]
        if test.spread <= NO_SPREAD:
            return ""
        needed, what = test.needed(effect, self.tail), " a tenth" if effect == TOLD else ""
        if needed is None:
            return "; more trainings are needed, not more scenarios"
        if needed <= self.scenarios:
            return f", enough to tell{what}" if what else ""
        return f"; about {about_number(needed)} would tell{what}"


def unfinished_sentence(left: Mapping[str, Floats], ranking: Ranking, word: str = "left unfinished") -> str:
    """Return how many missions were not completed, and whose; empty where that means nothing.

    `left`: label -> 1 where a mission was not completed (S, K, V).
    """
    missions, counts = sum(own.size for own in left.values()), {label: int(own.sum()) for label, own in left.items()}
    lost = sum(counts.values())
    blamed = sorted((label for label in counts if counts[label]), key=counts.__getitem__, reverse=True)
    if not missions:
        return ""
    if not lost or lost == missions:
        return f"{'Every' if lost else 'No'} mission of {missions} was {word}."
    whose = listed([ranking.name(label) for label in blamed])
    return f"{lost} of {missions} missions {'was' if lost == 1 else 'were'} {word}, by {whose}."


def most_left(left: Floats) -> float:
    """Return the upper 95 % bound of the share of 1 in `left` (S, K, V), by scenarios.

    >>> round(most_left(np.zeros((1, 30, 1))), 3), most_left(np.ones((1, 30, 1)))
    (0.095, 1.0)

    """
    return share_interval(float(left.mean()), left.shape[1], 2.0 * TAIL)[1]


def amount(value: float) -> str:
    """Return a number with two digits at least, and all of those before the point.

    >>> amount(1421.83), amount(5.29), amount(0.0412), amount(0.0)
    ('1,422', '5.3', '0.041', '0')

    """
    return f"{value:,.0f}" if abs(value) >= 9.95 or value == 0.0 else f"{value:#.2g}"


def ratio_words(ratio: float) -> str:
    """Return a ratio with two digits behind the point, none from 10 on; those beyond `LARGEST_RATIO` say nothing more.

    >>> ratio_words(1.3478), ratio_words(263.1), ratio_words(1116.15)
    ('1.35', '263', 'over 1,000')

    """
    if ratio > LARGEST_RATIO:
        return f"over {LARGEST_RATIO:,}"
    return f"{ratio:.2f}" if ratio < 9.995 else f"{ratio:.0f}"


def interval_words(ends: Interval | None, words: Callable[[float], str]) -> str:
    """Return an interval in brackets after a space, each end in words; empty if there is none."""
    return "" if ends is None else f" [{words(ends[0])}, {words(ends[1])}]"


def listed(names: Sequence[str]) -> str:
    """Return names in a row, those beyond the first few by their number."""
    if len(names) > MOST_NAMED + 1:
        names = [*names[:MOST_NAMED], f"{len(names) - MOST_NAMED} others"]
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
