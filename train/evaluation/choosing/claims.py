"""Claims over the results of several families: what strategies cost beside another one, corrected for their number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from clean_swarm_env.config.families import place_of
from clean_swarm_env.config.types import ConfigurationError
from selforg.registry import unknown
from train.analysis.claims import Claim, claims_of
from train.analysis.family_report import FamilyRuns, excesses_of, unfinished_of
from train.analysis.intervals import too_few
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import BestFixed
from train.evaluation.identity import Identity
from train.reports.text_table import EMPTY_CELL, Grid, interval_cell
from train.running.finished_runs import JOURNAL, runs_of
from train.running.run_folder import read_manifest


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
    families, others, shares = {}, {}, {}
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
        left = unfinished_of(runs)
        if best is not None:
            excesses[best.label] = best.judged(excesses)
            left |= {best.label: best.judged(left)} if left else {}
        families[name] = excesses
        shares[name] = {label: float(missions.mean()) for label, missions in left.items()}
        others[name] = against if best is None else best.label
    return claims_of(families, strategies, others), shares


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
            *(EMPTY_CELL if p is None else f"{p:.2g}" for p in (claim.p, claim.holm)),
        )
        for claim in claims
        for left in (shares[claim.family],)
    ]
    heads = ("strategy", "against", "unfinished", "ratio of excess", "95 %", "95 % together", "p", "p (Holm)")
    notes = too_few([claim.of for claim in claims])
    return Grid(f"{len(claims)} claims, corrected for their number", heads, rows, notes=notes)
