"""A policy of options that stays as it is while corrections beside it are learned.

Shapes: R rows (robots), F components of an observation, O options.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from stable_baselines3.common.running_mean_std import RunningMeanStd

from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import DocumentError, shown
from selector.strategies.policy_file import Floats32, PolicySpec, TrainedPolicy, find_policy, load_policy
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from train.learning.config import PpoConfig
from train.running.pilots import PolicyPilot, columns_of


class Chooser:
    """Chooses the options of all robots.

    Args:
        name: name or path of the policy.
        problem: goal and options; its features are what robots see.
        settings: of the training beside it.
        directories: the user's own directories of configurations, searched before the shipped one.

    Attributes:
        digest: digest of its weights.

    Raises:
        DocumentError: there is no such policy, it does not fit the problem, corrects itself, or cannot be joined with
            what is learned.

    """

    def __init__(self, name: str, problem: Problem, settings: PpoConfig, directories: Sequence[Path] = ()) -> None:
        directory = find_policy(name, directories)
        policy, where = load_policy(directory), f"chooser: {shown(directory)}"
        spec = policy.spec
        if spec.vector:
            raise DocumentError(f"{where}: expected a policy that chooses options only, got one that steers")
        if spec.activation != "tanh" or len(spec.hidden) != len(settings.hidden):
            expected = f"{len(settings.hidden)} hidden layers of tanh, as what is learned beside it"
            raise DocumentError(f"{where}: expected {expected}, got {len(spec.hidden)} of {spec.activation}")
        self._columns = columns_of(problem, spec.observations, f"{where}: observations")
        self._policy = policy.ordered_for(replace(problem, features=spec.observations), where)
        self._pilot = PolicyPilot(policy, problem)
        self.digest = spec.weights_sha256

    def choose(self, observations: Observations) -> Ints:
        """Return the options (R,) for observations (R, F), behind which there may be a global state."""
        return self._pilot.choose(observations)

    def moments(self, components: int) -> RunningMeanStd:
        """Return by what so many components are normalised for both networks: as the chooser does, or learned."""
        spec = self._policy.spec
        return PartlyKnownMoments(components, self._columns, np.array(spec.mean), np.array(spec.variance))

    def joined(self, corrections: TrainedPolicy, patience: float | None) -> TrainedPolicy:
        """Return one policy that chooses as this one, and corrects as `corrections`, which only steers."""
        own, added = self._policy, corrections
        first, *_ = (name for name, _, _ in own.spec.layers())
        seen = np.zeros((len(own.weights[f"{first}.bias"]), len(added.spec.observations)), dtype=np.float32)
        seen[:, self._columns] = own.weights[f"{first}.weight"]
        weights = {**own.weights, f"{first}.weight": seen}
        joined: dict[str, Floats32] = {}
        for place, ((one, _, _), (other, _, _)) in enumerate(zip(own.spec.layers(), added.spec.layers(), strict=True)):
            rows = _beside(weights[f"{one}.weight"], added.weights[f"{other}.weight"], same_inputs=place == 0)
            cut = len(rows) if one == other else len(weights[f"{one}.bias"])
            biases = np.concatenate([weights[f"{one}.bias"], added.weights[f"{other}.bias"]])
            joined |= {f"{one}.weight": rows[:cut], f"{one}.bias": biases[:cut]}
            if one != other:
                joined |= {f"{other}.weight": rows[cut:], f"{other}.bias": biases[cut:]}
        spec = {
            **added.spec.model_dump(),
            "options": own.spec.options,
            "hidden": tuple(np.add(own.spec.hidden, added.spec.hidden).tolist()),
            "patience": patience,
        }
        return TrainedPolicy(PolicySpec(**spec), joined)


class PartlyKnownMoments(RunningMeanStd):
    """Mean and variance of so many components; those of `known` (K,) do not change."""

    def __init__(self, components: int, known: Ints, mean: Floats, variance: Floats) -> None:
        super().__init__(shape=(components,))
        self._known = known, mean, variance
        self._keep()

    def update(self, arr: NDArray[np.float64]) -> None:
        """Learn of the other components from observations (R, F)."""
        super().update(arr)
        self._keep()

    def _keep(self) -> None:
        known, mean, variance = self._known
        self.mean[known], self.var[known] = mean, variance


def _beside(one: Floats32, other: Floats32, *, same_inputs: bool) -> Floats32:
    """Return the weights of two layers as those of one, which have the same inputs or each its own."""
    whole: Floats32 = np.vstack([one, other]) if same_inputs else block_diag(one, other)
    return whole
