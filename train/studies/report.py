"""The report of a study: tables, `summary.json`, and the trials as a table for other programs."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from train.analysis.spread import too_few
from train.analysis.statistics import share_cell
from train.reports.text_table import EMPTY_CELL, Grid, flat, interval_cell
from train.studies.conclusion import TO_BEAT, UNCHANGED, Conclusion, Stated
from train.studies.missions import FIGURES
from train.studies.search import Arm
from train.studies.space import StudySpace

Importances = Mapping[str, float]


def study_tables(conclusion: Conclusion, space: StudySpace, importance: Importances) -> list[Grid]:
    """Return the tables: what the results cost beside what they must beat, and their values."""
    return [_costs(conclusion), _comparison(conclusion), _values(conclusion, space, importance)]


def study_summary_json(conclusion: Conclusion, space: StudySpace, arms: Sequence[Arm], importance: Importances) -> str:
    """Return the content of `summary.json`."""
    content: dict[str, Any] = {
        "results": [
            {
                **_stated(result, space),
                "ratios": {one.label: result.ratio_to(one).content for one in conclusion.yardsticks},
                "not_shown_to_beat": conclusion.marks(result),
            }
            for result in conclusion.results
        ],
        "yardsticks": [_stated(one, space) for one in conclusion.yardsticks],
        "importance": dict(importance),
        "missions": {arm.method: sum(trial.scenarios for trial in arm.trials) for arm in arms},
    }
    return json.dumps(content, indent=2) + "\n"


def trials_csv(arms: Sequence[Arm], space: StudySpace) -> str:
    """Return all trials as CSV: name, values, number of scenarios when the method was told, estimated means."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("trial", *space.names, "scenarios", *FIGURES))
    for trial in (trial for arm in arms for trial in arm.trials):
        writer.writerow((trial.candidate.name, *trial.candidate.values, trial.scenarios, *trial.means))
    return text.getvalue()


def _stated(stated: Stated, space: StudySpace) -> dict[str, Any]:
    figures = {name: asdict(summary) for name, summary in stated.summaries.items()}
    values = dict(zip(space.names, stated.candidate.values, strict=False))
    return {"name": stated.label, "trial": stated.candidate.name, "values": values, "figures": figures}


def _costs(conclusion: Conclusion) -> Grid:
    rows = []
    for stated in (*conclusion.results, *conclusion.yardsticks):
        cost, duration, events, avoiding, left = (stated.summaries[name] for name in FIGURES)
        figures = (f"{cost.mean:.1f}", interval_cell(cost.ci95, 1), f"{duration.mean:.1f}", f"{events.mean:.1f}")
        rows.append((stated.label, share_cell(left.mean), *figures, f"{avoiding.mean:.3f}"))
    count = conclusion.results[0].figures.shape[1]
    heads = ("unfinished", "cost s", "95 %", "duration s", "events", "avoiding")
    return flat(f"means over {count} training scenarios that decided nothing", "options", heads, rows)


def _comparison(conclusion: Conclusion) -> Grid:
    rows = [
        (stated.label, *_ratios(stated, conclusion), ", ".join(conclusion.marks(stated)) or EMPTY_CELL)
        for stated in conclusion.results
    ]
    heads = (*TO_BEAT, UNCHANGED, "not shown to beat")
    grid = flat("ratios of mean costs, with 95 % intervals", "result to", heads, rows)
    ratios = [one.ratio_to(other) for one in conclusion.results for other in conclusion.yardsticks if one is not other]
    return replace(grid, notes=too_few(ratios))


def _ratios(stated: Stated, conclusion: Conclusion) -> list[str]:
    there = {one.label: one for one in conclusion.yardsticks}
    cells = []
    for label in (*TO_BEAT, UNCHANGED):
        ratio = stated.ratio_to(there[label]) if label in there and label != stated.label else None
        known = ratio is not None and ratio.ratio is not None
        cells.append(f"{ratio.ratio:.3f} {interval_cell(ratio.ci95)}" if ratio and known else EMPTY_CELL)
    return cells


def _values(conclusion: Conclusion, space: StudySpace, importance: Importances) -> Grid:
    columns = [one for one in (*conclusion.results, *conclusion.yardsticks) if one.candidate.values]
    rows = []
    for k, name in enumerate(space.names):
        share = f"{importance[name]:.0%}" if name in importance else EMPTY_CELL
        rows.append((name, share, *(_text(one.candidate.values[k]) for one in columns)))
    return flat("values", "of", ("importance", *(one.label for one in columns)), rows)


def _text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
