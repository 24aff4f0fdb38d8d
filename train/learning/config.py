"""Typed, closed configuration of a training: on what, what is seen and rewarded, how it learns, when it stops."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.types import Count
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.reward import RewardConfig
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Name, NonNegative, Positive, Share
from selector.documents.find import load_file
from selector.strategies.registry import StrategySpec


class TaskConfig(Closed):
    """A family of scenarios to train on."""

    family: Name
    """Name of the family, or path to its YAML file."""
    worlds: Count = 16
    """Worlds that run side by side."""


class ValidationConfig(Closed):
    """How what was learned is measured at every checkpoint, on scenarios that nothing is learned from."""

    scenarios: Count = 16
    """Scenarios of each family."""
    every: Count = 1
    """Checkpoints from one measurement to the next."""
    patience: Count = 1000
    """Measurements without a better mission cost after which the training stops."""


class PpoConfig(Closed):
    """Hyper-parameters of PPO (Schulman et al. 2017, doi:10.48550/arXiv.1707.06347)."""

    steps: Count = 64
    """Decisions of each row between two updates."""
    minibatch: Count = 4096
    """Decisions of one gradient step."""
    epochs: Count = 4
    """Times that all decisions of an update are gone through."""
    learning_rate: Positive = 3e-4
    """Step size of Adam at the beginning; it falls linearly to a tenth [-]."""
    discount: Share = 0.98
    """Weight of a reward one decision later [-]."""
    trace: Share = 0.95
    """Weight of longer returns in the advantage (lambda of GAE) [-]."""
    clip: Positive = 0.2
    """Largest change of a probability's ratio that is rewarded [-]."""
    entropy: NonNegative = 0.01
    """Weight of the entropy: keeps options in use [-]."""
    value: Positive = 0.5
    """Weight of the value function's error [-]."""
    gradient: Positive = 0.5
    """Largest norm of the gradient [-]."""
    hidden: tuple[Count, ...] = (64, 64)
    """Widths of the hidden layers, of policy and value function alike."""


class CreditConfig(Closed):
    """Which rewards count for a decision of a bandit, and how long it is held."""

    hold: NonNegative = 10.0
    """Longest time for which a row keeps its option [s]; 0: one decision for a whole mission."""
    until: tuple[Name, ...] = ()
    """Components of the observation whose change ends it before."""
    horizon: Positive = 30.0
    """Time after the decision over which rewards count [s]."""
    discount: Share = 0.95
    """Weight of a reward one second later [-]."""


class ComparisonConfig(Closed):
    """How missions are compared: by the logarithm of the cost, with those of the same scenario."""

    group: Annotated[int, Field(strict=True, ge=2)] = 8
    """Missions of each scenario."""
    limit: Positive = 0.1
    """Largest reward and, negative, the smallest: a mission that fails counts as one that costs a tenth more [-]."""


class BanditConfig(Closed):
    """A strategy that learns from the rewards that follow its choices."""

    strategy: StrategySpec
    """The strategy with its parameters."""
    context: tuple[Name, ...] = ()
    """Components of the observation that it sees."""
    credit: CreditConfig = CreditConfig()
    """Which rewards count, if robots decide for themselves."""
    comparison: ComparisonConfig | None = None
    """Let teams decide once a mission what to do in each situation, rewarded by how its cost compares with others'.
    `context` then names the situations, components of which the largest counts. None: robots decide, see `credit`."""
    exported: dict[Name, Any] = Field(default_factory=dict)
    """Parameters of the strategy that differ once it has learned, for instance to explore no more."""

    @model_validator(mode="after")
    def _exists(self) -> Self:
        self.learned  # noqa: B018  (a mistake in the parameters is an error when the file is read)
        return self

    @property
    def learned(self) -> StrategySpec:
        """The strategy as it decides once it has learned."""
        spec = self.strategy
        return StrategySpec(name=spec.name, parameters={**spec.parameters, **self.exported}, sharing=spec.sharing)


class TrainingConfig(Closed):
    """One training."""

    name: Name
    """Name of the training and of what comes out."""
    description: str = ""
    """What is learned, in one sentence."""
    tasks: Annotated[tuple[TaskConfig, ...], Field(min_length=1)]
    """The families to train on."""
    goal: Name | None = None
    """Goal of which the options are learned; AvoidCollision, or the only goal of the missions, unless given."""
    observation: ObservationConfig = ObservationConfig()
    """What each robot sees."""
    reward: RewardConfig = RewardConfig()
    """What it is rewarded for."""
    checkpoints: Count = 20
    """Number of checkpoints: at each one all is saved and all worlds begin anew."""
    decisions: Count = 100_000
    """Decisions of all rows from one checkpoint to the next, at least."""
    validation: ValidationConfig = ValidationConfig()
    """How what was learned is measured."""
    ppo: PpoConfig | None = None
    """Learn a policy by PPO, or ..."""
    bandit: BanditConfig | None = None
    """... let a strategy learn."""

    @model_validator(mode="after")
    def _one_learner(self) -> Self:
        if (self.ppo is None) == (self.bandit is None):
            raise ValueError("expected either ppo or bandit")
        comparison = self.bandit.comparison if self.bandit is not None else None
        for task in self.tasks if comparison is not None else ():
            assert comparison is not None
            if task.worlds % comparison.group:
                expected = f"worlds that make groups of {comparison.group}"
                raise ValueError(f"tasks: {task.family}: expected {expected}, got {task.worlds}")
        return self

    @property
    def learner(self) -> Literal["ppo", "bandit"]:
        """What learns."""
        return "ppo" if self.ppo is not None else "bandit"


def load_training(name: str, learner: str, directories: Sequence[Path] = ()) -> TrainingConfig:
    """Return the training of a name, in `directories` or among those that ship, or of a path to a YAML file.

    Raises:
        DocumentError: no such file, a mistake in it, or a training of another learner.

    """
    config = load_file("training", name, TrainingConfig, directories)
    if config.learner != learner:
        raise DocumentError(f"{name}: expected a training by {learner}, got one by {config.learner}")
    return config
