"""The charts of a page, as SVG: of the runs of an evaluation, of a training, and of recorded runs.

Shapes: C conditions, K scenarios, O options. A figure of a run that is missing is NaN.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from clean_swarm_env.recording.reader import RecordedMission
from selforg.arrays import Floats
from train.reports.charts import colour_of, draw_rows, fit_axis, label_of, panels, svg

WIDTH: Final = 6.0
"""Width of a chart, two of which stand side by side at a desk [inch]."""
SLICES: Final = 60
"""Times at which shares of options are drawn."""


def distributions(values: Floats, scenarios: Sequence[str], labels: Sequence[str]) -> str:
    """Return a row for each condition: every run (C, K), quartiles, and the mean with its 95 % interval."""
    with panels(1, 1, (WIDTH, 0.8 + 0.42 * len(values))) as (figure, ((axes,),)):
        draw_rows(axes, values, scenarios, labels, range(len(values)))
        fit_axis(axes, values)
        return svg(figure)


def selection_over_time(recordings: Sequence[RecordedMission], goal: str) -> str:
    """Return the share of robots at work that hold each option, over time; the mean of the runs that go on."""
    options, end = recordings[0].head["options"][goal], max(float(r.times[-1]) for r in recordings)
    edges = np.linspace(0.0, end + recordings[0].period, SLICES + 1)
    counts = np.zeros((SLICES, len(options)))
    for recording in recordings:
        held, working = recording[f"held/{goal}"], recording["working"] == 1
        slices = np.clip(np.searchsorted(edges, recording.times, side="right") - 1, 0, SLICES - 1)
        for k in range(len(options)):
            np.add.at(counts[:, k], slices, ((held == k) & working).sum(axis=1))
    there, used = counts.sum(axis=1) > 0, np.flatnonzero(counts.sum(axis=0)).tolist()
    shares = counts[there] / counts[there].sum(axis=1, keepdims=True)
    middles = ((edges[:-1] + edges[1:]) / 2.0)[there]
    with panels(1, 1, (WIDTH, max(2.6, 0.3 + 0.17 * len(used)))) as (figure, ((axes,),)):
        if used:
            axes.stackplot(middles, shares[:, used].T, colors=[colour_of(k) for k in used])
        axes.set(xlim=(0.0, end or 1.0), ylim=(0.0, 1.0), xlabel="time [s]", ylabel="share of robots")
        labels = [label_of(options[k]) for k in used]
        figure.legend(axes.collections, labels, loc="outside right upper", frameon=False)
        return svg(figure)
