"""Deciders by strategies, which choose by scores or estimates, and by trained networks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from clean_swarm_env.deciders.decider import Decided, Decider, OptionDecider, columns_of
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.fields import JOINT
from selector.documents.plain import must_fit
from selector.knowledge import check_same
from selector.strategies.choosing import shares
from selector.strategies.policy_file import Network, TrainedPolicy
from selector.strategies.probing import Prober, Probing
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints


class StrategyDecider(OptionDecider):
    """A strategy that decides in every decision period; it learns where it is told rewards.

    Args:
        spec: the strategy.
        problem, teams: see `Decider`.
        options: names of the options that it knows; all unless given.
        features: components of the observation that are its context.

    Attributes:
        strategy: the strategy.

    """

    def __init__(
        self,
        spec: StrategySpec,
        problem: Problem,
        teams: Ints,
        options: tuple[str, ...] = (),
        features: tuple[str, ...] = (),
    ) -> None:
        super().__init__(problem, teams)
        self._columns = columns_of(problem, features, f"strategy {spec.name}")
        known = replace(problem.only(options) if options else problem, features=features)
        self.strategy = spec.build(known, row_keys(np.random.SeedSequence(0), len(teams)), teams)
        self._places: Ints = np.array([problem.options.index(name) for name in known.options])

    def reset(self, rows: Ints, seed: int) -> None:
        """Give rows new keys of random numbers."""
        self.strategy.reseed(rows, row_keys(np.random.SeedSequence([seed, 1]), len(rows)))

    def opinions(self) -> Floats:
        """Return the scores, estimates or probabilities (R, O) of the strategy; the least for what it does not know."""
        known = self.strategy.opinions(self._context)
        thought = np.repeat(known.min(axis=1, keepdims=True), len(self.problem.options), axis=1)
        thought[:, self._places] = known
        return thought

    def update(self, options: Ints, rewards: Floats, observations: Observations) -> None:
        """Let the strategy learn."""
        self.strategy.update(options, rewards, observations[:, self._columns].astype(np.float64))

    def _choose(self, observations: Observations) -> Ints:
        self._context = observations[:, self._columns].astype(np.float64)
        return np.asarray(self._places[self.strategy.select(self._context)])


LEAST = float(np.finfo(np.float32).min)
"""Output of options that a network was not trained for: they are taken only where no other can serve."""


class PolicyDecider(Decider):
    """A trained network: an option of each goal, a movement vector, or both.

    Options are found by name: one that the network does not know is not taken. A network that knows no option of a goal
    that is decided does not fit. It is the likeliest, unless its file or `probing` lets robots try others.
    """

    def __init__(self, policy: TrainedPolicy, problem: Problem, teams: Ints, probing: Probing | None = None) -> None:
        super().__init__(problem, teams)
        spec, self._rows = policy.spec, len(teams)
        self._prober = Prober(probing or spec.probing, problem, teams)
        check_same("policy", spec.definitions, problem.definitions)
        self._spec, self._network = spec, Network(policy)
        # goal, outputs, option -> output or -1, periods of a hold
        self._heads: list[tuple[str, slice, Ints, int]] = []
        self._keeping = np.zeros((len(spec.goals), len(teams)), dtype=np.int64)
        self._kept = self._keeping.copy()
        goals, first = problem.goal.split(JOINT), 0
        decided = [goal for joint in spec.goals for goal in joint.split(JOINT)]
        decides = not spec.goals or set(goals) <= set(decided)
        must_fit(decides, "policy: goals", ", ".join(goals), ", ".join(spec.goals))
        for joint, names in spec.goals.items():
            if set(joint.split(JOINT)) <= set(goals):
                places = [goals.index(goal) for goal in joint.split(JOINT)]
                own = [JOINT.join(option.split(JOINT)[k] for k in places) for option in problem.options]
                numbers = np.array([names.index(name) if name in names else -1 for name in own])
                some = f"some of {', '.join(dict.fromkeys(own))}"
                must_fit(bool(numbers.max() >= 0), f"policy: {joint}: options", some, ", ".join(names))
                self._heads.append((joint, slice(first, first + len(names)), numbers, spec.holds.get(joint, 1)))
            first += len(names)
        self._columns = columns_of(problem, spec.observations, "policy: observations")

    def reset(self, rows: Ints, seed: int) -> None:
        """Let rows (N,) choose anew."""
        self._keeping[:, rows] = 0
        self._prober.reset(rows, seed)

    def opinions(self) -> Floats:
        """Return the probabilities (R, O) of the network."""
        return shares(self._outputs)

    def moves(self, seen: Mapping[str, float], held: Mapping[str, str]) -> dict[str, dict[str, Any]]:
        """Return for each goal the option of a robot that sees something, its probability, and the inputs.

        It is the one that it holds, by goal, which may be `sampled`; the likeliest if the network does not know that.
        `moved`: by how much each input made it likelier than the input's mean does.
        """
        spec, told = self._spec, {}
        inputs = {name: seen[name] for name in spec.observations}
        cases = np.tile([*inputs.values()], (len(spec.observations) + 1, 1))
        cases[np.arange(len(spec.observations)) + 1, np.arange(len(spec.observations))] = spec.mean
        heads = self._network.heads(cases)["options"]
        for goal, outputs, numbers, _ in self._heads:
            known = np.unique(numbers[numbers >= 0])
            likely = shares(heads[:, outputs][:, known])
            names = [spec.goals[goal][number] for number in known]
            taken = JOINT.join(held[one] for one in goal.split(JOINT))
            chosen = names.index(taken) if taken in names else int(likely[0].argmax())
            moved = (likely[0, chosen] - likely[1:, chosen]).tolist()
            told[goal] = {
                "option": names[chosen],
                "sampled": self._prober.probing.sampled and taken in names,
                "probability": float(likely[0, chosen]),
                "inputs": inputs,
                "moved": dict(zip(spec.observations, moved, strict=True)),
            }
        return told

    def _decide(self, observations: Observations) -> Decided:
        heads = self._network.heads(observations[:, self._columns].astype(np.float64))
        self._outputs = np.zeros((self._rows, len(self.problem.options)))
        taken = self._outputs.copy()
        for k, (_, outputs, numbers, hold) in enumerate(self._heads):
            own = np.where(numbers < 0, LEAST, heads["options"][:, outputs][:, numbers])
            self._outputs += own
            chosen = numbers[self._prober.choose(own.argmax(axis=1), own > LEAST, own)]
            free = self._keeping[k] == 0
            self._kept[k] = np.where(free, chosen, self._kept[k])
            self._keeping[k] = np.where(free, hold, self._keeping[k]) - 1
            taken += numbers == self._kept[k][:, None]
        options = self._prober.held(taken.argmax(axis=1), observations)
        return Decided(options, heads.get("vector", np.zeros((self._rows, 2))))
