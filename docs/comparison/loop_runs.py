"""Runs of every option on all missions of a loop. What the directory of the results holds already is kept."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import Split, scenario_name
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.named import FIXED
from docs.comparison.headroom import race
from docs.comparison.loop import LoopedFamily, LoopedMissions, LoopManifest
from docs.comparison.running import run
from selforg.arrays import Floats
from train.analysis.verdict import RANDOM
from train.evaluation.pipeline import mission_score
from train.running.finished_runs import JOURNAL, runs_of

FIGURES = ("excess_s", "cost_s")


@dataclass(frozen=True)
class LoopedRuns:
    """The runs on one family.

    Attributes:
        training: those on training missions.
        missions: those on the missions that judge.
        beside: name of a further strategy -> its excess cost (S, K) [s].

    """

    training: LoopedMissions
    missions: LoopedMissions
    beside: Mapping[str, Floats]

    def in_orders(self, seeds: Sequence[int]) -> "LoopedRuns":
        """Return the runs of the only seed in another order for each of `seeds`; that of the first one stays."""
        count = self.missions.scores.shape[2]
        drawn = [np.random.default_rng(seed).permutation(count) for seed in seeds[1:]]
        orders = [np.arange(count), *drawn]
        excess, scores = (
            np.concatenate([values[:, :, order] for order in orders])
            for values in (self.missions.excess, self.missions.scores)
        )
        beside = {name: np.concatenate([paid[:, order] for order in orders]) for name, paid in self.beside.items()}
        return LoopedRuns(self.training, replace(self.missions, excess=excess, scores=scores), beside)


def make_loop(manifest: LoopManifest, label: str, folder: Path) -> LoopedRuns:
    """Do the runs of a family that are missing, and return all."""
    asked = manifest.families[label]
    file = asked.file or label
    words = [word for strategy in ("fixed", *asked.beside) for word in ("--strategy", strategy)]
    kept = ("--goal", asked.goal, "--resume", "--output")
    drill = folder / f"{label}-training"
    race(file, asked.goal, drill, searched=manifest.training, judged=2, seed=manifest.training_seed)
    own_seeds = manifest.seeds[:1] if asked.reordered else manifest.seeds
    for seed in own_seeds:
        count = ("--scenarios", manifest.missions, "--seed", seed)
        run("evaluate", file, *words, *count, *kept, folder / f"{label}-{seed}")
    found = read_loop(asked, file, drill, [folder / f"{label}-{seed}" for seed in own_seeds])
    return found.in_orders(manifest.seeds) if asked.reordered else found


def read_loop(asked: LoopedFamily, file: str, drill: Path, judged: list[Path]) -> LoopedRuns:
    """Return the runs of a family in the directories of its training missions and of each seed."""
    mission = load_family(file).mission
    knowledge = knowledge_of(mission)
    options = [option.name for option in knowledge.options(asked.goal)]
    scored = np.vectorize(lambda cost: mission_score(mission, cost), otypes=[float])

    excess, cost = (read_table(drill, "train", options, figure)[None] for figure in FIGURES)
    training = LoopedMissions(knowledge, asked.goal, excess, scored(cost))
    fixed = [f"{FIXED}:{option}" for option in options]
    excess, cost = (np.stack([read_table(folder, "test", fixed, figure) for folder in judged]) for figure in FIGURES)
    others = (*asked.beside, RANDOM)
    beside = {
        name: np.stack([read_table(folder, "test", [name], FIGURES[0])[0] for folder in judged]) for name in others
    }
    return LoopedRuns(training, LoopedMissions(knowledge, asked.goal, excess, scored(cost)), beside)


def read_table(folder: Path, split: Split, names: list[str], figure: str) -> Floats:
    """Return a figure (C, K) of the runs of a directory, for each condition in `names`."""
    at = {one.key: one.result for one in runs_of(folder / JOURNAL)}
    count = sum(scenario.startswith(split) and name == names[0] for scenario, name in at)
    scenarios = [scenario_name(split, k) for k in range(count)]
    return np.array([[getattr(at[scenario, name], figure) for scenario in scenarios] for name in names])
