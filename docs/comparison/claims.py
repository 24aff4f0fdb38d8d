"""Claims about strategies on several families at once: p-values and intervals that are corrected for their number.

Of many families some look different by chance. Holm's step-down method corrects the p-values of sign flips: it keeps
the probability of a single wrong claim below 5 % however the families depend on each other (Holm 1979, "A simple
sequentially rejective multiple test procedure"). The corrected interval of each family is Bonferroni's, so that all of
them hold together.

Shapes: S training seeds, K scenarios, V world seeds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import place_of
from clean_swarm_env.config.types import ConfigurationError
from selforg.arrays import Floats
from selforg.registry import unknown
from train.analysis.family_report import FamilyRuns, censored, excesses_of
from train.analysis.flips import TAIL, fewest
from train.analysis.intervals import Interval, Ratio, corrected_ps
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import BestFixed
from train.evaluation.base import Identity
from train.reports.text_table import EMPTY_CELL, Grid, interval_cell
from train.running.finished_runs import JOURNAL, runs_of
from train.running.run_folder import read_manifest

ANY_RATIO = (0.0, float("inf"))
"""The interval of a ratio of which nothing is known."""


@dataclass(frozen=True)
class Claim:
    """The ratio of two strategies' mean excess on one family."""

    family: str
    strategy: str
    against: str
    of: Ratio
    """The ratio, with the interval and the p-value that it has alone."""
    corrected: Interval
    """Joint interval with those of all other claims."""
    holm: float | None
    """p-value corrected for the number of claims; None for few scenarios."""

    @property
    def ratio(self) -> float:
        """The ratio; infinite if the other strategy has no excess."""
        return np.inf if self.of.ratio is None else self.of.ratio

    @property
    def ci95(self) -> Interval:
        """The 95 % interval of this claim alone; without bounds if none is known."""
        return self.of.ci95 or ANY_RATIO


def claims_of(
    asked: Sequence[tuple[str, str, str]],
    families: Mapping[str, Mapping[str, Floats]],
    left: Mapping[str, Mapping[str, Floats]] | None = None,
) -> list[Claim]:
    """Return one claim for each comparison.

    Args:
        asked: family, label, and label of the strategy with which it is compared.
        families: family -> label -> excess costs (S, K, V), at least two scenarios.
        left: family -> label -> 1 where a mission was not completed (S, K, V); nothing where that means nothing.

    """
    ratios = [
        Ratio.between(label, against, families[family], (left or {}).get(family)) for family, label, against in asked
    ]
    ps, tail = corrected_ps(ratios), TAIL / max(len(ratios), 1)
    return [
        Claim(*names, one, one.interval(tail) or ANY_RATIO, p) for names, one, p in zip(asked, ratios, ps, strict=True)
    ]


def family_runs(directory: Path) -> FamilyRuns:
    """Return the runs of a directory of results; ConfigurationError if it is none of a family, or lacks runs."""
    manifest = read_manifest(directory)
    if "family" not in manifest["identity"] or "strategies" not in manifest["identity"]:
        raise ConfigurationError(f"{directory}: expected results of `evaluate --family`")
    identity = Identity.of(manifest, directory)
    entrants = identity.entrants
    records = runs_of(directory / JOURNAL)
    places = {place_of(record.scenario) for record in records}
    scenarios, worlds = (max((place[k] for place in places), default=-1) + 1 for k in (0, 1))
    missing = scenarios * worlds * sum(len(entrant.members) for entrant in entrants) - len(records)
    if scenarios < 2 or missing:
        raise ConfigurationError(f"{directory}: expected all runs of two scenarios or more; {missing} are missing")
    return FamilyRuns(
        family=identity.family(directory),
        goal=identity.goal,
        seed=identity.seed,
        scenarios=scenarios,
        worlds=worlds,
        conditions={entrant.label: entrant.conditions for entrant in entrants},
        fixed=tuple(entrant.label for entrant in entrants if entrant.fixed),
        records=records,
    )


def claims_over(
    directories: Sequence[Path], strategies: Sequence[str], against: str
) -> tuple[list[Claim], dict[str, dict[str, float]]]:
    """Return the claims about `strategies` beside `against` (a label; empty: the best fixed option of each family).

    Beside them stand family -> label -> share of unfinished missions, without labels where garbage keeps coming.
    """
    families, others, lost = {}, {}, {}
    for directory in directories:
        runs = family_runs(directory)
        name, excesses = runs.family.name, excesses_of(runs)
        for label in (*strategies, *((against,) if against else ())):
            if label not in excesses:
                raise ConfigurationError(f"{directory}: {unknown('strategy', label, list(excesses))}")
        if name in families:
            raise ConfigurationError(f"{directory}: expected each family once, got {name} twice")
        if not (against or runs.fixed):
            raise ConfigurationError(f"{directory}: expected fixed options, or --against")
        best = None if against else BestFixed.of(excesses, runs.fixed)
        left = censored(runs)
        if best is not None:
            excesses[best.label] = best.judged(excesses)
            left |= {best.label: best.judged(left)} if left else {}
        families[name] = excesses
        lost[name] = left
        others[name] = against if best is None else best.label
    shares = {name: {label: float(own.mean()) for label, own in left.items()} for name, left in lost.items()}
    return claims_of(families, strategies, others, lost), shares


def claims_table(claims: Sequence[Claim], shares: Mapping[str, Mapping[str, float]]) -> Grid:
    """Return the claims as a table, with both shares of unfinished missions beside each ratio."""
    rows = [
        (
            f"{claim.strategy} on {claim.family}",
            claim.against,
            " / ".join(share_cell(left[label]) for label in (claim.strategy, claim.against)) if left else EMPTY_CELL,
            f"{claim.ratio:.3f}",
            interval_cell(claim.ci95),
            interval_cell(claim.corrected),
            *(EMPTY_CELL if p is None else f"{p:.2g}" for p in (claim.of.p, claim.holm)),
        )
        for claim in claims
        for left in (shares[claim.family],)
    ]
    heads = ("strategy", "against", "unfinished", "ratio of excess", "95 %", "95 % together", "p", "p (Holm)")
    notes = too_few(min((claim.of.scenarios for claim in claims), default=0), len(claims))
    return Grid(f"{len(claims)} claims, corrected for their number", heads, rows, notes=notes)


def too_few(scenarios: int, tests: int) -> tuple[str, ...]:
    """Return the line below a table whose scenarios are too few for its comparisons; none where they are enough.

    >>> too_few(2, 1)
    ('2 scenarios: no statement; 6 or more are needed',)

    """
    line = f"{scenarios} scenario{'s' * (scenarios != 1)}: no statement; {fewest(tests)} or more are needed"
    return (line,) if scenarios < fewest(tests) else ()
