"""The report of a study: tables, `summary.json`, and the trials as a table for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import optuna
from optuna.importance import get_param_importances
from optuna.trial import create_trial

from train.analysis.intervals import too_few
from train.analysis.statistics import share_cell
from train.analysis.verdict import Ranking, amount, unfinished_sentence
from train.reports.ranking_table import ranking_table
from train.reports.text_table import EMPTY_CELL, Grid, interval_cell
from train.running.finished_runs import as_csv
from train.studies.conclusion import TO_BEAT, UNCHANGED, Conclusion, Stated
from train.studies.missions import COST, FIGURES, UNFINISHED
from train.studies.search import Arm
from train.studies.space import NULL_OPTION, StudySpace

Importances = Mapping[str, float]
FEWEST = 4
"""Least number of trials from which importances are computed."""


def importances(arms: Sequence[Arm], space: StudySpace) -> dict[str, float]:
    """Return the share of each dimension in the differences of cost, by PED-ANOVA; nothing for too few trials."""
    study = optuna.create_study()
    for trial in (trial for arm in arms for trial in arm.trials if trial.means):
        params = dict(zip(space.names, trial.candidate.values, strict=True))
        study.add_trial(create_trial(value=trial.means[COST], params=params, distributions=space.distributions))
    if len(study.trials) < FEWEST:
        return {}
    found = get_param_importances(study)
    return {name: float(found.get(name, 0.0)) for name in space.names}


def study_tables(conclusion: Conclusion, space: StudySpace, importance: Importances) -> list[Grid]:
    """Return the tables: cost of the result beside its yardsticks, and its values."""
    return [_costs(conclusion), _comparison(conclusion), _values(conclusion, space, importance)]


def ranking_of(conclusion: Conclusion) -> Ranking:
    """Return the result and its yardsticks by cost."""
    left = {one.label: one.figures[UNFINISHED][None, :, None] for one in conclusion.everyone}
    return Ranking.of({one.label: one.figures[COST] for one in conclusion.everyone}, left=left)


def study_summary(
    conclusion: Conclusion, space: StudySpace, arms: Sequence[Arm], importance: Importances
) -> dict[str, Any]:
    """Return the content of `summary.json`."""
    return {
        "result": {
            **_stated(conclusion.result, space),
            "ratios": {one.label: conclusion.result.ratio_to(one).content for one in conclusion.yardsticks},
            "not_shown_to_beat": conclusion.marks,
        },
        "yardsticks": [_stated(one, space) for one in conclusion.yardsticks],
        "importance": dict(importance),
        "missions": {arm.method: sum(trial.scenarios for trial in arm.trials) for arm in arms},
    }


def trials_csv(arms: Sequence[Arm], space: StudySpace) -> str:
    """Return all trials as CSV: name, values, number of scenarios when the method was told, estimated means."""
    trials = [trial for arm in arms for trial in arm.trials]
    rows = [(trial.candidate.name, *trial.candidate.values, trial.scenarios, *trial.means) for trial in trials]
    return as_csv(("trial", *space.names, "scenarios", *FIGURES), rows)


def verdict_of(conclusion: Conclusion) -> list[str]:
    """Return what came out, in one to three sentences."""
    ranking, label, marks = ranking_of(conclusion), conclusion.result.label, conclusion.marks
    shown = f"{label} is not shown to beat {' and '.join(marks)}." if marks else ""
    shown = shown or f"{label}: shown to beat {' and '.join(TO_BEAT)}."
    return [ranking.sentences((UNCHANGED, NULL_OPTION))[0], shown, unfinished_sentence(ranking.left, ranking)]


def _stated(stated: Stated, space: StudySpace) -> dict[str, Any]:
    figures = {name: asdict(summary) for name, summary in stated.summaries.items()}
    values = dict(zip(space.names, stated.candidate.values, strict=False))
    return {"name": stated.label, "trial": stated.candidate.name, "values": values, "figures": figures}


def _costs(conclusion: Conclusion) -> Grid:
    columns: dict[str, dict[str, str]] = {}
    for stated in conclusion.everyone:
        _, duration, events, avoiding, left = (stated.summaries[name].mean for name in FIGURES)
        cells = (share_cell(left), amount(duration), amount(events), share_cell(avoiding))
        for head, cell in zip(("unfinished", "duration s", "events", "avoiding"), cells, strict=True):
            columns.setdefault(head, {})[stated.label] = cell
    ranking = ranking_of(conclusion)
    title = f"means over {ranking.scenarios} training scenarios that decided nothing"
    return ranking_table(title, ranking, "cost s", columns, ("avoiding: share of the time",))


def _comparison(conclusion: Conclusion) -> Grid:
    result = conclusion.result
    row = (result.label, *_ratios(conclusion), ", ".join(conclusion.marks) or EMPTY_CELL)
    heads = ("result to", *TO_BEAT, UNCHANGED, "not shown to beat")
    few = too_few(result.figures.shape[1], len(TO_BEAT))
    return Grid("ratios of mean costs, with 95 % intervals", heads, [row], notes=few)


def _ratios(conclusion: Conclusion) -> list[str]:
    there = {one.label: one for one in conclusion.yardsticks}
    cells = []
    for label in (*TO_BEAT, UNCHANGED):
        ratio = conclusion.result.ratio_to(there[label]) if label in there else None
        known = ratio is not None and ratio.ratio is not None
        cells.append(f"{ratio.ratio:.3f} {interval_cell(ratio.ci95)}" if ratio and known else EMPTY_CELL)
    return cells


def _values(conclusion: Conclusion, space: StudySpace, importance: Importances) -> Grid:
    columns = [one for one in conclusion.everyone if one.candidate.values]
    rows = []
    for k, name in enumerate(space.names):
        share = f"{importance[name]:.0%}" if name in importance else EMPTY_CELL
        rows.append((name, share, *(_text(one.candidate.values[k]) for one in columns)))
    return Grid("values", ("of", "importance", *(one.label for one in columns)), rows)


def _text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
