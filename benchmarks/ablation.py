"""The effect of each term of the activation: mission time without the term, on the same random starts.

    python -m benchmarks.ablation [STARTS] [SEED]

prints the tables that docs/paper.md sums up. The network lacks one term at a time (its
weight is 0), or its planner. Robots pass through each other, or are solid. A mission that is not completed counts with
the time limit. 20 starts take 11 minutes on one core.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.shared.scenes import mission_holding
from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig, NetworkConfig
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.learning.batch import run_out
from selforg.arrays import Floats
from train.analysis.intervals import Ratio
from train.analysis.statistics import summarise

OPTIONS = ("RepulsionFernandez-view2.0", "RepulsionFernandez-view1.5", "RepulsionGradient-view1.5")
TERMS = ("situation", "goal", "conflictor", "predecessor", "successor", "plan")
ALL, OFF = "all terms", "planner off"
TIME_LIMIT = 6000.0  # [s], twice that of the missions, so that slow variants are measured and not cut off
STARTS, SEED = 20, 1


@dataclass(frozen=True)
class Section:
    """One table: a mission under some options, for all variants or a few."""

    mission: str
    title: str
    options: tuple[str, ...]
    variants: tuple[str, ...] = ()
    """Empty: all."""


WORLDS = {"reference": "robots pass through each other", "table1": "solid robots, the default"}
SECTIONS = (
    *(Section(name, title, (OPTIONS[0], OPTIONS[2])) for name, title in WORLDS.items()),
    *(
        Section(name, f"{title}; a Fernandez that only repels", OPTIONS[1:2], (ALL, OFF))
        for name, title in WORLDS.items()
    ),
)


def variants(network: NetworkConfig) -> dict[str, NetworkConfig]:
    """Return the whole network, the network without each term, and without a planner."""
    without = {f"without {term}": lacking(network, term) for term in TERMS}
    return {ALL: network, **without, OFF: network.model_copy(update={"planner": "off"})}


def lacking(network: NetworkConfig, term: str) -> NetworkConfig:
    """Return the settings with the weight of one term 0."""
    return network.model_copy(update={"weights": network.weights.model_copy(update={term: 0.0})})


def missions(mission: MissionConfig, option: str, starts: int, seed: int) -> tuple[Floats, Floats]:
    """Run the mission from every start; return durations (K,) [s] and whether each was completed (K,)."""
    results = [
        run_out(mission_holding(option, mission, random_start(mission, seed, k), run_seed(seed, str(k))))
        for k in range(starts)
    ]
    return np.array([r.duration_s for r in results]), np.array([float(r.completed) for r in results])


def cells(durations: Floats, completed: Floats, whole: Floats) -> str:
    """Return mean with its interval, ratio to the `whole` network with its interval, and the share completed."""
    summary, ratio = summarise(durations), Ratio.of(durations, whole)
    mean = f"{summary.mean:.0f}" + (f" [{summary.ci95[0]:.0f}, {summary.ci95[1]:.0f}]" if summary.ci95 else "")
    times = "" if durations is whole else f"{ratio.ratio:.2f}"
    times += f" [{ratio.ci95[0]:.2f}, {ratio.ci95[1]:.2f}]" if times and ratio.ci95 else ""
    return f"{mean} | {times} | {completed.sum():.0f} of {len(completed)}"


def table(section: Section, starts: int, seed: int) -> Iterator[str]:
    """Yield the lines of a table, each as soon as its runs are done."""
    yield "| | " + " | ".join(f"{name}: time s | x {ALL} | completed" for name in section.options) + " |"
    yield "|---|" + "---|---|---|" * len(section.options)
    mission = load_mission(section.mission)
    whole: dict[str, Floats] = {}
    for name, network in variants(mission.network).items():
        if section.variants and name not in section.variants:
            continue
        changed = mission.model_copy(update={"network": network, "time_limit": TIME_LIMIT})
        row = []
        for option in section.options:
            durations, completed = missions(changed, option, starts, seed)
            row.append(cells(durations, completed, whole.setdefault(option, durations)))
        yield f"| {name} | {' | '.join(row)} |"


def document(starts: int, seed: int) -> Iterator[str]:
    """Yield the lines of the results."""
    yield f"{starts} random start configurations of seed {seed}, time limit {TIME_LIMIT:g} s.\n"
    for section in SECTIONS:
        yield f"## Mission `{section.mission}`: {section.title}\n"
        yield from table(section, starts, seed)
        yield ""


def main(arguments: list[str]) -> None:
    """Print the results line by line."""
    starts, seed = (int(text) for text in (*arguments, *(str(STARTS), str(SEED))[len(arguments) :]))
    for line in document(starts, seed):
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
