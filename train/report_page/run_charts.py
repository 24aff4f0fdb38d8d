"""Charts of an evaluation: distributions, paired differences, performance profiles, and the map of scenarios.

Shapes: C conditions, K scenarios. A figure of a run that is missing is NaN.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import Final

import numpy as np

from selforg.arrays import Floats
from train.analysis.statistics import share_cell, summarise
from train.report_page.chart import COLOURS, ROW, Axis, Chart
from train.running.runs import RunRecord

FIGURES: Final[Mapping[str, Callable[[RunRecord], float]]] = {
    "cost [s]": lambda record: record.result.cost_s,
    "duration [s]": lambda record: record.result.duration_s,
    "collision events [1/s]": lambda record: record.result.collision_events_per_s[0],
}
WIDTH, LABELS = 620, 250
"""Width of a chart of rows and of its labels [pixels]."""
SPREAD = 0.28
"""Half the height of the points of a row, in rows."""
FURTHER_WORLD: Final = re.compile(r"^(test-\d+)\.\d+$")
"""The name of a scenario in a further world."""
FARTHEST_RATIO = 1000.0
"""Ratios of costs beyond this one are drawn there."""


def table_of(records: Sequence[RunRecord], conditions: Sequence[str], scenarios: Sequence[str], figure: str) -> Floats:
    """Return a figure of all runs (C, K)."""
    at = {record.key: FIGURES[figure](record) for record in records}
    return np.array([[at.get((scenario, name), np.nan) for scenario in scenarios] for name in conditions])


def with_unfinished(records: Sequence[RunRecord], conditions: Sequence[str]) -> list[str]:
    """Return the conditions with their shares of unfinished missions; without them if nobody finished any."""
    done = {name: [record.result.completed for record in records if record.condition == name] for name in conditions}
    if not any(map(any, done.values())):
        return list(conditions)
    return [f"{name}, {share_cell(1.0 - sum(own) / len(own))} unfinished" for name, own in done.items()]


def distributions(values: Floats, conditions: Sequence[str], scenarios: Sequence[str], title: str) -> str:
    """Return a row for each condition: every run, quartiles, and the mean with its 95 % interval."""
    return _by_condition(values, range(len(conditions)), conditions, scenarios).svg(title, rows=True)


def differences(values: Floats, conditions: Sequence[str], scenarios: Sequence[str], title: str) -> str:
    """Return a row for each condition: its differences to the condition of the lowest mean, on the same scenarios."""
    best = int(np.nanargmin(np.nanmean(values, axis=1)))
    apart = values - values[best]
    others = [c for c in range(len(conditions)) if c != best and np.isfinite(apart[c]).any()]
    if not others:
        return ""
    chart = _by_condition(apart, others, conditions, scenarios, paired=True)
    return chart.svg(f"{title}, minus that of {conditions[best]} on the same scenario", rows=True)


def _by_condition(
    values: Floats, shown: Sequence[int], conditions: Sequence[str], scenarios: Sequence[str], *, paired: bool = False
) -> Chart:
    """Return a row for each condition that is `shown`; `paired` values are differences, beside a line at 0."""
    known = values[shown][np.isfinite(values[shown])].tolist()
    x = Axis.over([0.0, *known], zero=True) if paired else Axis.over(known)
    chart = Chart(x, Axis(-0.5, len(shown) - 0.5), (WIDTH, ROW * len(shown)), LABELS)
    if paired:
        chart.line([(0.0, -0.5), (0.0, len(shown) - 0.5)], "axis")
    for row, c in enumerate(shown):
        y, own = len(shown) - 1.0 - row, values[c]
        chart.words(x.low, y, conditions[c], "end", (-8.0, 0.0))
        for k in np.flatnonzero(np.isfinite(own)).tolist():
            told = f"{scenarios[k]}: {own[k]:{'+' if paired else ''}.4g}"
            chart.dot(own[k], y + _offset(k), f"c{c % COLOURS} faint", told, 2.5)
        _mean(chart, own, scenarios, (y, c))
    return chart


def profile(values: Floats, conditions: Sequence[str]) -> str:
    """Return for each condition the share of scenarios whose cost is at most a factor of the lowest one there."""
    ratios = np.clip(values / np.nanmin(values, axis=0), 1.0, FARTHEST_RATIO)
    known = ratios[np.isfinite(ratios)]
    highest = max(float(known.max()), 2.0)
    chart = Chart(Axis(1.0, highest * 1.05, log=True), Axis(0.0, 1.0), (WIDTH, 240))
    for c, name in enumerate(conditions):
        own = np.sort(ratios[c][np.isfinite(ratios[c])])
        points, share = [(1.0, 0.0)], 0.0
        for k, ratio in enumerate(own.tolist(), start=1):
            points += [(ratio, share), (ratio, k / len(values[c]))]
            share = k / len(values[c])
        chart.line([*points, (highest * 1.05, share)], f"c{c % COLOURS}", name)
    return chart.svg("cost as a factor of the lowest on that scenario") + key(conditions)


def scenario_map(values: Floats, conditions: Sequence[str], scenarios: Sequence[str], links: Mapping[str, str]) -> str:
    """Return a table of all runs, the darker the further above the best of the scenario; `links`: run -> page."""
    heads = "".join(f"<th><span>{escape(name)}</span></th>" for name in conditions)
    rows = [f"<tr><th></th>{heads}</tr>"]
    lowest = np.nanmin(values, axis=0)
    for k, scenario in enumerate(scenarios):
        cells = [f"<th>{escape(scenario)}</th>"]
        for c, name in enumerate(conditions):
            value = values[c, k]
            if not np.isfinite(value):
                cells.append("<td>-</td>")
                continue
            excess = min(np.log(max(value / max(lowest[k], 1e-9), 1.0)) / np.log(10.0), 1.0)
            link = links.get(f"{scenario}-{name}")
            text = f"{value:.4g}" if link is None else f'<a href="{escape(link, quote=True)}">{value:.4g}</a>'
            cells.append(f'<td style="--excess:{100 * excess:.0f}%">{text}</td>')
        rows.append(f"<tr>{''.join(cells)}</tr>")
    return f'<div class="wide"><table class="map">{"".join(rows)}</table></div>'


def key(names: Sequence[str]) -> str:
    """Return the names of colours."""
    parts = (f'<span><i class="c{c % COLOURS}"></i>{escape(name)}</span>' for c, name in enumerate(names))
    return f'<p class="key">{"".join(parts)}</p>'


def _offset(k: int) -> float:
    """Return how far the point of scenario k is above the middle of its row, so that neighbours can be told apart."""
    return SPREAD * float(np.cos(k * np.pi * (3.0 - np.sqrt(5.0))))


def by_scenario(values: Floats, scenarios: Sequence[str]) -> Floats:
    """Return the means of known `values` (K,) over the worlds of each scenario."""
    found: dict[str, list[float]] = {}
    for name, value in zip(scenarios, values.tolist(), strict=True):
        if np.isfinite(value):
            found.setdefault(FURTHER_WORLD.sub(r"\1", name), []).append(value)
    return np.array([np.mean(own) for own in found.values()])


def _mean(chart: Chart, values: Floats, scenarios: Sequence[str], row: tuple[float, int]) -> None:
    """Draw the mean and its interval at the height and in the colour of a row."""
    own, (y, c) = values[np.isfinite(values)], row
    if not len(own):
        return
    found, look = summarise(by_scenario(values, scenarios)), f"c{c % COLOURS}"
    low, high = found.ci95 or (found.mean, found.mean)
    first, third = np.quantile(own, [0.25, 0.75]).tolist()
    box = [(first, y - 0.18), (third, y - 0.18), (third, y + 0.18), (first, y + 0.18)]
    chart.area(box, f"{look} box", f"quartiles {first:.4g} to {third:.4g}, median {np.median(own):.4g}")
    told = f"mean {found.mean:.4g}" + (f", 95 % interval {low:.4g} to {high:.4g}" if found.ci95 else "")
    chart.line([(low, y), (high, y)], f"{look} interval", told)
    chart.dot(found.mean, y, f"{look} mean", told, 5.0)
