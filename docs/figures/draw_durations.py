"""Draws durations of the reference experiment, ours beside the measured ones, each condition by itself.

`python -m docs.figures.draw_durations STARTS RESULTS ...`: the file of measured starts, and directories that
`clean-swarm evaluate table1-reference --starts STARTS` wrote. Writes docs/pictures/durations.png.
"""

import csv
import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from clean_swarm_env.tasks.cleaning.missions import CleaningStarts

CONDITIONS = {
    "RepulsionFernandez-view2.0": ("RepulsionFernandez, view 2.0", "#D55E00"),
    "RepulsionFernandez-view1.5": ("RepulsionFernandez, view 1.5", "#E69F00"),
    "RepulsionGradient-view1.5": ("RepulsionGradient, view 1.5", "#0072B2"),
}
"""What a condition is called where it was measured, and its colour."""


def our_durations(directories: Sequence[Path], condition: str) -> list[float]:
    """Return the durations [s] of all missions of a condition in directories of results."""
    durations = []
    for directory in directories:
        with (directory / "runs.csv").open(encoding="utf-8", newline="") as file:
            durations += [float(row["duration_s"]) for row in csv.DictReader(file) if row["condition"] == condition]
    return durations


def main(starts: Path, directories: Sequence[Path]) -> None:
    """Draw the share of missions that are over, against time; steps are data, circles the means."""
    measured = CleaningStarts.read(starts).measured
    figure, axes = plt.subplots(figsize=(8.0, 4.2), layout="constrained")
    for condition, (name, colour) in CONDITIONS.items():
        theirs = [figures[name]["duration_s"] for figures in measured.values() if name in figures]
        ours = our_durations(directories, condition)
        for durations, style, who in ((ours, "-", "ours"), (theirs, ":", "measured")):
            label = f"{condition}, {who}: {len(durations)} missions, mean {np.mean(durations):.0f} s"
            axes.ecdf(durations, color=colour, linestyle=style, label=label)
            mean = float(np.mean(durations))
            axes.plot(
                mean, np.mean(np.array(durations) <= mean), "o", color=colour, mfc="w" if style == ":" else colour
            )
    axes.set(xlabel="duration [s]", ylabel="share of missions that are over", xlim=(0.0, None), ylim=(0.0, 1.02))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="lower right", frameon=False, fontsize=8)
    figure.savefig(Path("docs/pictures/durations.png"), dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(argument) for argument in sys.argv[2:]])
