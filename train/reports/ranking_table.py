"""The tables of every comparison: strategies from the lowest mean on, with points and intervals; measures of a task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from train.analysis.intervals import Interval
from train.analysis.runs import Report
from train.analysis.statistics import Summary, share_cell
from train.analysis.task_report import MeasuredStrategy
from train.analysis.verdict import LOG_FROM, Ranking, amount, interval_words, listed, most_left, ratio_words
from train.reports.text_table import EMPTY_CELL, POINT, Grid

VERDICTS = {True: "yes", False: "no", None: EMPTY_CELL}
LETTERS = 20
"""Width of a drawn cell."""
AT_MOST = " (at most)"
"""End of the head of the column of missions that were not completed: the share, and the upper 95 % bound of it."""
TELLS = "p: sign flips of missions that both finish, and of shares unfinished, by Holm over the table; told below 0.05"
"""How strategies are told apart, in a line."""


def ranking_table(
    title: str,
    ranking: Ranking,
    what: str,
    columns: Mapping[str, Mapping[str, str]],
    notes: Sequence[str] = (),
    *,
    to: str = "",
) -> Grid:
    """Return the table of a ranking.

    Args:
        title: its title.
        ranking: what is compared.
        what: head of the column of means, with the unit.
        columns: head of a further column -> label -> cell.
        notes: lines below the table.
        to: label with which each other one is compared alone; the first, with intervals for all pairs, unless given.

    """
    best, compared = to or ranking.labels[0], to or "the first"
    known = [end for mean in ranking.means.values() for end in (mean.value, *(mean.ci95 or ()))]
    least, most = min(mean.value for mean in ranking.means.values()), max(known)
    logarithmic = least > 0.0 and most > LOG_FROM * least
    low = min((end for end in known if end > 0.0), default=0.0) if logarithmic else min(0.0, *known)
    rows = []
    for label, mean in ranking.means.items():
        ratio = ranking.ratio(label, best)
        ends = None if label == best else ratio.ci95 if to else ranking.interval(label, best)
        again = EMPTY_CELL if ratio.ratio is None else f"{ratio_words(ratio.ratio)}{interval_words(ends, ratio_words)}"
        drawn = strip(mean.value, mean.ci95, (low, most), logarithmic)
        p = EMPTY_CELL if label == best else p_cell(ranking.ps[frozenset((label, best))])
        cells = (f"{amount(mean.value)}{interval_words(mean.ci95, amount)}", drawn, again, p)
        rows.append((label, *cells, *(column.get(label, "") for column in columns.values())))
    scale = f"{amount(low)} to {amount(most)}{', logarithmic' * logarithmic}"
    heads = ("strategy", f"{what} [95 %]", scale, f"times {compared} [95 %]", "p (Holm)", *columns)
    together = "the 95 % hold for all pairs of the table together, so another row makes all of them wider"
    lines = [f"times {compared}: ratio of means; {'the 95 % are of each ratio alone' if to else together}", TELLS]
    lines = [] if ranking.scenarios == 1 or len(rows) == 1 else lines
    if ranking.heavy:
        names = listed([ranking.name(label) for label in ranking.heavy])
        lines += [
            f"heavy tails: some scenarios of {names} cost far more than the others; these intervals are too narrow"
        ]
    return Grid(title, heads, rows, notes=(*lines, *notes))


def p_cell(p: float | None) -> str:
    """Return a p-value; a dash where there is none."""
    return EMPTY_CELL if p is None else f"{p:.2g}"


def first_columns(report: Report) -> dict[str, dict[str, str]]:
    """Return head -> label -> cell: the shares of unfinished missions, and the means of the measures of a task."""
    shares = {
        name: f"{share_cell(float(own.mean()))} ({most_left(own):.0%})" for name, own in report.runs.unfinished.items()
    }
    columns = {report.runs.task.missed[0] + AT_MOST: shares}
    for one in report.measured:
        columns.setdefault(one.measure.name, {})[one.strategy] = f"{one.own.mean:.3g}"
    return columns


def measures_grids(name: str, measured: Sequence[MeasuredStrategy]) -> list[Grid]:
    """Return a table for each measure of the task of an evaluation, with a row for each strategy."""
    grids = []
    for measure in dict.fromkeys(one.measure for one in measured):
        unit = "" if measure.unit == "-" else f" [{measure.unit}]"
        target = f"{'≤' if measure.better == 'lower' else '≥'} {measure.target:g}"
        rows = [
            (one.strategy, _mean(one.own), _mean(one.difference), VERDICTS[one.met], VERDICTS[one.beats])
            for one in measured
            if one.measure == measure
        ]
        heads = ("strategy", "mean", "difference", "target met", "beats baseline")
        grids.append(Grid(f"{name}: {measure.name}{unit}, target {target}: {measure.reason}", heads, rows))
    return grids


def _mean(summary: Summary | None) -> str:
    """Return a mean with its interval."""
    return EMPTY_CELL if summary is None else f"{summary.mean:.3g}{interval_words(summary.ci95, '{:.3g}'.format)}"


def strip(value: float, ends: Interval | None, axis: Interval, logarithmic: bool) -> str:
    """Return a point and its interval on an axis, in letters.

    >>> strip(5.0, (2.5, 7.5), (0.0, 10.0), False)
    '·····├────●───┤·····'

    """
    low, high = axis
    spread = np.array([value, *(ends or (value, value))]).clip(low, high)
    if logarithmic:
        spread, low, high = np.log(spread), np.log(low), np.log(high)
    shares = (spread - low) / (high - low) if high > low else np.zeros(3)
    point, first, last = (int(place) for place in (shares * (LETTERS - 1)).round())
    letters = ["·"] * LETTERS
    letters[first : last + 1] = ["├", *"─" * (last - first - 1), "┤"][: last - first + 1]
    letters[point] = POINT
    return "".join(letters)
