"""Learning curves: what the validation missions of trainings lose over decisions, beside the best fixed options.

Shapes: S trainings of one name, each with a seed of its own; T checkpoints that all of them have measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from selector.documents.writing import write_whole
from selforg.arrays import Floats
from train.analysis.statistics import summarise
from train.analysis.verdict import Ranking
from train.learning.yardstick import Validation
from train.reports.charts import TEXT_COLOUR, colour_of, fit_axis, label_of, panels, picture_of
from train.reports.results import HeldResults

EXCESS = "/excess_s"
COLUMNS, WIDTH, HEIGHT = 3, 3.6, 2.7
"""Most panels side by side, and the size of each [inch]."""
EXPLAINED = (
    "Diamonds: the best checkpoint so far. Bands: 95 % intervals of the mean of several trainings, by Student. Dashed: "
    "the fixed options that are best on the same missions."
)


def verdict_of(validation: Validation) -> list[str]:
    """Return what a training gained on its validation missions, in a few sentences."""
    families = list(validation.learned)
    pooled = {
        "the best checkpoint": np.concatenate([validation.learned[name] for name in families]),
        validation.held: np.concatenate([validation.yardstick[name] for name in families]),
    }
    ranking = Ranking.of(pooled)
    return [
        f"Validation on {ranking.scenarios} scenarios of {', '.join(families)}, beyond the time until items arrive: "
        f"{' '.join(ranking.sentences())}",
        "They chose the checkpoint: judge it on others, by `evaluate`.",
    ]


def draw_curves(trainings: Sequence[HeldResults]) -> Figure | None:
    """Return a panel for each family; None if nothing was measured."""
    measured = [key for one in trainings for entry in one.history for key in entry if key.endswith(EXCESS)]
    families = list(dict.fromkeys(key.removesuffix(EXCESS) for key in measured))
    names = dict.fromkeys(one.name for one in trainings)
    groups = {name: [one for one in trainings if one.name == name] for name in names}
    if not families:
        return None
    columns = min(COLUMNS, len(families))
    rows = -(-len(families) // columns)
    with panels(rows, columns, (max(WIDTH * columns, 2 * WIDTH), HEIGHT * rows + 0.5)) as (figure, axes):
        for place, one in enumerate(axes.flat):
            one.set_visible(place < len(families))
        for family, one in zip(families, axes.flat, strict=False):
            _draw_family(one, family, groups)
        for row in axes:
            row[0].set_ylabel("excess on validation [s]")
        key = {label: line for one in axes.flat for line, label in zip(*one.get_legend_handles_labels(), strict=True)}
        figure.legend(list(key.values()), list(key), loc="outside lower center", ncols=3, frameon=False)
        return figure


def write_curves(trainings: Sequence[HeldResults], folder: Path) -> None:
    """Write the curves of trainings into a folder, if anything was measured."""
    figure = draw_curves(trainings)
    if figure is not None:
        write_whole(folder / "curves.svg", picture_of(figure, ".svg"))


def _draw_family(axes: Axes, family: str, groups: Mapping[str, Sequence[HeldResults]]) -> None:
    """Draw the curves of all trainings on one family."""
    seen = []
    for place, (name, group) in enumerate(groups.items()):
        measured = [found for one in group if len((found := _points(one, family))[0])]
        for curve, best in measured:
            alone = {"lw": 1.5, "label": label_of(name)} if len(measured) == 1 else {"lw": 0.6, "alpha": 0.5}
            axes.plot(*curve.T, color=colour_of(place), marker="D", markersize=4, markevery=best, **alone)
            seen.append(curve[:, 1])
        if len(measured) > 1:
            shortest = min(len(curve) for curve, _ in measured)
            _draw_mean(axes, np.stack([curve[:shortest] for curve, _ in measured]), place, label_of(name))
    held = {one.validation.held: one.validation for group in groups.values() for one in group if one.validation}
    for label, validation in held.items():
        if family in validation.yardstick:
            level = float(np.mean(validation.yardstick[family]))
            axes.axhline(level, color=TEXT_COLOUR, linestyle="--", linewidth=1.0, label=f"fixed: {label_of(label)}")
            seen.append(np.array([level]))
    axes.set(title=family, xlabel="decisions")
    axes.set_xlim(left=0.0)
    axes.ticklabel_format(axis="x", style="plain")
    axes.locator_params(axis="x", nbins=4)
    fit_axis(axes, np.concatenate(seen), "y")


def _draw_mean(axes: Axes, curves: Floats, place: int, label: str) -> None:
    """Draw the mean of `curves` (S, T, 2) and its interval."""
    along = curves[:, :, 0].mean(axis=0)
    means = [summarise(values) for values in curves[:, :, 1].T]
    axes.plot(along, [one.mean for one in means], color=colour_of(place), lw=2.0, label=f"{label}, {len(curves)} seeds")
    low, high = np.array([one.ci95 or (one.mean, one.mean) for one in means]).T
    axes.fill_between(along, low, high, color=colour_of(place), alpha=0.2, linewidth=0.0)


def _points(one: HeldResults, family: str) -> tuple[Floats, list[int]]:
    """Return decisions and excess (T, 2) of the measured checkpoints, and the numbers of those best so far."""
    entries = [entry for entry in one.history if isinstance(entry.get(family + EXCESS), int | float)]
    points = [(float(entry.get("decisions", 0)), float(entry[family + EXCESS])) for entry in entries]
    return np.array(points).reshape(-1, 2), [k for k, entry in enumerate(entries) if entry.get("best")]
