"""Strategies on a family with decision periods of different lengths, for which robots hold their options.

Shapes: P periods, K scenarios.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.mission import MissionResult
from selector.documents.errors import validated
from train.analysis.claims import claims_of
from train.analysis.family_report import unfinished
from train.analysis.spread import Ratio, too_few
from train.analysis.statistics import share_cell
from train.evaluation.entrants import entrants_of
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.reports.text_table import Grid, flat, interval_cell


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
    told, mission = list[Ratio](), asked.family.scenario(0, 0, "test").mission
    for entrant in entrants_of(asked.request.strategies, evaluations[0].options):
        own = [_results(evaluation, entrant.conditions) for evaluation in evaluations]
        excesses = [np.array([[result.excess_s for result in row] for row in results])[..., None] for results in own]
        tables = dict(zip(names, excesses, strict=True))
        claims = claims_of({asked.family.name: tables}, names[1:], {asked.family.name: names[0]})
        told += [claim.of for claim in claims]
        ratios = [("1", ""), *((f"{claim.ratio:.3f}", interval_cell(claim.ci95)) for claim in claims)]
        for name, results, ratio in zip(names, own, ratios, strict=True):
            left = unfinished(mission, [result for row in results for result in row])
            rows.append((f"{entrant.label}, {name}", share_cell(left), f"{float(tables[name].mean()):.1f}", *ratio))
    heads = ("unfinished", "excess s", f"ratio to {names[0]}", "95 %")
    return replace(flat(f"{asked.family.name}: decision periods", "strategy", heads, rows), notes=too_few(told))


def with_period(family: FamilyConfig, period: float) -> FamilyConfig:
    """Return the family with decision periods [s] of another length; DocumentError if that cannot be."""
    changed = {**family.mission.model_dump(), "decision_period": period}
    return family.model_copy(update={"mission": validated(MissionConfig, changed, "--period", own=True)})


def _results(evaluation: FamilyEvaluation, conditions: Sequence[str]) -> list[list[MissionResult]]:
    """Return the results (S, K) of the members of an entrant, one for each of S conditions."""
    found: dict[str, list[MissionResult]] = {name: [] for name in conditions}
    for task in evaluation.tasks(()):
        if task.condition in found:
            found[task.condition] += [record.result for record in task.run()]
    return [found[name] for name in conditions]
