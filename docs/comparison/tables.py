"""The tables of a comparison as Markdown, and what has to hold."""

from collections.abc import Sequence
from functools import cached_property
from math import exp, log
from pathlib import Path

import numpy as np

from clean_swarm_env.config.load import load_family
from docs.comparison.claims import family_runs
from docs.comparison.headroom import scenario_kinds
from docs.comparison.manifest import Manifest
from docs.comparison.raced_numbers import numbers_table
from docs.comparison.runs import (
    NUMBERS as NUMBERS_FOLDER,
)
from docs.comparison.runs import (
    SCREENING,
    SHUFFLED,
    TOLD,
    best_checkpoint,
    configured,
    cpu_minutes,
    first_checkpoint,
    judged_folder,
    raced,
    raced_numbers,
    ships,
    shown_options,
)
from selforg.arrays import Floats
from train.analysis.family_report import excesses_of, unfinished_of
from train.analysis.flips import ALPHA
from train.analysis.intervals import MeanError, Ratio, corrected_ps
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import Estimate
from train.analysis.verdict import RANDOM, interval_words, listed
from train.deciders.named import FIXED
from train.reports.text_table import EMPTY_CELL, interval_cell, markdown_table

NOT_WORSE = 1.02
"""Largest ratio of what is not worse: the lower end of an interval, or a mean over families."""
WAY = 0.6
"""Share of the way to a team that is told that is to be reached."""
NOTHING = f"{FIXED}:Off"
BEST = "best options"
"""Label of the options that the race found."""
NUMBERS = "raced numbers"
"""Label of the options whose numbers were raced, too."""
CHEAPER = "cheaper"
"""Label of those of the two that cost less: a policy has to beat both."""


class Results:
    """The results of all families.

    Args:
        manifest: the comparison.
        folder: directory of its results.

    Attributes:
        best: family -> the best options, as the race found them.

    """

    def __init__(self, manifest: Manifest, folder: Path) -> None:
        self._manifest, self._folder = manifest, folder
        self._raced = {family: raced(manifest, folder, family) for family in manifest.families}
        self.best = {family: found.best for family, found in self._raced.items()}
        self._numbers = {family: configured(manifest, folder, family) for family in manifest.families}
        self._left: dict[str, dict[str, Floats]] = {}
        self._excesses = {family: self._judged(family, family, manifest.seeds) for family in manifest.families}
        self._screened: dict[str, dict[str, Floats]] = {}
        if manifest.screening is not None:
            seeds = (manifest.screening.seed,)
            self._screened = {f: self._judged(f, f"{f}-{SCREENING}", seeds) for f in manifest.families}
        for family, own in self._excesses.items():
            if self._raced[family].told:
                own[TOLD] = self._of_the_told(family)
            raced_too = NUMBERS in own and own[NUMBERS].mean() < own[BEST].mean()
            for table in (own, self._left[family]):
                if BEST in table:
                    table[CHEAPER] = table[NUMBERS if raced_too else BEST]

    def ratio(self, family: str, label: str, against: str = BEST) -> Ratio | None:
        """Return the ratio of two labels on a family; None where one of them was dropped in the screening.

        What the screening drops is not judged: a figure by which somebody was chosen says too much.
        """
        own, left = self._excesses[family], self._left[family]
        if label not in own or against not in own:
            return None
        return Ratio.of(
            own[label], own[against], (left[label], left[against]) if {label, against} <= set(left) else None
        )

    @cached_property
    def _ps(self) -> dict[tuple[str, str, str], float | None]:
        """Family, label, and what it is compared with -> p-value by sign flips, by Holm over the page."""
        claimed, rules = self._manifest.claimed, list(self._manifest.rules)
        pairs = [(label, BEST) for label in (*self._manifest.learners, *rules, NUMBERS, TOLD, RANDOM, NOTHING)]
        pairs += [(claimed, other) for other in (*self._manifest.learners, *rules, CHEAPER) if other != claimed]
        every = [(family, *pair) for family in self._manifest.families for pair in pairs]
        found = {one: ratio for one in every if (ratio := self.ratio(*one)) is not None}
        return dict(zip(found, corrected_ps(list(found.values())), strict=True))

    def _told(self, family: str, label: str, against: str = BEST) -> float:
        """Return 1 where the first is shown to cost more than the second, -1 where it costs less, else 0."""
        p, ratio = self._ps.get((family, label, against)), self.ratio(family, label, against)
        return ratio.sign if ratio is not None and p is not None and p < ALPHA else 0.0

    def _judged_cell(self, family: str, label: str, against: str = BEST) -> str:
        """Return a ratio with its interval, bold where the first is shown to be cheaper."""
        return _cell(self.ratio(family, label, against), bold=self._told(family, label, against) < 0.0)

    def tables(self) -> dict[str, str]:
        """Return name -> table."""
        tables = {"main": self._main(), "learners": self._learners(), "told": self._headroom()}
        if self._manifest.numbers is not None:
            tables["numbers"] = numbers_table(raced_numbers(self._manifest, self._folder))
        if self._manifest.screening is not None:
            tables["trainings"] = self._trainings()
        if self._manifest.variants:
            tables["variants"] = self._variants()
        if self._manifest.ablations is not None:
            tables["ablations"] = self._ablated(list(self._manifest.ablations.of), self._manifest.ablations.families)
        return {**tables, "unfinished": self._unfinished()}

    def broken(self) -> list[str]:
        """Return what does not hold of what was asked of the claimed learner."""
        claimed, families, lost = self._manifest.claimed, list(self._manifest.families), []
        ratios = {family: self._shown(family, claimed) for family in families}
        for family, (ratio, low, _) in ratios.items():
            if low > NOT_WORSE:
                lost.append(f"`{family}`: worse than the best options, {ratio:.3f}")
        middle = exp(float(np.mean([log(ratio) for ratio, *_ in ratios.values()])))
        if middle > NOT_WORSE:
            lost.append(f"geometric mean over families: {middle:.3f}, above {NOT_WORSE:g}")
        gaining = [family for family in families if self._manifest.families[family].headroom]
        lost += [
            f"`{family}`: not shown to be better than the best options, {ratios[family][0]:.3f}"
            for family in gaining
            if self._told(family, claimed) >= 0.0
        ]
        ways = [self._way(family).value for family in gaining]
        if ways and np.mean(ways) < WAY:
            lost.append(f"{np.mean(ways):.0%} of the way from the best options to a told team, {WAY:.0%} wanted (mean)")
        for rule in self._manifest.rules:
            better = [f for f in gaining if self._told(f, claimed, rule) < 0.0]
            if 2 * len(better) < len(gaining):
                lost.append(f"shown to be better than `{rule}` on {len(better)} of {len(gaining)} families")
        for label in self._manifest.learners:
            others = [f for f in families if label != claimed and self.ratio(f, claimed, label) is not None]
            worse = [f for f in others if self._told(f, claimed, label) >= 0.0]
            if worse:
                lost.append(f"not shown to be better than `{label}` on {listed([f'`{family}`' for family in worse])}")
        for label in self._manifest.variants:
            found = self._variant_ratio(label)
            if _ends(found)[0] > NOT_WORSE:
                lost.append(f"{label}: worse than the best options, {found.ratio:.3f}")
        return lost + self._failing()

    @cached_property
    def geometric_mean(self) -> float:
        """The geometric mean over families of the ratios to the best options."""
        return exp(float(np.mean([log(self._shown(f, self._manifest.claimed)[0]) for f in self._manifest.families])))

    def _judged(self, family: str, label: str, seeds: Sequence[int]) -> dict[str, Floats]:
        """Return strategy -> excess costs (S, K, 1) of a family, also by the labels of held options."""
        own, numbers = self._read(label, seeds), self._numbers[family]
        if numbers and not ships(self._manifest, family, numbers) and label == family:
            own |= self._read(f"{family}-{NUMBERS_FOLDER}", seeds)
        for name, options in {BEST: self.best[family], NUMBERS: numbers}.items():
            if (held := f"{FIXED}:{options}") in own:
                own[name] = own[held]
                if held in self._left[label]:  # missions of this family end
                    self._left[label][name] = self._left[label][held]
        return own

    def _read(self, label: str, seeds: Sequence[int]) -> dict[str, Floats]:
        """Return strategy -> excess costs (S, K, 1) of all seeds; note the shares of unfinished missions."""
        runs = [family_runs(judged_folder(self._folder, label, seed)) for seed in seeds]
        each, left = [excesses_of(own) for own in runs], [unfinished_of(own) for own in runs]
        self._left[label] = {
            name: np.concatenate([own[name] for own in left], axis=1) for name in (left[0] if all(left) else ())
        }
        return {name: np.concatenate([own[name] for own in each], axis=1) for name in each[0]}

    def _of_the_told(self, family: str) -> Floats:
        """Return the excess costs (1, K, 1) of a team that takes the options for the kind of its scenario."""
        count, given = self._manifest.families[family].scenarios, load_family(family)
        own, told = self._excesses[family], self._raced[family].told
        kinds = [
            kind
            for seed in self._manifest.seeds
            for kind in scenario_kinds([given.scenario(seed, k, "test") for k in range(count)])
        ]
        labels = [f"{FIXED}:{told.get(kind, self.best[family])}" for kind in kinds]
        return np.array([[own[label][0, k] for k, label in enumerate(labels)]])

    def _shown(self, family: str, label: str, against: str = BEST) -> tuple[float, float, float]:
        """Return a ratio and the ends of its interval."""
        found = self.ratio(family, label, against)
        assert found is not None
        assert found.ratio is not None
        return found.ratio, *_ends(found)

    def _way(self, family: str) -> Estimate:
        """Return the share of the way from the best options to a team that is told, which is a searched choice."""
        own = self._excesses[family]
        best, given = (own[label].mean(axis=(0, 2)) for label in (BEST, TOLD))
        closed, width = best - own[self._manifest.claimed].mean(axis=2), float((best - given).mean())
        share = float(closed.mean()) / width
        spread = MeanError.of((closed - share * (best - given)) / width)
        return Estimate(share, None if spread is None else spread.around(share))

    def _main(self) -> str:
        """Return the claimed learner beside what would embarrass it: a row for each family."""
        claimed, rows = self._manifest.claimed, []
        for family, own in self._excesses.items():
            cells = [f"`{family}`", shown_options(self.best[family]), f"{own[BEST].mean():.1f}"]
            cells += [self._spread(family) if self._manifest.screening is None else self._judged_cell(family, claimed)]
            cells += [self._judged_cell(family, claimed, CHEAPER)] * (self._manifest.numbers is not None)
            cells += [self._judged_cell(family, label) for label in (RANDOM, NOTHING)]
            rows.append(cells)
        raced = [f"`{claimed}` / the cheaper of best and raced numbers"] * (self._manifest.numbers is not None)
        heads = ["family", "best options", "their excess s", f"`{claimed}` / best", *raced]
        heads += ["`Random` / best", "no avoidance / best"]
        mean = ["geometric mean", "", "", f"{self.geometric_mean:.3f}", *([""] * (len(heads) - 4))]
        return markdown_table(heads, [*rows, mean])

    def _spread(self, family: str) -> str:
        """Return the ratio of the trainings of the claimed learner to the best options, with the best and worst."""
        own = self._screened.get(family) or self._excesses[family]
        trainings, best = own[self._manifest.claimed], own[BEST]
        each = trainings.mean(axis=(1, 2)) / best.mean()
        spread = f"; {each.min():.2f} to {each.max():.2f}" if len(each) > 1 else ""
        return _cell(Ratio.of(trainings.mean(axis=2), best.mean(axis=(0, 2)))) + spread

    def _trainings(self) -> str:
        """Return what each training of the claimed learner reached on validation and in the screening."""
        claimed, rows = self._manifest.claimed, []
        folders = [self._folder / f"{claimed}-{seed}" for seed in self._manifest.learners[claimed].seeds]
        figures = [best_checkpoint(folder) for folder in folders]
        for name in sorted(name for name in figures[0] if name.endswith("/excess_s")):
            family = name.partition("/")[0]
            each = np.array([own[name] for own in figures])
            started = np.mean([first_checkpoint(folder)[name] for folder in folders])
            judged = self._spread(family) if family in self._manifest.families else EMPTY_CELL
            rows.append([f"`{family}`", *(f"{x:.1f}" for x in (started, each.mean(), each.min(), each.max())), judged])
        judged_only = [family for family in self._manifest.families if f"{family}/excess_s" not in figures[0]]
        rows += [[f"`{family}`, untrained", "", "", "", "", self._spread(family)] for family in judged_only]
        heads = [
            "family",
            "first checkpoint s",
            "best checkpoints s",
            "from",
            "to",
            f"`{claimed}` / best, all trainings",
        ]
        return markdown_table(heads, rows)

    def _learners(self) -> str:
        """Return all learners beside the best options of each family."""
        rows = []
        for label, learner in self._manifest.learners.items():
            minutes = cpu_minutes(self._folder, [f"{label}-{seed}" for seed in learner.seeds])
            cells = [self._judged_cell(family, label) for family in self._manifest.families]
            rows.append([f"`{label}`", str(len(learner.seeds)), f"{minutes:.1f}", *cells])
        for label in (*self._manifest.rules, *([NUMBERS] * (self._manifest.numbers is not None))):
            cells = [self._judged_cell(family, label) for family in self._manifest.families]
            rows.append([f"`{label}`" if label != NUMBERS else label, "", "", *cells])
        claimed = self._manifest.claimed
        for rule in self._manifest.rules:
            cells = [self._judged_cell(family, claimed, rule) for family in self._manifest.families]
            rows.append([f"`{claimed}` / `{rule}`", "", "", *cells])
        heads = ["", "trainings", "CPU min each", *(f"`{family}`" for family in self._manifest.families)]
        return markdown_table(heads, rows)

    def _headroom(self) -> str:
        """Return the claimed learner beside a team that is told, and with shuffled observations."""
        claimed, rows = self._manifest.claimed, []
        for family in self._manifest.families:
            if not self._manifest.families[family].headroom:
                continue
            first = self._manifest.screening
            seeds = self._manifest.seeds if first is None else (first.seed,)
            shuffled = self._read(f"{family}-{SHUFFLED}", seeds)[claimed].mean(axis=2)
            given = (self._screened or self._excesses)[family][BEST].mean(axis=(0, 2))
            cells = [self._judged_cell(family, label) for label in (TOLD, claimed)]
            way = self._way(family)
            ends = interval_words(way.ci95, "{:.0%}".format)
            rows.append([f"`{family}`", *cells, f"{way.value:.0%}{ends}", _cell(Ratio.of(shuffled, given))])
        heads = ["family", "told / best", f"`{claimed}` / best", "share of the way", "shuffled / best"]
        return markdown_table(heads, rows)

    def _variant_ratio(self, label: str) -> Ratio:
        own = self._read(label, self._manifest.seeds)
        best = f"{FIXED}:{self.best[self._manifest.variants[label].family]}"
        return Ratio.of(own[self._manifest.claimed].mean(axis=2), own[best].mean(axis=(0, 2)))

    def _variants(self) -> str:
        """Return the claimed learner beside the best options on families that differ."""
        rows = [
            [label, f"`{one.family}`", _cell(self._variant_ratio(label))]
            for label, one in self._manifest.variants.items()
        ]
        return markdown_table(["", "of", f"`{self._manifest.claimed}` / best"], rows)

    def _screened_ratio(self, family: str, label: str) -> Ratio | None:
        """Return the ratio of a label to the claimed learner on the scenarios on which all trainings were judged."""
        own = self._screened.get(family) or self._excesses[family]
        return Ratio.of(own[label], own[self._manifest.claimed]) if label in own else None

    def _ablated(self, labels: Sequence[str], families: Sequence[str]) -> str:
        """Return each ablation beside the claimed learner."""
        rows = [[label, *(_cell(self._screened_ratio(f, label)) for f in families)] for label in labels]
        return markdown_table(["", *(f"`{family}`" for family in families)], rows)

    def _unfinished(self) -> str:
        """Return shares of unfinished missions, where missions end."""
        ending = [family for family, left in self._left.items() if family in self._manifest.families and len(left) > 1]
        rows = []
        for label in (self._manifest.claimed, BEST, RANDOM, NOTHING):
            cells = []
            for family in ending:
                own = self._left[family]
                own = own if label in own else self._left.get(f"{family}-{SCREENING}", {})
                cells.append(share_cell(float(own[label].mean())) if label in own else EMPTY_CELL)
            rows.append([label, *cells])
        return markdown_table(["", *(f"`{family}`" for family in ending)], rows)

    def _failing(self) -> list[str]:
        """Return where the claimed learner leaves missions unfinished that the best options finish."""
        claimed, found = self._manifest.claimed, []
        for family in self._manifest.families:
            left = self._left[family]
            if claimed in left and (count := int(((left[claimed] > 0.0) & (left[BEST] == 0.0)).sum())):
                found.append(f"`{family}`: {count} missions unfinished that the best options finish")
        return found


def _ends(ratio: Ratio | None) -> tuple[float, float]:
    return (ratio and ratio.ci95) or (0.0, np.inf)


def _cell(ratio: Ratio | None, *, bold: bool = False) -> str:
    """Return a ratio with its interval."""
    if ratio is None or ratio.ratio is None:
        return EMPTY_CELL
    mark = "**" * bold
    return f"{mark}{ratio.ratio:.3f}{mark} {interval_cell(ratio.ci95)}"
