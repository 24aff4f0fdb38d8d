"""The tables of an evaluation: the paper's Table 1, ratios between conditions, and comparisons with measurements.

`train.reports.text_table` writes them into `table.md`.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from train.analysis.flips import fewest
from train.analysis.intervals import corrected_ps
from train.analysis.report import ExperimentReport
from train.analysis.runs import COST, distance_metrics
from train.analysis.statistics import share_cell, summarise
from train.analysis.verdict import interval_words, ratio_words
from train.reports.ranking_table import VERDICTS, first_columns, measures_grids, p_cell, ranking_table
from train.reports.text_table import EMPTY_CELL, Grid

TITLES = {
    "duration_s": "duration",
    "collision_samples_per_s": "collision samples per s",
    "collision_events_per_s": "collision events per s",
    COST: "cost",
}
SHOWN = {"duration_s": "time s", "collision_samples_per_s": "coll/s"}
"""Metric of Table 1 -> head of its column."""
POPULATION = "std: of the population."
SUMMARIES = ("mean", "median", "std")


Column = Mapping[str, float]
"""Scenario, or what stands for one whose start is not known -> figure."""


def all_tables(report: ExperimentReport) -> list[Grid]:
    """Return the table of the conditions, then further ones."""
    of_task = measures_grids(report.experiment.name, report.measured)
    tables = (*of_task, table_1(report), ratios(report), beside_theirs(report))
    return [conditions_table(report), *(grid for grid in tables if grid.rows)]


def conditions_table(report: ExperimentReport) -> Grid:
    """Return the conditions, the fastest or cheapest first; figures of others stand before ratios."""
    columns = dict[str, Mapping[str, str]]()
    beside = {name: _beside(report, name) for name in report.conditions}
    source = "measured" if report.paired else "paper"
    for k, (metric, head) in enumerate(SHOWN.items() if not report.measured else ()):
        if metric != "duration_s":
            columns[head] = {name: _number(found[metric].mean) for name, found in report.summaries.items()}
        if any(beside.values()):
            theirs = {name: list(found[k].values()) for name, found in beside.items() if found and found[k]}
            cells = {name: _number(float(np.mean(values))) for name, values in theirs.items()}
            columns[f"{source} {head.removeprefix('time ')}"] = cells
    what = "cost s" if report.measured else SHOWN["duration_s"]
    title = report.runs.titled(given=report.own_starts or report.paired)
    grid = ranking_table(title, report.ranking, what, columns | first_columns(report), _notes(report))
    if not any(beside.values()):
        return grid
    order = [0, 1, 2, *range(5, len(grid.heads)), 3, 4]
    heads, *rows = ([cells[k] for k in order] for cells in (grid.heads, *grid.rows))
    return replace(grid, heads=tuple(heads), rows=rows)


def beside_theirs(report: ExperimentReport) -> Grid:
    """Return our figures beside those that were measured, or published with the experiment; no rows without."""
    rows = [(one.what, _number(one.ours), _number(one.theirs), VERDICTS[one.agrees]) for one in report.agreements]
    source = "measured" if report.paired else "the paper"
    note = "agree: the 95 % intervals meet"
    if report.paired:
        note = "agree: 1 is in the 95 % interval of the ratio of means on the same starts; the intervals of ratios meet"
    return Grid(f"ours beside {source}", ("figure", "ours", source.split()[-1], "agree"), rows, notes=(note,))


def table_1(report: ExperimentReport) -> Grid:
    """Return duration and collision samples of every scenario under every condition, and their summaries."""
    source, shown = "measured" if report.paired else "paper", {COST: "cost s"} if report.measured else SHOWN
    heads, columns, done = ["scenario"], list[Column](), ["targets met" if report.measured else "completed"]
    for name, completed in report.runs.values("completed").items():
        theirs = _beside(report, name)
        group = (*shown.values(), *((f"{source} s", f"{source} coll/s") if theirs else ()))
        heads += [f"{name}\n{head}" for head in group]
        columns += [*(report.ours(name, metric) for metric in shown), *theirs]
        done += [f"{completed.sum():.0f}/{completed.size}", *[""] * (len(group) - 1)]
    rows = [(scenario, *(_number(column.get(scenario)) for column in columns)) for scenario in report.scenarios]
    found = [summarise(np.array(list(column.values()))) if column else None for column in columns]
    summary = [(what, *(_number(getattr(one, what, None)) for one in found)) for what in SUMMARIES]
    title = f"{report.experiment.name}, seed {report.runs.seed}"
    return Grid(title, tuple(heads), rows, (*summary, done), (POPULATION,))


def ratios(report: ExperimentReport) -> Grid:
    """Return the ratios of means between the conditions with their intervals, and the paper's."""
    paper, done = report.experiment.reference, report.runs.values("completed")
    rows = []
    corrected = corrected_ps(list(report.comparisons.values()))
    for ((*pair, metric), found), p in zip(report.comparisons.items(), corrected, strict=True):
        shares = " / ".join(share_cell(1.0 - float(done[name].mean())) for name in pair)
        ratio = EMPTY_CELL if found.ratio is None else ratio_words(found.ratio)
        row = [TITLES[metric], " / ".join(pair), shares, ratio]
        row += [interval_words(found.ci95, ratio_words).strip() or EMPTY_CELL, p_cell(p)]
        if paper:
            a, b = (paper.figures.get(name, {}).get(metric, ()) for name in pair)
            row.append(f"{np.mean(a) / np.mean(b):.2f}" if a and b else EMPTY_CELL)
        rows.append(row)
    heads = ("figure", "conditions", "unfinished", "ratio", "95 % interval", "p (Holm)") + (("paper",) if paper else ())
    need = fewest(len(rows))
    few = (f"p: {need} scenarios may tell something",) if len(report.scenarios) < need else ()
    return Grid("ratios of means", heads, rows, notes=few)


def _beside(report: ExperimentReport, condition: str) -> list[Column]:
    """Return the columns of figures beside ours; empty without any."""
    shown = ("duration_s", distance_metrics(report.experiment.mission.counted_distances)[0])
    found: list[Column] = [report.beside(condition, metric) for metric in (shown if report.paired else SHOWN)]
    return found if report.paired or any(found) else []


def _notes(report: ExperimentReport) -> tuple[str, ...]:
    mission = report.experiment.mission
    if report.measured:
        return (f"cost: {report.runs.task.cost_words(mission)}.",)
    notes = [
        f"coll/s: pairs closer than {mission.counted_distances[0]:g} m, counted {mission.world.physics_rate:g} times"
        " per second."
    ]
    if not all(done.all() for done in report.runs.values("completed").values()):
        notes.append(f"Missions that were not completed count with the time limit, {mission.time_limit:g} s.")
    if report.experiment.reference and not report.paired:
        notes.append(f"paper: {report.experiment.reference.source}; its start configurations are not known.")
    return tuple(notes)


def _number(value: float | None) -> str:
    """Return three significant digits, and all digits before the point."""
    return EMPTY_CELL if value is None else f"{value:.1f}" if abs(value) >= 100.0 else f"{value:#.3g}"
