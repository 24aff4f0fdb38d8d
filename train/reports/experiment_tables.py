"""The tables of an evaluation: the paper's Table 1, ratios between conditions, and comparisons with measurements.

`train.reports.text_table` writes them into `table.md`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats
from train.analysis.flips import fewest
from train.analysis.intervals import Interval, corrected_ps
from train.analysis.report import Report, agreements, ranking_of_conditions
from train.analysis.statistics import COST, distance_metrics, share_cell, summarise
from train.reports.ranking_table import AT_MOST, TELLS, p_cell, ranking_table, share_bounds
from train.reports.task_tables import VERDICTS, measures_grids
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


@dataclass(frozen=True)
class _Column:
    """Figures of one column: by scenario, and all values for the summary."""

    by_scenario: Mapping[str, float]
    values: Floats


def all_tables(report: Report) -> list[Grid]:
    """Return the table of the conditions, then further ones."""
    of_task = measures_grids(report.experiment.name, report.measured_by_task)
    tables = (*of_task, table_1(report), ratios(report), beside_theirs(report))
    return [conditions_table(report), *(grid for grid in tables if grid.rows)]


def conditions_table(report: Report) -> Grid:
    """Return the conditions, the fastest or cheapest first."""
    own, columns = report.figures, {report.task.missed[0] + AT_MOST: share_bounds(report.left)}
    for one in report.measured_by_task:
        columns.setdefault(one.measure.name, {})[one.strategy] = f"{one.own.mean:.3g}"
    for metric, head in SHOWN.items() if not report.measured_by_task else ():
        if metric != "duration_s":
            columns[head] = {name: _number(found[metric].mean) for name, found in report.summaries.items()}
        beside = {name: _beside(report, name) for name in own.conditions}
        if any(beside.values()):
            k, source = list(SHOWN).index(metric), "measured" if report.means else "paper"
            theirs = {name: found[k].values for name, found in beside.items() if found and found[k].values.size}
            cells = {name: _number(float(values.mean())) for name, values in theirs.items()}
            columns[f"{source} {head.removeprefix('time ')}"] = cells
    title = f"{report.experiment.name}: {len(own.scenarios)} scenarios, seed {report.seed}"
    what = "cost s" if report.measured_by_task else SHOWN["duration_s"]
    return ranking_table(title, ranking_of_conditions(report), what, columns, _notes(report))


def beside_theirs(report: Report) -> Grid:
    """Return our figures beside those that were measured, or published with the experiment; no rows without."""
    rows = [(one.what, _number(one.ours), _number(one.theirs), VERDICTS[one.agrees]) for one in agreements(report)]
    source = "measured" if report.means else "the paper"
    note = "agree: 1 is in the 95 % interval of the ratio of means on the same starts; the intervals of ratios meet"
    if not report.means:
        note = "agree: the 95 % intervals meet; start configurations of the paper are not known"
    return Grid(f"ours beside {source}", ("figure", "ours", source.split()[-1], "agree"), rows, notes=(note,))


def table_1(report: Report) -> Grid:
    """Return duration and collision samples of every scenario under every condition, and their summaries."""
    names, source = report.figures.conditions, "measured" if report.means else "paper"
    shown = {COST: "cost s"} if report.measured_by_task else SHOWN
    ours = [[_ours(report, c, metric) for metric in shown] for c in range(len(names))]
    theirs = [_beside(report, name) for name in names]
    groups = [mine + others for mine, others in zip(ours, theirs, strict=True)]
    heads = ["scenario"]
    for name, beside in zip(names, theirs, strict=True):
        heads += [
            f"{name}\n{head}" for head in (*shown.values(), *((f"{source} s", f"{source} coll/s") if beside else ()))
        ]
    columns = [column for group in groups for column in group]
    scenarios = report.figures.scenarios
    rows = [(scenario, *(_two(column.by_scenario.get(scenario)) for column in columns)) for scenario in scenarios]
    found = [summarise(column.values) if column.values.size else None for column in columns]
    summary = [(what, *(_two(getattr(one, what, None)) for one in found)) for what in SUMMARIES]
    done = ["targets met" if report.measured_by_task else "completed"]
    for completed, group in zip(report.figures.completed, groups, strict=True):
        done += [f"{completed.sum()}/{completed.size}", *[""] * (len(group) - 1)]
    title = f"{report.experiment.name}, seed {report.seed}"
    return Grid(title, tuple(heads), rows, (*summary, done), (*_notes(report), POPULATION))


def ratios(report: Report) -> Grid:
    """Return the ratios of means between the conditions with their intervals, and the paper's."""
    paper, own = report.experiment.reference, report.figures
    unfinished = dict(zip(own.conditions, (1.0 - own.completed.mean(axis=1)).tolist(), strict=True))
    rows = []
    corrected = corrected_ps(list(report.comparisons.values()))
    for ((*pair, metric), found), p in zip(report.comparisons.items(), corrected, strict=True):
        shares = " / ".join(share_cell(unfinished[name]) for name in pair)
        row = [TITLES[metric], " / ".join(pair), shares, _number(found.ratio), _interval(found.ci95), p_cell(p)]
        if paper:
            a, b = (paper.figures.get(name, {}).get(metric, ()) for name in pair)
            row.append(f"{np.mean(a) / np.mean(b):.2f}" if a and b else EMPTY_CELL)
        rows.append(row)
    heads = ("figure", "conditions", "unfinished", "ratio", "95 % interval", "p (Holm)") + (("paper",) if paper else ())
    need = fewest(len(rows))
    few = f"; {need} scenarios may tell something" if len(own.scenarios) < need else ""
    return Grid("ratios of means", heads, rows, notes=(f"{TELLS}{few}",))


def _ours(report: Report, condition: int, metric: str) -> _Column:
    values = report.figures.values[metric][condition]
    return _Column(dict(zip(report.figures.scenarios, values.tolist(), strict=True)), values)


def _beside(report: Report, condition: str) -> list[_Column]:
    """Return the columns of measured figures of a condition, else of published ones; empty without either."""
    if report.means:
        return [_measured(report, condition, metric) for metric in SHOWN]
    paper = report.experiment.reference
    if paper is None or condition not in paper.figures:
        return []
    columns = [np.array(paper.figures[condition].get(metric, ())) for metric in SHOWN]
    scenarios = report.figures.scenarios if report.own_starts else ()
    return [_Column(dict(zip(scenarios, values.tolist(), strict=False)), values) for values in columns]


def _measured(report: Report, condition: str, metric: str) -> _Column:
    key = {c.name: c.measured for c in report.experiment.conditions}[condition] or ""
    samples = distance_metrics(report.experiment.mission.collision_distances)[0]
    name = samples if metric == "collision_samples_per_s" else metric
    found = {s: report.measured.get(s, {}).get(key, {}).get(name) for s in report.figures.scenarios}
    exist = {scenario: value for scenario, value in found.items() if value is not None}
    return _Column(exist, np.array(list(exist.values())))


def _notes(report: Report) -> tuple[str, ...]:
    mission = report.experiment.mission
    if report.measured_by_task:
        return (f"cost: {report.task.cost_words(mission)}.",)
    notes = [
        f"coll/s: pairs closer than {mission.collision_distances[0]:g} m, counted {mission.world.physics_rate:g} times"
        " per second."
    ]
    if not report.figures.completed.all():
        notes.append(f"Missions that were not completed count with the time limit, {mission.time_limit:g} s.")
    if report.experiment.reference and not report.means:
        notes.append(f"paper: {report.experiment.reference.source}; its start configurations are not known.")
    return tuple(notes)


def _two(value: float | None) -> str:
    return EMPTY_CELL if value is None else f"{value:.2f}"


def _number(value: float | None) -> str:
    """Return three significant digits, and all digits before the point."""
    if value is None:
        return EMPTY_CELL
    return f"{value:.1f}" if abs(value) >= 100.0 else f"{value:#.3g}"


def _interval(interval: Interval | None) -> str:
    return EMPTY_CELL if interval is None else f"[{_number(interval[0])}, {_number(interval[1])}]"
