"""Draws how strategies come to the best fixed option: `python -m docs.figures.draw_learning RUN [DIR]`.

RUN is the directory of `clean-swarm evaluate random --strategy fixed`. A strategy chooses one option for a
whole mission and is rewarded by what that mission cost, so that the runs hold every answer it can get. The best fixed
option is chosen on one half of the scenarios and judged on the other, both ways round.
"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from selector.strategies.problem import Problem
from selector.strategies.registry import create
from selector.strategies.streams import row_keys
from train.analysis.strategy_comparison import BestFixed

Floats = NDArray[np.float64]
MISSIONS, SEEDS, SCALE = 400, 20, 100.0  # missions of a run, runs that learn each for itself, [s] that count as 1
CEILING = 6000.0  # [s] what is lost beyond this is not drawn
STRATEGIES = {
    "Random": {},
    "EpsilonGreedy": {"epsilon": 0.2, "decay": 0.02, "prior": 0.1},
    "UCB1": {"exploration": 1.0, "prior": 0.1},
    "DiscountedUCB": {"discount": 0.995, "exploration": 0.5, "prior": 0.1},
    "SlidingWindowUCB": {"window": 200, "exploration": 1.0, "prior": 0.1},
    "GaussianThompson": {"deviation": 1.0, "prior": 0.1},
    "EXP3": {"gamma": 0.1, "lowest": -10.0, "highest": 0.0, "prior": 0.1},
    "LinUCB": {"exploration": 1.0, "prior": 0.1},
    "LinearThompson": {"exploration": 1.0, "prior": 0.1},
}


def costs_of(run: Path) -> tuple[list[str], Floats]:
    """Return the fixed options of an evaluation and their costs (O, K) [s] on its scenarios."""
    with (run / "runs.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["condition"].startswith("fixed:")]
    options = list(dict.fromkeys(row["condition"] for row in rows))
    scenarios = list(dict.fromkeys(row["scenario"] for row in rows))
    cost = {(row["condition"], row["scenario"]): float(row["cost_s"]) for row in rows}
    return [o.removeprefix("fixed:") for o in options], np.array([[cost[o, s] for s in scenarios] for o in options])


def best_of(options: list[str], costs: Floats) -> tuple[str, Floats]:
    """Return the best fixed option, or both if the halves disagree, and its costs (K,) [s]."""
    by_option = {option: own[None, :, None] for option, own in zip(options, costs, strict=True)}
    best = BestFixed.of(by_option, options)
    return best.label, best.judged(by_option).ravel()


def regret(name: str, costs: Floats, best: Floats) -> Floats:
    """Return what (SEEDS, MISSIONS) was lost so far [s] against the costs (K,) of the best fixed option."""
    options, scenarios = costs.shape
    problem = Problem(
        "AvoidCollision", tuple(f"o{k}" for k in range(options)), np.zeros(options) - costs.mean() / SCALE
    )
    keys, rows = row_keys(np.random.SeedSequence(5), SEEDS), np.arange(SEEDS)
    strategy = create(name, problem, keys, STRATEGIES[name], groups=rows)
    drawn = np.random.default_rng(7).integers(scenarios, size=(MISSIONS, SEEDS))
    nothing, lost = np.zeros((SEEDS, 0)), np.empty((MISSIONS, SEEDS))
    for mission, scenario in enumerate(drawn):
        option = strategy.select(nothing)
        strategy.update(option, -costs[option, scenario] / SCALE, nothing)
        lost[mission] = costs[option, scenario] - best[scenario]
    return np.cumsum(lost, axis=0).T


def main(run: Path, directory: Path) -> None:
    """Draw all strategies into `learning.png`."""
    options, costs = costs_of(run)
    label, best = best_of(options, costs)
    print({option: round(float(mean), 1) for option, mean in zip(options, costs.mean(axis=1), strict=True)})
    figure, axes = plt.subplots(figsize=(9.5, 4.6), constrained_layout=True)
    for name in STRATEGIES:
        lost = regret(name, costs, best)
        mean, error = lost.mean(axis=0), 2.0 * lost.std(axis=0, ddof=1) / np.sqrt(SEEDS)
        (line,) = axes.plot(np.arange(1, MISSIONS + 1), mean, label=name, lw=1.6)
        axes.fill_between(np.arange(1, MISSIONS + 1), mean - error, mean + error, color=line.get_color(), alpha=0.15)
        late = (lost[:, -1] - lost[:, -101]) / 100.0
        print(f"{name}: regret {mean[-1]:.0f} s, in the last 100 missions {late.mean():.1f} s a mission")
    axes.set_xlabel("missions")
    axes.set_ylabel("cost lost so far [s]")
    axes.set_xlim(0, MISSIONS)
    axes.set_ylim(0, CEILING)
    axes.set_title(f"Regret against {label}, the best fixed option", fontsize=10)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right center", fontsize=8)
    figure.savefig(directory / "learning.png", dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).parents[1] / "pictures")
