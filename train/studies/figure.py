"""The picture of a study: importance of parameters, durations and collision events of all trials, and the archive."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

from selforg.arrays import Floats
from train.learning.racing import front
from train.studies.conclusion import Conclusion
from train.studies.config import ArchiveConfig
from train.studies.missions import AVOIDING, COST, DURATION, EVENT_COUNT, FIGURES
from train.studies.proposals import empty_archive
from train.studies.search import Arm

COLOURS = ("#0072b2", "#999999")
"""Of the method, and of random search beside it."""
RESULT, YARDSTICK, MARKERS = "#d55e00", "#000000", "x+d"


def draw_study(
    arms: Sequence[Arm], conclusion: Conclusion, importance: Mapping[str, float], archive: ArchiveConfig
) -> bytes:
    """Return the picture as PNG."""
    figure = Figure(figsize=(14.0, 4.2), dpi=100, layout="constrained")
    bars, plane, cells = figure.subplots(1, 3, width_ratios=(0.8, 1.2, 1.2))
    _draw_importance(bars, importance)
    _draw_plane(plane, arms, conclusion)
    _draw_archive(cells, arms, archive)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", metadata={"Software": None})
    return picture.getvalue()


def _draw_importance(axes: Axes, importance: Mapping[str, float]) -> None:
    names = list(importance)
    axes.barh(names, [importance[name] for name in names], color=COLOURS[0])
    axes.invert_yaxis()
    axes.set(title="importance for the cost", xlabel="share", xlim=(0.0, 1.0))


def _draw_plane(axes: Axes, arms: Sequence[Arm], conclusion: Conclusion) -> None:
    for arm, colour in zip(arms, COLOURS, strict=False):
        means = _means(arm)
        if not len(means):
            continue
        pairs = means[:, [DURATION, EVENT_COUNT]]
        best = front(pairs)
        axes.scatter(pairs[:, 0], pairs[:, 1], s=14, color=colour, alpha=0.5, label=f"{arm.method}: trials and front")
        axes.step(pairs[best, 0], pairs[best, 1], where="post", color=colour, linewidth=1.0)
    for number, stated in enumerate((*conclusion.results, *conclusion.yardsticks)):
        own = stated in conclusion.results
        x, y = stated.figures.mean(axis=1)[[DURATION, EVENT_COUNT]]
        marker, colour = ("*", RESULT) if own else (MARKERS[number % 3], YARDSTICK)
        axes.scatter(x, y, s=60, zorder=3, label=stated.label, marker=marker, color=colour)
    axes.set(title="duration and collisions of a mission", xlabel="duration s", ylabel="collision events")
    axes.set(xscale="log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.legend(fontsize=8)


def _draw_archive(axes: Axes, arms: Sequence[Arm], config: ArchiveConfig) -> None:
    means = np.concatenate([_means(arm) for arm in arms])
    archive = empty_archive(config, 1)
    if len(means):
        archive.add(np.zeros((len(means), 1)), -means[:, COST], means[:, [EVENT_COUNT, AVOIDING]])
    grid = np.full((config.cells, config.cells), np.nan)
    elites = archive.data(["index", "objective"])
    places = archive.int_to_grid_index(elites["index"])
    grid[places[:, 1], places[:, 0]] = -elites["objective"]
    extent = (0.0, config.events, 0.0, 1.0)
    image = axes.imshow(grid, origin="lower", extent=extent, aspect="auto", cmap="viridis_r", norm="log")
    axes.figure.colorbar(image, ax=axes, label="cost s of the cheapest", format=ScalarFormatter())
    axes.set(title="archive of all trials", xlabel="collision events", ylabel="share of time avoiding")


def _means(arm: Arm) -> Floats:
    """Return the estimated means (T, F) of the trials that the library did not refuse."""
    return np.array([trial.means for trial in arm.trials if trial.means]).reshape(-1, len(FIGURES))
