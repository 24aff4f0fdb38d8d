"""The charts of a page, as SVG: of the runs of an evaluation, of a training, and of recorded runs.

Shapes: C conditions, K scenarios, O options. A figure of a run that is missing is NaN.
"""

from collections.abc import Sequence, Sized
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from clean_swarm_env.recording.reader import RecordedMission
from selforg.arrays import Flags, Floats, Ints
from train.reports.charts import colour_of, draw_rows, fit_axis, label_of, panels, svg

WIDTH: Final = 9.2
"""Width of a chart [inch]."""
SLICES: Final = 60
"""Times at which shares of options are drawn."""
CROWDED: Final = 2.0
"""Distance within which other robots count as near [m]."""
MOST_PAIRS: Final = 10_000_000
"""Pairs of robots of a recording that are looked at, over all frames; of longer ones fewer frames are."""
LEAST_WRITTEN: Final = 0.07
"""Shares from which on the number is written."""


def distributions(values: Floats, scenarios: Sequence[str], labels: Sequence[str], title: str) -> str:
    """Return a row for each condition: every run (C, K), quartiles, and the mean with its 95 % interval."""
    with panels(1, 1, (WIDTH, 0.8 + 0.42 * len(values))) as (figure, ((axes,),)):
        draw_rows(axes, values, scenarios, labels, range(len(values)))
        fit_axis(axes, values)
        axes.set_xlabel(title)
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
    with panels(1, 1, (WIDTH, _height(2.6, used))) as (figure, ((axes,),)):
        if used:
            axes.stackplot(middles, shares[:, used].T, colors=[colour_of(k) for k in used])
        axes.set(xlim=(0.0, end or 1.0), ylim=(0.0, 1.0), xlabel="time [s]", ylabel="share of robots")
        _add_key(axes, [options[k] for k in used])
        return svg(figure)


def selection_by_situation(recordings: Sequence[RecordedMission], goal: str) -> str:
    """Return the share of time that robots hold each option, by cargo and by how many others are near."""
    options = recordings[0].head["options"][goal]
    counts: dict[str, Floats] = {}
    for recording in recordings:
        step = 1 + recording.frames * recording.head["robots"] ** 2 // MOST_PAIRS
        held = recording[f"held/{goal}"][::step]
        for name, there in _situations(recording, step).items():
            own = [np.count_nonzero(held[there] == k) for k in range(len(options))]
            counts[name] = counts.get(name, np.zeros(len(options))) + own
    shares = {name: own / own.sum() for name, own in counts.items() if own.any()}
    used = np.flatnonzero(sum(shares.values(), np.zeros(len(options)))).tolist()
    with panels(1, 1, (WIDTH, _height(0.8 + 0.3 * len(shares), used))) as (figure, ((axes,),)):
        begins = np.zeros(len(shares))
        for k in used:
            widths = np.array([own[k] for own in shares.values()])
            bars = axes.barh(list(shares), widths, left=begins, color=colour_of(k))
            written = [f"{width:.0%}" if width >= LEAST_WRITTEN else "" for width in widths]
            axes.bar_label(bars, written, label_type="center", fontsize=7, color="black")
            begins += widths
        axes.set(xlim=(0.0, 1.0), ylim=(len(shares) - 0.5, -0.5), xlabel="share of time")
        _add_key(axes, [options[k] for k in used])
        return svg(figure)


def _height(least: float, names: Sized) -> float:
    """Return the height [inch] of a chart that has the key of these names."""
    return max(least, 0.3 + 0.17 * len(names))


def _add_key(axes: Axes, names: Sequence[str]) -> None:
    """Write the names beside their colours, at the right of a chart."""
    artists = axes.collections or [bars[0] for bars in axes.containers]
    axes.figure.legend(artists, [label_of(name) for name in names], loc="outside right upper", frameon=False)


def _situations(recording: RecordedMission, step: int) -> dict[str, Flags]:
    """Return when robots (T, N) are in each situation, in every `step`-th frame."""
    cargo, recycled, working = (recording[name][::step] for name in ("cargo", "recycled", "working"))
    recycled, working, near = recycled == 1, working == 1, _near(recording, step)
    return {
        "searching": working & (cargo < 0),
        "with an item": working & (cargo >= 0) & ~recycled,
        "with leftovers": working & (cargo >= 0) & recycled,
        f"nobody within {CROWDED:g} m": working & (near == 0),
        f"1 or 2 within {CROWDED:g} m": working & ((near == 1) | (near == 2)),
        f"3 and more within {CROWDED:g} m": working & (near >= 3),
    }


def _near(recording: RecordedMission, step: int) -> Ints:
    """Return how many others are near each robot (T, N), in every `step`-th frame."""
    x, y, there = recording["x"][::step], recording["y"][::step], recording["present"][::step] == 1
    width, height = recording.head["width"], recording.head["height"]
    near = np.zeros(x.shape, dtype=np.int64)
    for robot in range(x.shape[1]):
        dx, dy = x - x[:, [robot]], y - y[:, [robot]]
        dx, dy = dx - width * np.round(dx / width), dy - height * np.round(dy / height)
        near += (np.hypot(dx, dy) < CROWDED) & there[:, [robot]]
    others: Ints = near - there
    return others
