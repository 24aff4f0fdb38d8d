"""The tables of the comparison with the work that came before, as Markdown.

Shapes: F fixed options, K scenarios.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import rankdata

from docs.comparison.claims import Claim, claims_of, interval_cell
from docs.comparison.manifest import BEST
from docs.comparison.prior.manifest import Place, PriorManifest
from docs.comparison.prior.missions import Done
from selforg.arrays import Floats
from train.analysis.flips import ALPHA, Flips, holm
from train.analysis.intervals import Estimate, heavy_tailed
from train.analysis.strategy_comparison import BestFixed
from train.reports.text_table import markdown_table

EVERY_SIZE = "all sizes"


class PriorTables:
    """The tables, and what they rest on.

    Args:
        manifest: the comparison.
        done: place and label -> missions, of all that the manifest asks for.

    Attributes:
        claims: place, label, and what it is compared with -> the claim, corrected for all claims.

    """

    def __init__(self, manifest: PriorManifest, done: Done) -> None:
        self._manifest, self._done = manifest, done
        self._best, self._figures = dict[str, BestFixed](), dict[str, dict[str, Floats]]()
        left = dict[str, dict[str, Floats]]()
        for (place, label), missions in done.items():
            self._figures.setdefault(place, {})[label] = np.array([[[one.figure] for one in missions]])
            left.setdefault(place, {})[label] = np.array([[[1.0 - one.completed] for one in missions]])
        for place, figures in self._figures.items():
            best = self._best[place] = BestFixed.of(figures, [*manifest.fixed])
            figures[BEST], left[place][BEST] = best.judged(figures), best.judged(left[place])
            if all(own.all() for own in left[place].values()):  # items keep coming
                left[place].clear()
        asked = manifest.comparisons
        claims = claims_of(asked, self._figures, left)
        self.claims: dict[tuple[str, str, str], Claim] = dict(zip(asked, claims, strict=True))

    def tables(self) -> dict[str, str]:
        """Return name -> table."""
        effort, learned = self._manifest.effort, self._manifest.learned
        beside = [pair for pair in learned.compared if pair[1] == BEST]
        ablated = [pair for pair in learned.compared if pair[1] != BEST]
        return {
            "correlation": self._correlations(),
            "effort": self._ratios(effort.places, effort.compared),
            "learned": self._ratios(learned.places, beside),
            "ablated": self._ratios(learned.places, ablated),
        }

    def _ratios(self, places: Mapping[str, Place], pairs: Sequence[tuple[str, str]]) -> str:
        """Return the ratios of pairs of labels in each place, bold where they are told from 1."""
        rows = []
        for name in places:
            best = f"{self._best[name].label}, {self._figures[name][BEST].mean():.2f} s"
            rows.append([f"`{name}`", best, *(self._cell(name, *pair) for pair in pairs)])
        return markdown_table(["missions", "best", *(f"{own} / {other}" for own, other in pairs)], rows)

    def _cell(self, place: str, label: str, against: str) -> str:
        """Return a ratio with its interval."""
        claim = self.claims[place, label, against]
        mark = "**" * (claim.holm is not None and claim.holm < ALPHA)
        own, other = (self._figures[place][name].ravel() for name in (label, against))
        heavy = ", heavy" * heavy_tailed(own / own.mean() - other / other.mean())
        return f"{mark}{claim.ratio:.3f}{mark} {interval_cell(claim.ci95)}{heavy}"

    def _correlations(self) -> str:
        """Return the correlations of a robot's output and its cost of coordination, bold where they are told from 0.

        They are over the fixed options, and for each family over these and all sizes.
        """
        parts, places = dict[tuple[str, str], list[tuple[Floats, Floats]]](), self._manifest.effort.places.items()
        for name, place in places:
            missions = [self._done[name, option] for option in self._manifest.fixed]
            output = np.array([[one.items_per_min / place.robots for one in own] for own in missions])
            cost = np.array([[one.coordination for one in own] for own in missions])
            for size in (str(place.robots), EVERY_SIZE):
                parts.setdefault((size, place.family), []).append((output, cost))
        found = [spearman(*map(np.concatenate, zip(*own, strict=True))) for own in parts.values()]
        tests = [Flips(values) for values in found]
        corrected = holm([one.p for one in tests], [one.least for one in tests])
        cells = dict[tuple[str, str], str]()
        for key, values, p in zip(parts, found, corrected, strict=True):
            mean, mark = Estimate.of(values[None]), "**" * (p < ALPHA)
            cells[key] = f"{mark}{mean.value:.2f}{mark} {interval_cell(mean.ci95, 2)}"
        families = list(dict.fromkeys(place.family for _, place in places))
        sizes = [*dict.fromkeys(str(place.robots) for _, place in places), EVERY_SIZE]
        rows = [[size, *(cells[size, family] for family in families)] for size in sizes]
        return markdown_table(["robots", *(f"`{family.removesuffix('.yaml')}`" for family in families)], rows)


def spearman(first: Floats, second: Floats) -> Floats:
    """Return Spearman's correlation (K,) over the rows of two tables (F, K).

    >>> spearman(np.array([[1.0], [2.0], [9.0]]), np.array([[3.0], [1.0], [0.0]])).tolist()
    [-1.0]

    """
    one, other = (ranks - ranks.mean(axis=0) for ranks in (rankdata(first, axis=0), rankdata(second, axis=0)))
    return np.asarray((one * other).sum(axis=0) / np.sqrt((one**2).sum(axis=0) * (other**2).sum(axis=0)))
