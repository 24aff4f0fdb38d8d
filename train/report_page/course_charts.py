"""Charts over time: learning curves of a training, and which options robots of recorded runs hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from clean_swarm_env.recording.reader import RecordedMission
from selforg.arrays import Flags, Floats, Ints
from train.report_page.chart import COLOURS, Axis, Chart
from train.report_page.run_charts import LABELS, WIDTH, key

COST = "/cost_s"
SLICES: Final = 60
"""Times at which shares of options are drawn."""
CROWDED: Final = 2.0
"""Distance within which other robots count as near [m]."""
MOST_PAIRS: Final = 10_000_000
"""Pairs of robots of a recording that are looked at, over all frames; of longer ones fewer frames are."""


def learning_curves(histories: Sequence[tuple[str, Sequence[dict[str, Any]]]]) -> str:
    """Return the cost on validation scenarios over decisions, for each training and family; dots: the best so far."""
    curves: dict[str, list[tuple[float, float, bool]]] = {}
    for name, history in histories:
        for entry in history:
            for figure, value in entry.items():
                if figure.endswith(COST) and isinstance(value, int | float):
                    label = f"{name}: {figure.removesuffix(COST)}" if len(histories) > 1 else figure.removesuffix(COST)
                    at = float(entry.get("decisions", entry.get("checkpoint", 0)))
                    curves.setdefault(label, []).append((at, float(value), bool(entry.get("best"))))
    points = [point for curve in curves.values() for point in curve]
    if not points:
        return ""
    x, y = Axis.over([p[0] for p in points], zero=True), Axis.over([p[1] for p in points])
    chart = Chart(x, y, (WIDTH, 260))
    for c, (label, curve) in enumerate(curves.items()):
        chart.line([point[:2] for point in curve], f"c{c % COLOURS}", label)
        for at, value, best in curve:
            chart.dot(at, value, f"c{c % COLOURS}", f"{label}: {value:.4g} at {at:.0f}", 4.0 if best else 2.0)
    return chart.svg("decisions; cost on validation scenarios [s]") + key(list(curves))


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
    counts = counts[counts.sum(axis=1) > 0]
    tops = np.cumsum(counts / counts.sum(axis=1, keepdims=True), axis=1)
    middles = (edges[: len(counts)] + edges[1 : len(counts) + 1]) / 2.0
    chart = Chart(Axis(0.0, end or 1.0), Axis(0.0, 1.0), (WIDTH, 180))
    below = np.zeros(len(counts))
    for k, option in enumerate(options):
        upper = list(zip(middles.tolist(), tops[:, k].tolist(), strict=True))
        lower = list(zip(middles.tolist(), below.tolist(), strict=True))
        chart.area([*upper, *reversed(lower)], f"c{k % COLOURS} stacked", option)
        below = tops[:, k]
    return chart.svg("time [s]; share of robots") + key(options)


def selection_by_situation(recordings: Sequence[RecordedMission], goal: str) -> str:
    """Return the share of time that robots hold each option, by cargo and by how many others are near."""
    options = recordings[0].head["options"][goal]
    shares: dict[str, Floats] = {}
    for recording in recordings:
        step = 1 + recording.frames * recording.head["robots"] ** 2 // MOST_PAIRS
        held = recording[f"held/{goal}"][::step]
        for name, there in _situations(recording, step).items():
            counts = np.array([(held[there] == k).sum() for k in range(len(options))], dtype=np.float64)
            shares[name] = shares.get(name, np.zeros(len(options))) + counts
    shares = {name: counts / counts.sum() for name, counts in shares.items() if counts.sum()}
    chart = Chart(Axis(0.0, 1.0), Axis(-0.5, len(shares) - 0.5), (WIDTH, 26 * len(shares)), LABELS)
    for row, (name, own) in enumerate(shares.items()):
        y, begin = len(shares) - 1.0 - row, 0.0
        chart.words(0.0, y, name, "end", (-8.0, 0.0))
        for k, share in enumerate(own.tolist()):
            box = [(begin, y - 0.35), (begin + share, y - 0.35), (begin + share, y + 0.35), (begin, y + 0.35)]
            chart.area(box, f"c{k % COLOURS} stacked", f"{options[k]}: {share:.1%}")
            begin += share
    return chart.svg("share of time", rows=True) + key(options)


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
