"""The tables of a comparison as Markdown, judged from the missions that are kept.

Shapes: K scenarios, B resamples.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.deciders.named import FIXED
from docs.comparison.claims import claims_of, interval_cell
from docs.comparison.manifest import BEST, OFF, TOLD, Manifest
from docs.comparison.missions import Judged
from selforg.arrays import Floats
from train.analysis.flips import ALPHA
from train.analysis.intervals import Interval, Ratio, heavy_tailed
from train.analysis.strategy_comparison import BestFixed
from train.analysis.verdict import RANDOM
from train.reports.text_table import EMPTY_CELL, markdown_table

RESAMPLES = 10_000
"""B, of the intervals of shares of the way."""
HEAVY = ", heavy"
"""What stands behind an interval that heavy tails make too narrow."""


@dataclass(frozen=True)
class FamilyFigures:
    """The missions of all strategies on one family, and of its best options.

    Attributes:
        best: which of the fixed options are the best.
        excesses: label -> excess (S, K, 1) [s]; a learner has S trainings.
        left: label -> 1 where a mission was not completed, else 0 (S, K, 1); nothing where garbage keeps coming.

    """

    best: BestFixed
    excesses: dict[str, Floats]
    left: dict[str, Floats]

    @classmethod
    def of(cls, manifest: Manifest, family: str, missions: Mapping[tuple[str, str], Judged]) -> FamilyFigures:
        """Return those of all labels whose missions are there; at least the fixed options have them."""
        fixed = [f"{FIXED}:{options}" for options in manifest.families[family].fixed]
        asked = {label: manifest.runs_of(label) for label in (*fixed, *manifest.judged_on(family))}
        judged = {
            label: [missions[family, run] for run in runs]
            for label, runs in asked.items()
            if all((family, run) in missions for run in runs)
        }
        excesses = {label: np.array([own.excess_s for own in runs])[:, :, None] for label, runs in judged.items()}
        best = BestFixed.of(excesses, fixed)
        left = {
            label: np.concatenate([_flags(own) for own in runs])
            for label, runs in judged.items()
            if runs[0].unfinished is not None
        }
        kept = {BEST: best.judged(left)} if left else {}
        return cls(best, excesses | {BEST: best.judged(excesses)}, left | kept)


class Tables:
    """The tables of a comparison.

    Args:
        manifest: the comparison.
        missions: family and label -> missions, of all that is compared.

    Attributes:
        figures: family -> missions of all strategies.
        claims: family, label, and what it is compared with -> the claim, corrected for all claims of the page.

    """

    def __init__(self, manifest: Manifest, missions: Mapping[tuple[str, str], Judged]) -> None:
        self._manifest = manifest
        self.figures = {family: FamilyFigures.of(manifest, family, missions) for family in manifest.families}
        self._excesses = {family: own.excesses for family, own in self.figures.items()}
        self._left = {family: own.left for family, own in self.figures.items()}
        claims = claims_of(manifest.comparisons, self._excesses, self._left)
        self.claims = dict(zip(manifest.comparisons, claims, strict=True))

    def told(self, family: str, label: str, against: str = BEST) -> float:
        """Return 1 where the first is shown to cost more than the second, -1 where it costs less, else 0."""
        claim = self.claims[family, label, against]
        return claim.of.sign if claim.holm is not None and claim.holm < ALPHA else 0.0

    def broken(self) -> list[str]:
        """Return the families on which the claimed strategy is not shown to be better, though it has to be."""
        claimed = self._manifest.claimed
        return [
            f"`{family}`: not shown to be better than the best options, {self.claims[family, claimed, BEST].ratio:.3f}"
            for family in self._manifest.better
            if self.told(family, claimed) >= 0.0
        ]

    def tables(self) -> dict[str, str]:
        """Return name -> table."""
        found = {"main": self._main(), "both": self._both()}
        return found | ({"told": self._told()} if any(TOLD in own for own in self._excesses.values()) else {})

    def _main(self) -> str:
        """Return the claimed strategy, the others, chance and no avoidance beside the best options of each family."""
        claimed, *others = self._manifest.strategies or self._manifest.trained
        rows = []
        for family, excesses in self._excesses.items():
            options = self.figures[family].best.label.replace(f"{FIXED}:", "").replace("+", ", ")
            cells = [f"`{family}`", str(excesses[BEST].size), options, f"{excesses[BEST].mean():.1f}"]
            cells += [self.cell(family, label) for label in (claimed, *others)]
            cells += [self.cell(family, claimed, other) for other in others]
            rows.append([*cells, *(self.cell(family, label) for label in (RANDOM, OFF))])
        heads = ["family", "scenarios", "best options", "their excess s"]
        heads += [f"`{label}` / best" for label in (claimed, *others)]
        heads += [f"`{claimed}` / `{other}`" for other in others]
        return markdown_table([*heads, f"`{RANDOM}` / best", f"{OFF} / best"], rows)

    def _told(self) -> str:
        """Return a told team, other trainings and shares of the way from the best options to the told team."""
        trained, ways = list(self._manifest.trained), list(self._manifest.strategies)
        rows = [
            [
                f"`{family}`",
                *(self.cell(family, label) for label in (TOLD, *trained)),
                *(self._way(family, label) for label in ways),
            ]
            for family, excesses in self._excesses.items()
            if TOLD in excesses
        ]
        heads = ["family", "told / best", *(f"`{label}` / best" for label in trained)]
        return markdown_table([*heads, *(f"way of `{label}`" for label in ways)], rows)

    def _both(self) -> str:
        """Return the ratios over missions that both finish, where one of the two leaves some unfinished."""
        rows = []
        for family, label, against in self.claims:
            left = self._left[family]
            if left and (ended := by_scenario(left[label] + left[against]) == 0.0).sum() < ended.size:
                own, other = (by_scenario(self._excesses[family][name])[ended] for name in (label, against))
                found = Ratio.of(own, other)
                cells = [f"`{family}`", f"{label} / {against}", f"{ended.sum()} of {ended.size}"]
                rows.append([*cells, f"{found.ratio:.3f} {interval_cell(found.ci95)}"])
        return markdown_table(["family", "ratio", "missions that both finish", "there"], rows)

    def cell(self, family: str, label: str, against: str = BEST) -> str:
        """Return a ratio with its interval, bold where the two are told apart."""
        claim = self.claims.get((family, label, against))
        if claim is None:
            return EMPTY_CELL
        mark = "**" * (self.told(family, label, against) != 0.0)
        own, other = (by_scenario(self._excesses[family][name]) for name in (label, against))
        heavy = HEAVY * heavy_tailed(own / own.mean() - other / other.mean())
        return f"{mark}{claim.ratio:.3f}{mark} {interval_cell(claim.ci95)}{heavy}"

    def _way(self, family: str, label: str) -> str:
        """Return the share of the way from the best options to a told team, with its interval."""
        own = self._excesses[family]
        if label not in own:
            return EMPTY_CELL
        share, ends = share_of_way(*(by_scenario(own[name]) for name in (BEST, label, TOLD)))
        return f"{100.0 * share:.0f} % [{100.0 * ends[0]:.0f}, {100.0 * ends[1]:.0f}]"


def share_of_way(best: Floats, own: Floats, told: Floats, resamples: int = RESAMPLES) -> tuple[float, Interval]:
    """Return the share of the way from `best` to `told`, excesses (K,), and its 95 % interval by paired bootstrap."""
    drawn = np.random.default_rng(0).integers(0, len(best), (resamples, len(best)))
    closed, whole = best - own, best - told
    shares = closed[drawn].mean(axis=1) / whole[drawn].mean(axis=1)
    low, high = np.quantile(shares, (0.025, 0.975)).tolist()
    return float(closed.mean() / whole.mean()), (low, high)


def by_scenario(values: Floats) -> Floats:
    """Return the means (K,) over trainings and worlds of values (S, K, 1)."""
    return values.mean(axis=(0, 2))


def _flags(judged: Judged) -> Floats:
    """Return 1 for each mission (1, K, 1) that was not completed, else 0."""
    return np.isin(np.arange(len(judged.excess_s)), judged.unfinished or []).astype(float)[None, :, None]
