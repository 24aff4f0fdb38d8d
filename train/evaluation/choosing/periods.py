"""Strategies on a family with decision periods of different lengths, for which robots hold their options.

Shapes: P periods, K scenarios.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import validated
from selforg.arrays import Floats
from train.analysis.claims import claims_of
from train.evaluation.entrants import entrants_of
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.reports.text_table import Grid, flat


@dataclass(frozen=True)
class PeriodsRequest:
    """The request of the user."""

    family: FamilyConfig
    request: FamilyRequest
    """Strategies and scenarios; its own family is not read."""
    periods: tuple[float, ...]
    """Lengths of a decision period [s], the first of which the others are compared with."""


def periods_table(asked: PeriodsRequest) -> Grid:
    """Run all strategies with all periods on the same scenarios, and return their excess costs as a table."""
    evaluations = [FamilyEvaluation(asked.request, with_period(asked.family, period)) for period in asked.periods]
    names = [f"{period:g} s" for period in asked.periods]
    rows: list[tuple[str, ...]] = []
    for entrant in entrants_of(asked.request.strategies, evaluations[0].options):
        own = [_excesses(evaluation, entrant.conditions) for evaluation in evaluations]
        tables = dict(zip(names, own, strict=True))
        claims = claims_of({asked.family.name: tables}, names[1:], {asked.family.name: names[0]})
        ratios = [("1", ""), *((f"{c.ratio:.3f}", f"[{c.ci95[0]:.3f}, {c.ci95[1]:.3f}]") for c in claims)]
        for name, excesses, ratio in zip(names, own, ratios, strict=True):
            rows.append((f"{entrant.label}, {name}", f"{float(excesses.mean()):.1f}", *ratio))
    heads = ("excess s", f"ratio to {names[0]}", "95 %")
    return flat(f"{asked.family.name}: decision periods", "strategy", heads, rows)


def with_period(family: FamilyConfig, period: float) -> FamilyConfig:
    """Return the family with decision periods [s] of another length; DocumentError if that cannot be."""
    changed = {**family.mission.model_dump(), "decision_period": period}
    return family.model_copy(update={"mission": validated(MissionConfig, changed, "--period")})


def _excesses(evaluation: FamilyEvaluation, conditions: Sequence[str]) -> Floats:
    """Return the excess costs (S, K, 1) of the members of an entrant, one for each of S conditions."""
    found: dict[str, list[float]] = {name: [] for name in conditions}
    for task in evaluation.tasks(()):
        if task.condition in found:
            found[task.condition] += [record.result.excess_s for record in task.run()]
    return np.array([found[name] for name in conditions])[..., None]
