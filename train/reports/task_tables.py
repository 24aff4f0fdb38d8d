"""Tables of the measures of a task: for every evaluation of it, and for the page of all tasks."""

from collections.abc import Sequence

from train.analysis.statistics import Summary
from train.analysis.task_report import MeasuredStrategy
from train.analysis.verdict import interval_words
from train.reports.text_table import EMPTY_CELL, Grid

VERDICTS = {True: "yes", False: "no", None: EMPTY_CELL}
MEASURE_HEADS = ("measure", "mean", "target", "baseline", "difference", "target met", "beats baseline")
"""Heads of the cells of a measure; intervals are 95 % intervals."""
SHOWN = ("mean", "difference", "target met", "beats baseline")
"""Those where all strategies have rows of their own."""


def measures_grids(name: str, measured: Sequence[MeasuredStrategy]) -> list[Grid]:
    """Return a table for each measure of the task of an evaluation, with a row for each strategy."""
    grids = []
    for measure in dict.fromkeys(one.measure for one in measured):
        own = [one for one in measured if one.measure == measure]
        cells = [dict(zip(MEASURE_HEADS, measure_cells(one), strict=True)) for one in own]
        title = f"{name}: {cells[0]['measure']}, target {cells[0]['target']}: {measure.reason}"
        rows = [(one.strategy, *(each[head] for head in SHOWN)) for one, each in zip(own, cells, strict=True)]
        grids.append(Grid(title, ("strategy", *SHOWN), rows))
    return grids


def measure_cells(one: MeasuredStrategy) -> tuple[str, ...]:
    """Return the cells of a measure, in the order of `MEASURE_HEADS`."""
    measure = one.measure
    unit = "" if measure.unit == "-" else f" [{measure.unit}]"
    sign = "≤" if measure.better == "lower" else "≥"
    return (
        measure.name + unit,
        _interval(one.own),
        f"{sign} {measure.target:g}",
        _interval(one.baseline),
        _interval(one.difference),
        VERDICTS[one.met],
        VERDICTS[one.beats],
    )


def _interval(summary: Summary | None) -> str:
    """Return a mean with its interval."""
    return EMPTY_CELL if summary is None else f"{summary.mean:.3g}{interval_words(summary.ci95, '{:.3g}'.format)}"
