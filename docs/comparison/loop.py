"""Missions one after the other with a store: what strategies choose, and what that costs.

A mission with one option for the whole team is the same run whoever chooses the option. So every option runs once on
every mission, and strategies learn from these runs as in `clean-swarm evaluate --store STORE --learn`.

Shapes: S seeds, O options, K missions.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from clean_swarm_env.config.types import Scenarios
from selector.documents.fields import Closed, Flag, Name
from selector.knowledge import Knowledge
from selector.store import KnowledgeStore
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, StrategySpec, named
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints
from train.memory import Memory

LEARNERS = tuple(name for name in STRATEGIES.names() if named(name).can_learn())
"""All strategies that learn scores."""
EXPERTS, RIGHT, WRONG = "experts'", "right", "wrong"
STARTS = (EXPERTS, RIGHT, WRONG)
"""The scores at the beginning: as shipped; those of training missions; the same ones the wrong way round."""
DRAWN_SEQUENCES = 20
"""Sequences of missions, drawn from the training missions, on which numbers of strategies are tried."""


class LoopedFamily(Closed):
    """A family whose missions are done one after the other."""

    goal: Name
    """Goal that the strategies choose options for."""
    file: str = ""
    """Path of the family, if it does not ship."""
    beside: tuple[str, ...] = ()
    """Further strategies on the same missions."""
    reordered: Flag = False
    """Whether further seeds have the missions of the first one in another order, which costs nothing more to run."""


class LoopManifest(Closed):
    """What is learned where."""

    name: Name
    """Directory of the results, below results/, and the page below docs/."""
    families: Annotated[dict[Name, LoopedFamily], Field(min_length=1)]
    """Families."""
    missions: Scenarios
    """K."""
    last: Scenarios
    """Number of the last missions, which judge what was learned, and of those in a row that have to be cheap."""
    seeds: Annotated[tuple[int, ...], Field(min_length=2)]
    """Seeds of the missions, which are those of the strategies, too."""
    training: Scenarios
    """Number of training missions."""
    training_seed: int
    """Seed of the training missions."""
    scaled: tuple[Name, ...]
    """Parameters in units of the spread of the scores of training missions."""
    numbers: dict[Name, dict[Name, tuple[float, ...]]]
    """Strategy -> parameter -> values that are tried on training missions."""
    drawn: tuple[Name, ...]
    """Strategies of the picture."""


@dataclass(frozen=True)
class LoopedMissions:
    """What each option brings on each mission of a family.

    Attributes:
        knowledge: the expert knowledge of the family.
        goal: the goal that is chosen for.
        excess: (S, O, K) excess cost [s].
        scores: (S, O, K) score of the mission [-].

    """

    knowledge: Knowledge
    goal: str
    excess: Floats
    scores: Floats

    @property
    def options(self) -> tuple[str, ...]:
        """Names of the options."""
        return tuple(option.name for option in self.knowledge.options(self.goal))

    @cached_property
    def spread(self) -> float:
        """The middle one of the standard deviations of the options' scores [-]."""
        return float(np.median(self.scores.std(axis=(0, 2), ddof=1)))

    def starting(self, start: str) -> Knowledge:
        """Return the knowledge at the beginning, by these missions: one of `STARTS`."""
        if start == EXPERTS:
            return self.knowledge
        means = self.scores.mean(axis=(0, 2))
        order = np.argsort(means, kind="stable")
        values = means.copy()
        if start == WRONG:
            values[order] = means[order[::-1]]
        return self.knowledge.with_scores({self.goal: dict(zip(self.options, values.tolist(), strict=True))})

    def sequences(self, missions: int) -> "LoopedMissions":
        """Return `DRAWN_SEQUENCES` sequences of missions that are drawn from these, with replacement."""
        rng = np.random.default_rng(0)
        places = rng.integers(self.scores.shape[2], size=(DRAWN_SEQUENCES, missions))
        excess, scores = (np.stack([values[0][:, own] for own in places]) for values in (self.excess, self.scores))
        return LoopedMissions(self.knowledge, self.goal, excess, scores)

    def paid(self, taken: Ints) -> Floats:
        """Return the excess cost (S, K) of missions with the options `taken` (S, K)."""
        paid: Floats = np.take_along_axis(self.excess, taken[:, None, :], axis=1)[:, 0]
        return paid


def learned_choices(spec: StrategySpec, knowledge: Knowledge, missions: LoopedMissions, seeds: tuple[int, ...]) -> Ints:
    """Return what a strategy chooses (S, K) while it learns from mission after mission, for each seed on its own."""
    seed_count, _, count = missions.scores.shape
    keys = np.concatenate([row_keys(np.random.SeedSequence([seed, 0]), 1) for seed in seeds])
    alone, nothing = np.arange(seed_count), np.zeros((seed_count, 0))
    strategy = spec.build(Problem.of(knowledge, missions.goal), keys, alone)
    taken = np.zeros((seed_count, count), dtype=np.int64)
    for mission in range(count):
        taken[:, mission] = strategy.select(nothing)
        strategy.update(taken[:, mission], missions.scores[alone, taken[:, mission], mission], nothing)
    return taken


def stored_choices(
    knowledge: Knowledge, missions: LoopedMissions, given: Ints | None = None
) -> tuple[Ints, list[list[float]]]:
    """Return what `MaxScore` takes (S, K) if each mission begins anew with the store, and the scores that count then.

    With `given` (S, K), these options are taken instead, and the store gets their scores.
    """
    seeds, _, count = missions.scores.shape
    taken, known = np.zeros((seeds, count), dtype=np.int64), []
    for seed in range(seeds):
        with TemporaryDirectory() as directory:
            store = KnowledgeStore(str(Path(directory) / "scores.sqlite"))
            memory = Memory(store, knowledge, "missions", f"seed {seed}")
            for mission in range(count):
                if given is None:
                    taken[seed, mission] = Problem.of(memory.now(), missions.goal).scores.argmax()
                    memory.give([_reward(missions, seed, mission, taken)])
            if given is not None:
                taken[seed] = given[seed]
                memory.give(_reward(missions, seed, mission, taken) for mission in range(count))
            known.append(Problem.of(memory.now(), missions.goal).scores.tolist())
    return taken, known


def _reward(missions: LoopedMissions, seed: int, mission: int, taken: Ints) -> tuple[str, str, float]:
    option = taken[seed, mission]
    return missions.goal, missions.options[option], float(missions.scores[seed, option, mission])


def tried_numbers(manifest: LoopManifest, strategy: str) -> list[dict[str, float]]:
    """Return the parameters that are tried, those of `scaled` in units of the spread."""
    grid = manifest.numbers.get(strategy, {})
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]


def spec_with(
    manifest: LoopManifest, strategy: str, numbers: Mapping[str, float], training: LoopedMissions
) -> StrategySpec:
    """Return a strategy whose numbers are on the scale of the scores of training missions."""
    parameters: dict[str, Any] = {
        name: value * (training.spread if name in manifest.scaled else 1.0) for name, value in numbers.items()
    }
    if "lowest" in named(strategy).Parameters.model_fields:
        parameters |= {"lowest": float(training.scores.min()), "highest": float(training.scores.max())}
    return StrategySpec(name=strategy, parameters=parameters, sharing="robot")


def chosen_numbers(manifest: LoopManifest, trainings: Mapping[str, LoopedMissions]) -> dict[str, dict[str, float]]:
    """Return for each strategy the numbers with which training missions cost least, on average over all starts.

    What is averaged is the logarithm of the cost of all missions, beside that of the best option.
    """
    seeds = tuple(range(DRAWN_SEQUENCES))
    drawn = {label: training.sequences(manifest.missions) for label, training in trainings.items()}
    found = {}
    for strategy in LEARNERS:
        costs = []
        for numbers in tried_numbers(manifest, strategy):
            cost = 0.0
            for (label, training), start in product(trainings.items(), STARTS):
                spec = spec_with(manifest, strategy, numbers, training)
                taken = learned_choices(spec, training.starting(start), drawn[label], seeds)
                best = drawn[label].excess.mean(axis=(0, 2)).min()
                cost += float(np.log(drawn[label].paid(taken).mean() / best))
            costs.append(cost)
        found[strategy] = tried_numbers(manifest, strategy)[int(np.argmin(costs))]
    return found
