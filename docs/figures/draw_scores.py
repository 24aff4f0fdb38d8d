"""Draws how wrong scores are put right by missions: `python -m docs.figures.draw_scores [FILE]`.

It runs the commands of `docs/scores.md`: a process that learns for 30 missions, a second one that joins in the middle,
and the options alone on the same missions. This takes some minutes.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MultipleLocator

from docs.figures.update_results import CLEAN_SWARM
from selector.documents.reading import read_value
from selector.knowledge import Knowledge, knowledge_from
from tests.pages import blocks

FILE, GOAL = Path(__file__).parents[1] / "pictures" / "scores.png", "AvoidCollision"
MISSIONS, JOINS = 30, 15  # missions of the first process, and after which of them the second one begins
COSTS = [60, 100, 200, 400, 600]  # [s] marked on the axis
COLOURS = ("#c44e52", "#4c72b0", "#55a868")
LEARN = "evaluate rooms --configs my --store s.sqlite --learn --strategy UCB1:exploration=0.05,prior=0"
ALONE = "evaluate rooms --configs my --strategy fixed --output alone --scenarios"


def command(directory: Path, words: str) -> None:
    """Run `clean-swarm` with these words in a directory."""
    subprocess.run([*CLEAN_SWARM, *words.split()], cwd=directory, check=True, stdout=subprocess.DEVNULL)


def write_files(directory: Path) -> Knowledge:
    """Write the YAML files of the page and return the expert knowledge among them."""
    files = {block.file: block.text for block in blocks("docs/scores.md") if block.file}
    for name, text in files.items():
        (directory / name).parent.mkdir(parents=True, exist_ok=True)
        (directory / name).write_text(text, encoding="utf-8")
    return knowledge_from(read_value(files["my/knowledge/wrong.yaml"]))


def choices(run: Path) -> list[tuple[str, float, float]]:
    """Return option, score and cost [s] of each mission of an evaluation that learned, in their order."""
    with (run / "runs.csv").open(newline="") as file:
        cost = {row["scenario"]: float(row["cost_s"]) for row in csv.DictReader(file)}
    lines = map(json.loads, (run / "choices.jsonl").read_text().splitlines())
    return [(one["options"][GOAL], one["score"], cost[one["scenario"]]) for one in lines]


def mean_costs(run: Path) -> dict[str, float]:
    """Return the mean cost [s] of each option alone."""
    costs: dict[str, list[float]] = {}
    with (run / "runs.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            costs.setdefault(row["condition"].removeprefix("fixed:"), []).append(float(row["cost_s"]))
    return {name: float(np.mean(some)) for name, some in costs.items()}


def draw_learned(axes: Axes, known: Knowledge, first: list[tuple[str, float, float]]) -> None:
    """Draw the mean score of each option after each mission, from the expert's score on."""
    for option, colour in zip(known.options(GOAL), COLOURS, strict=True):
        scores, shown = [], [option.score]
        for name, score, _ in first:
            scores += [score] if name == option.name else []
            shown.append(float(np.mean(scores)) if scores else option.score)
        axes.step(range(len(shown)), shown, where="post", color=colour, lw=1.8, label=option.name)
    axes.set_ylabel("score: expert's, then learned")
    axes.set_ylim(-0.05, 1.08)
    axes.legend(fontsize=8, loc="lower right")


def draw_costs(axes: Axes, known: Knowledge, first: list[tuple[str, float, float]], alone: dict[str, float]) -> None:
    """Draw the cost of each mission in the colour of its option, and the mean of each option alone."""
    names = [option.name for option in known.options(GOAL)]
    for k, (name, _, cost) in enumerate(first):
        axes.plot(k + 1, cost, "o", color=COLOURS[names.index(name)], ms=6)
    for name, colour in zip(names, COLOURS, strict=True):
        axes.axhline(alone[name], color=colour, lw=1.0, ls="--")
        axes.annotate(f"{alone[name]:.0f} s", (0.2, alone[name]), (0, 2), textcoords="offset points", fontsize=8)
    axes.set_yscale("log")
    axes.set_yticks(COSTS, COSTS)
    axes.minorticks_off()
    axes.set_xlabel("mission")


def main(file: Path) -> None:
    """Run the story in a new directory and draw it."""
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        known = write_files(directory)
        command(directory, f"{LEARN} --scenarios {JOINS} --output first")
        command(directory, f"{LEARN} --scenarios {JOINS} --seed 1 --output second")
        command(directory, f"{LEARN} --scenarios {MISSIONS} --output first --resume")
        command(directory, f"{ALONE} {MISSIONS}")
        first, second, alone = (
            choices(directory / "first"),
            choices(directory / "second"),
            mean_costs(directory / "alone"),
        )
    figure, ((learned, joined), (costs, later)) = plt.subplots(
        2, 2, figsize=(11, 6.4), sharex="col", sharey="row", width_ratios=(2, 1), constrained_layout=True
    )
    draw_learned(learned, known, first)
    draw_costs(costs, known, first, alone)
    draw_costs(later, known, second, alone)
    costs.set_ylabel("cost of the mission [s]")
    names = [option.name for option in known.options(GOAL)]
    for option, colour in zip(known.options(GOAL), COLOURS, strict=True):
        before = [score for name, score, _ in first[:JOINS] if name == option.name]
        shown = []
        for name, score, _ in [("", 0.0, 0.0), *second]:
            before += [score] if name == option.name else []
            shown.append(float(np.mean(before)) if before else option.score)
        joined.step(range(len(shown)), shown, where="post", color=colour, lw=1.8)
    learned.set_title("one process learns from wrong scores", fontsize=10)
    joined.set_title(f"a second one joins after {JOINS} missions", fontsize=10)
    learned.axvline(JOINS, color="0.7", lw=1.0, ls=":")
    for axes in (learned, joined, costs, later):
        axes.grid(alpha=0.25)
        axes.set_xlim(left=0)
        axes.xaxis.set_major_locator(MultipleLocator(5))
    figure.savefig(file, dpi=110, metadata={"Software": "clean-swarm"})
    for label, some in (("first", first), ("second", second)):
        print(label, {name: [one[0] for one in some].count(name) for name in names}, end="; ")
        print("mean cost", *(f"{np.mean([c for _, _, c in some[k : k + 10]]):.0f}" for k in range(0, len(some), 10)))
    print("alone", {name: round(cost) for name, cost in alone.items()})


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FILE)
