"""The tables of an evaluation on a family: measures of the task, means, and comparison with fixed options.

Of strategies under disturbances there is a table for each strategy, with a row for each disturbance.
"""

import numpy as np

from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.deciders.named import FIXED, MACHINE, POLICY
from train.analysis.family_report import FamilyReport
from train.analysis.intervals import Estimate
from train.analysis.robustness_report import RobustnessReport
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import ORACLE, StrategyComparison
from train.analysis.verdict import RANDOM, Ranking, amount, interval_words, ratio_words
from train.reports.ranking_table import first_columns, measures_grids, ranking_table
from train.reports.text_table import EMPTY_CELL, Grid

MEANS = {"duration_s": "duration s", "events": "events", "contact_s": "contact s", "items": "items"}
"""Figure of a task with prices -> head of its column."""
MEANINGS = {
    FIXED: "all robots hold the option that follows",
    f"{FIXED}:Off": "no robot avoids others",
    POLICY: "a trained network chooses",
    MACHINE: "a state machine chooses",
    RANDOM: "any option, drawn anew at every decision",
}
"""Name or kind of a strategy -> what it does, in words."""
MULTIPLES = {
    "completed": ("completed %", 100.0),
    "duration_s": ("duration s", 1.0),
    "collision_events": ("collision events", 1.0),
}
"""Head of the column of each figure, and what its numbers are multiplied by."""
INTERVALS = "95 % intervals: Clopper and Pearson's (completed), Student's; unfinished missions last their time limit"


def family_tables(report: FamilyReport, to: str = "") -> list[Grid]:
    """Return the table of what is compared, and further ones in the order of the report.

    `to`: label with which the others are compared, in place of those that are best here; see `ranking_table`.
    """
    compared = [] if to or report.comparison is None else [_gaps(report, report.comparison)]
    measured = measures_grids(report.runs.document.name, report.measured)
    return [_ranked(report, to), *measured, *compared]


def _ranked(report: FamilyReport, to: str) -> Grid:
    runs, own, mission, task = report.runs, report.summaries, report.runs.missions[0], report.runs.task
    columns = first_columns(report)
    if not report.measured:
        told = {
            "duration_s": True,
            "events": True,
            "contact_s": mission.contact_cost > 0.0,
            "items": items_keep_coming(mission),
        }
        columns |= {MEANS[name]: {label: amount(own[label][name].mean) for label in own} for name in told if told[name]}
    excess = [f"excess: {task.excess}"] if report.compared == "excess" else []
    names = {name for label in own for name in (label, label.partition(":")[0])}
    said = "; ".join(f"{name}: {meaning}" for name, meaning in MEANINGS.items() if name in names)
    notes = (f"cost: {task.cost_words(mission)}", *excess, *([f"{said}."] if said else []))
    title = runs.titled(given=bool(runs.document.starts))
    return ranking_table(title, report.ranking, f"{report.compared} s", columns, notes, to=to)


def _gaps(report: FamilyReport, comparison: StrategyComparison) -> Grid:
    rows = [
        (
            standing.label,
            amount(standing.excess.value),
            EMPTY_CELL if standing.ratio.ratio is None else ratio_words(standing.ratio.ratio),
            interval_words(standing.ratio.ci95, ratio_words).strip(),
        )
        for standing in comparison.standings
    ]
    title, yardstick = f"{report.compared} beside the best fixed option, {comparison.best_fixed.label}", "best fixed"
    notes = ["The best fixed option is chosen on one half of the scenarios and judged on the other, both ways round."]
    if len(report.runs.fixed) == 1:
        yardstick = comparison.best_fixed.label
        title = f"{report.compared} beside {yardstick}"
        notes = [f"{yardstick} is the only fixed option that ran, not the best of all: --strategy fixed runs them all."]
    if comparison.gap is None:
        notes.append(f"no {ORACLE}: it needs --world-seeds 2 or more")
    else:
        gap = f"{comparison.gap.value:.1f} s{interval_words(comparison.gap.ci95, '{:.1f}'.format)}"
        chose = f"gap {gap}; the {ORACLE} chose on other world seeds"
        notes.append(chose if comparison.has_gap else f"no gap: {gap} to the {ORACLE}")
    title += f", and the {ORACLE}, the best fixed option of each scenario" if comparison.has_gap else ""
    notes.append("The 95 % are of each ratio alone; those of the first table hold together, so they are wider.")
    heads = ("strategy", f"{report.compared} s", f"ratio to {yardstick}", "95 % alone")
    return Grid(title, heads, rows, notes=tuple(notes))


def robustness_tables(report: RobustnessReport, ranking: Ranking) -> list[Grid]:
    """Return the table of all strategies over all disturbances, then one for each strategy, in its order."""
    worst = {label: report.worst(label) for label in ranking.labels}
    shares = {label: {name: own[label]["completed"].value for name, own in report.estimates.items()} for label in worst}
    columns = {
        "completed": {label: share_cell(float(np.mean(list(own.values())))) for label, own in shares.items()},
        "hit hardest by": worst,
        "completed there": {label: share_cell(shares[label][name]) for label, name in worst.items()},
    }
    title = f"{report.robustness.name}: means over {len(report.estimates)} variants of {report.scenarios} scenarios"
    grids = [ranking_table(f"{title}, seed {report.seed}", ranking, "duration s", columns, (INTERVALS,))]
    heads = ("disturbance", *(f"{head} [95 %]" for head, _ in MULTIPLES.values()))
    for label in ranking.labels:
        rows = [
            (name, *(_cell(by_label[label][figure], factor) for figure, (_, factor) in MULTIPLES.items()))
            for name, by_label in report.estimates.items()
        ]
        title = f"{label}: {report.scenarios} scenarios, seed {report.seed}; {INTERVALS}"
        grids.append(Grid(title, heads, rows))
    return grids


def _cell(estimate: Estimate, factor: float) -> str:
    ends = interval_words(estimate.ci95, lambda end: f"{factor * end:.1f}")
    return f"{factor * estimate.value:.1f}{ends}"
