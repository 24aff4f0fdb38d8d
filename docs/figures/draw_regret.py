"""Draws regret on synthetic bandits: `python -m docs.figures.draw_regret [DIR]` (default docs/pictures)."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from tests.selector.strategies.bandits import Means, constant, linear, regrets

STEPS, PERIOD, ROWS = 4000, 400, 100
ALL = {
    "Random": {},
    "EpsilonGreedy": {"epsilon": 0.1},
    "UCB1": {"exploration": 0.5},
    "DiscountedUCB": {"discount": 0.98, "exploration": 0.15, "prior": 0.1},
    "SlidingWindowUCB": {"window": 150, "exploration": 0.3, "prior": 0.1},
    "GaussianThompson": {"deviation": 0.25},
    "EXP3": {"gamma": 0.05},
    "LinUCB": {"exploration": 1.0},
    "LinearThompson": {"exploration": 0.25},
}
COLOURS = {
    "Random": "#8d99ae",
    "EpsilonGreedy": "#000000",
    "UCB1": "#0072B2",
    "DiscountedUCB": "#56B4E9",
    "SlidingWindowUCB": "#009E73",
    "GaussianThompson": "#D55E00",
    "EXP3": "#CC79A7",
    "LinUCB": "#E69F00",
    "LinearThompson": "#8a6d00",
}


def switching(period: int, *means: float) -> Means:
    """Return means that are handed on to the next option every `period` steps."""
    return lambda step, context: np.roll(np.array([means]), step // period, axis=1)


SCENES: dict[str, tuple[Means, int]] = {
    "rewards that stay as they are": (constant(0.2, 0.8, 0.5, 0.3), 0),
    f"the best of two changes every {PERIOD} decisions": (switching(PERIOD, 0.3, 0.8), 0),
    "rewards that depend on the context": (linear((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.7, -0.7, 0.0)), 3),
}


def draw(axes: Axes, title: str, means: Means, features: int) -> None:
    """Draw what each strategy lost, all in all, against the number of decisions."""
    worst = 0.0
    for name, parameters in ALL.items():
        total = np.cumsum(regrets(name, parameters, means, steps=STEPS, rows=ROWS, features=features))
        axes.plot(np.arange(1, STEPS + 1), total, color=COLOURS[name], label=name, lw=1.6)
        print(f"{title}: {name}: regret {total[-1]:.1f}, of its last quarter {total[-1] - total[-STEPS // 4]:.1f}")
        worst = max(worst, float(total[-1]))
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("decisions of a robot")
    axes.set_xlim(0, STEPS)
    axes.set_ylim(0, 0.5 * worst)
    axes.grid(alpha=0.3)


def main(directory: Path) -> None:
    """Draw the scenes side by side into `regret.png`."""
    figure, panels = plt.subplots(1, len(SCENES), figsize=(13, 4.2), constrained_layout=True)
    for axes, (title, (means, features)) in zip(panels, SCENES.items(), strict=True):
        draw(axes, title, means, features)
    panels[0].set_ylabel("regret: reward lost so far")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(ALL), fontsize=8)
    directory.mkdir(parents=True, exist_ok=True)
    figure.savefig(directory / "regret.png", dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "pictures")
