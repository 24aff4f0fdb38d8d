"""What each term of the activation is worth: mission time of the reference mission without it.

    python -m benchmarks.ablation [STARTS] [SEED]

prints the table of docs/network.md. Every variant runs on the same random start configurations, once with either
repulsion; a mission that is not completed counts with its time limit of 3,000 s.
"""

import sys
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.config import MissionConfig, NetworkConfig, StartConfiguration
from clean_swarm_env.config_files import load_mission
from clean_swarm_env.mission import MissionResult, run_mission
from clean_swarm_env.starts import random_start

CONDITIONS = ("RepulsionFernandez", "RepulsionGradient")
TERMS = ("situation", "goal", "conflictor", "predecessor", "successor", "plan")


@dataclass(frozen=True)
class Variant:
    """A network that lacks something."""

    name: str
    network: NetworkConfig


def variants(network: NetworkConfig) -> list[Variant]:
    """Return the whole network, the network without each term, and without a planner."""
    without = [Variant(f"without {term}", lacking(network, term)) for term in TERMS]
    planless = network.model_copy(update={"planner": "off"})
    return [Variant("all terms", network), *without, Variant("without planner", planless)]


def lacking(network: NetworkConfig, term: str) -> NetworkConfig:
    """Return the settings with the weight of one term 0."""
    return network.model_copy(update={"weights": network.weights.model_copy(update={term: 0.0})})


def results(mission: MissionConfig, starts: list[StartConfiguration], condition: str, seed: int) -> list[MissionResult]:
    """Run one mission from every start."""
    scores = {"AvoidCollision": {name: float(name == condition) for name in CONDITIONS}}
    return [run_mission(mission, start, seed + k, scores) for k, start in enumerate(starts)]


def cells(found: list[MissionResult]) -> str:
    """Return mean and median time and the share of missions that were completed."""
    times = [result.duration_s for result in found]
    done = sum(result.completed for result in found)
    return f"{np.mean(times):.0f} / {np.median(times):.0f} s, {done} of {len(found)}"


def main(arguments: list[str]) -> None:
    """Print the table, a line as soon as it is known."""
    count, seed = (int(text) for text in (*arguments, *("15", "1")[len(arguments) :]))
    mission = load_mission("reference")
    starts = [random_start(mission, seed, index) for index in range(count)]
    print(f"| {count} starts, mean / median time, completed | {' | '.join(CONDITIONS)} |\n|---|---|---|")
    for variant in variants(mission.network):
        changed = mission.model_copy(update={"network": variant.network})
        row = [cells(results(changed, starts, condition, seed)) for condition in CONDITIONS]
        print(f"| {variant.name} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
