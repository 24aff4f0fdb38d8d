"""Whether a learner may be a default: judged on held families, beside the best configured pair of each.

It is accepted if it costs at most `MOST` of that pair over all held families, is not shown to cost more on any of them,
is not shown to leave more missions unfinished, and takes what telling offers where that is known (`at_most` of the
manifest). All seeds of its training are judged. Seeds and scenarios are drawn at random, so both are drawn again for
the intervals: a resample takes n - 1 of n, so that its variance is that of the mean also for three seeds (Rao and Wu
1988, doi:10.1080/01621459.1988.10478591), and the same seeds on all families. With few seeds such an interval is still
too narrow where these differ much.

`python -m docs.comparison.acceptance [--judge] [MANIFEST]` does the missions that are missing, unless told to judge
only, and writes the tables of the page. MANIFEST is docs/comparison/protocol.yaml unless given.

Shapes: S seeds, K scenarios, B resamples.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

import numpy as np

from clean_swarm_env.deciders.named import FIXED
from docs.comparison.claims import interval_cell
from docs.comparison.manifest import BEST, Manifest
from docs.comparison.missions import Judged
from docs.comparison.tables import FamilyFigures
from docs.comparison.write_choosing import asked_missions, inputs_of, put_tables
from docs.figures.stored import ROOT
from selforg.arrays import Floats
from train.analysis.flips import ALPHA, TAIL, Flips
from train.reports.text_table import EMPTY_CELL, markdown_table

OWN = Path(__file__).resolve().with_name("protocol.yaml")
COMMAND = "python -m docs.comparison.acceptance"
MOST = 1.05
"""Largest ratio to the best configured pair: of a family its lower bound, of the geometric mean its upper bound."""
RESAMPLES = 10_000
OVERALL = "all families"
Bounded = tuple[float, float, float]
"""A figure with the ends of its 95 % interval."""


class Acceptance:
    """What decides whether a strategy is accepted.

    Args:
        label: the strategy.
        figures: family -> missions.
        at_most: family -> largest ratio; other families have none.

    Attributes:
        whole: whether it did missions on all families; others are shown, and neither accepted nor refused.

    """

    def __init__(self, label: str, figures: Mapping[str, FamilyFigures], at_most: Mapping[str, float]) -> None:
        self._label, self._at_most = label, at_most
        self._figures = {family: one for family, one in figures.items() if label in one.excesses}
        self.whole = len(self._figures) == len(figures)

    @cached_property
    def ratios(self) -> dict[str, Bounded]:
        """Ratio to the best configured pair of each family, and under `OVERALL` their geometric mean."""
        rng = np.random.default_rng(0)
        seeds, logs, drawn = _weights(rng, self.seeds), [], []
        for one in self._figures.values():
            own, best = one.excesses[self._label][:, :, 0], one.excesses[BEST][0, :, 0]
            scenarios = _weights(rng, len(best))
            logs.append(np.log(own.mean() / best.mean()))
            drawn.append(np.log(((seeds @ own) * scenarios).sum(axis=1) / (scenarios @ best)))
        all_drawn = np.stack([*drawn, np.mean(drawn, axis=0)])
        bounds = np.quantile(all_drawn, (TAIL, 1.0 - TAIL), axis=1)
        values, lows, highs = np.exp([[*logs, np.mean(logs)], *bounds]).tolist()
        return dict(zip((*self._figures, OVERALL), zip(values, lows, highs, strict=True), strict=True))

    @property
    def without_one(self) -> dict[str, float]:
        """Family -> the geometric mean over all others."""
        logs = {name: np.log(ratio) for name, (ratio, *_) in self.ratios.items() if name != OVERALL}
        total = sum(logs.values())
        return {name: float(np.exp((total - own) / (len(logs) - 1))) for name, own in logs.items()}

    @property
    def seeds(self) -> int:
        """S."""
        return len(next(iter(self._figures.values())).excesses[self._label])

    @cached_property
    def unfinished(self) -> tuple[float, float]:
        """How many more missions are unfinished than of the pairs, mean over seeds, and the one-sided exact p-value."""
        ending = [one.left for one in self._figures.values() if one.left]
        more = [left[self._label].mean(axis=0) - left[BEST][0] for left in ending]
        test = Flips(np.concatenate(more)[:, 0] if more else np.zeros(1))
        return float(test.differences.sum()), test.p / 2.0 if test.sign > 0.0 else 1.0

    @cached_property
    def dear(self) -> list[str]:
        """Families on which it is shown to cost more."""
        return [name for name, (_, low, _) in self.ratios.items() if low > MOST and name != OVERALL]

    @cached_property
    def refusals(self) -> list[str]:
        """Why it is not accepted, a few words each; none if it is."""
        high, (more, p) = self.ratios[OVERALL][2], self.unfinished
        said = {name: f"on `{name}` it costs {_cell(ratio)} of the best pair" for name, ratio in self.ratios.items()}
        shy = {name: most for name, most in self._at_most.items() if self.ratios[name][0] > most}
        return [
            *(said[name] for name in self.dear),
            *([f"its geometric mean may be {high:.3f}, more than {MOST}"] if high > MOST else []),
            *([f"it leaves {more:.1f} missions more unfinished than the pairs (p {p:.2g})"] if p < ALPHA else []),
            *(f"{said[name]}, more than {most}" for name, most in shy.items()),
        ]

    @property
    def verdict(self) -> str:
        """One sentence."""
        mean = f"`{self._label}` costs {_cell(self.ratios[OVERALL])} of the best pairs of {len(self._figures)} families"
        return f"{mean} and is not accepted: {'; '.join(self.refusals)}." if self.refusals else f"{mean}: accepted."


def _weights(rng: np.random.Generator, count: int) -> Floats:
    """Return weights (B, count) of means in resamples: n - 1 of n are drawn; a single one is always taken."""
    drawn = max(count - 1, 1)
    return rng.multinomial(drawn, np.full(count, 1.0 / count), RESAMPLES) / drawn


def _cell(bounded: Bounded) -> str:
    return f"{bounded[0]:.3f} {interval_cell(bounded[1:])}"


def _range_without_one(judged: Acceptance) -> str:
    means = sorted((mean, family) for family, mean in judged.without_one.items())
    return " to ".join(f"{mean:.3f} (`{family}`)" for mean, family in (means[0], means[-1]))


def acceptances(manifest: Manifest, figures: Mapping[str, FamilyFigures]) -> dict[str, Acceptance]:
    """Return label -> what is known of a strategy, or of all trainings of a learner."""
    labels = dict.fromkeys(label for one in figures.values() for label in one.excesses)
    return {
        label: Acceptance(label, figures, manifest.at_most)
        for label in labels
        if label != BEST and not label.startswith(FIXED)
    }


def figures_of(manifest: Manifest, missions: Mapping[tuple[str, str], Judged]) -> dict[str, FamilyFigures]:
    """Return family -> missions of all strategies."""
    return {family: FamilyFigures.of(manifest, family, missions) for family in manifest.families}


def acceptance_tables(manifest: Manifest, figures: Mapping[str, FamilyFigures]) -> dict[str, str]:
    """Return name -> table: what decides, and ratios to the best pairs."""
    judged, families = acceptances(manifest, figures), list(figures)
    heads = [
        "strategy",
        "seeds",
        "geometric mean",
        "without one family",
        "dearer families",
        "missions more unfinished",
    ]
    heads += [f"`{family}`, at most {most}" for family, most in manifest.at_most.items()]
    decided = [
        [
            f"`{label}`",
            str(one.seeds),
            _cell(one.ratios[OVERALL]),
            _range_without_one(one),
            str(len(one.dear)),
            "{:+.1f}, p {:.2g}".format(*one.unfinished),
            *(f"{one.ratios[family][0]:.3f}" for family in manifest.at_most),
            "no" if one.refusals else "yes",
        ]
        for label, one in judged.items()
        if one.whole
    ]
    pairs = [one.best.label.replace(f"{FIXED}:", "").replace("+", ", ") for one in figures.values()]
    ratios = [
        [f"`{label}`", *(_cell(one.ratios[family]) if family in one.ratios else EMPTY_CELL for family in families)]
        for label, one in judged.items()
    ]
    quoted = [f"`{family}`" for family in families]
    return {
        "accepted": markdown_table([*heads, "accepted"], decided),
        "ratios": markdown_table(["ratio to the best pair", *quoted], [["best pair", *pairs], *ratios]),
    }


def main(arguments: list[str]) -> None:
    """Write the tables of the page, and print the verdicts of the learners."""
    given, manifest, file, missions = asked_missions(arguments, OWN)
    figures = figures_of(manifest, missions)
    inputs = [*inputs_of(given, manifest.families), file.resolve().relative_to(ROOT).as_posix()]
    put_tables(manifest.name, acceptance_tables(manifest, figures), COMMAND, inputs)
    judged = acceptances(manifest, figures)
    print("\n".join(f"- {judged[label].verdict}" for label in manifest.trained))


if __name__ == "__main__":
    main(sys.argv[1:])
