"""Document model of a training: families, observation, reward, learner and validation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.types import Count, Scenarios, WorldCount
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.reward import RewardConfig
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, DocumentName, JointName, Name, NonNegative, Positive, Share
from selector.documents.find import load_file
from selector.strategies.machine_file import MOST_STATES
from selector.strategies.registry import StrategySpec
from train.learning.racing import RaceConfig

LEARNERS = {"ppo": ("torch", "stable-baselines3"), "bandit": (), "es": (), "design": ()}
"""Kinds of learners, each the key of its settings, and the packages that it needs besides those of all runs."""


class TaskConfig(Closed):
    """A family of scenarios to train on."""

    family: DocumentName
    """Name of the family, or path to its YAML file."""
    knowledge: DocumentName | None = None
    """Name of the expert knowledge with the options to learn; that of the family unless given."""
    worlds: WorldCount = 16
    """Worlds that run at the same time."""

    def load(self, directories: Sequence[Path] = ()) -> FamilyConfig:
        """Return the family with the knowledge of the task."""
        return load_family(self.family, directories).with_knowledge(self.knowledge, directories)


class ValidationConfig(Closed):
    """Validation at checkpoints, on scenarios that are not used for learning."""

    scenarios: Scenarios = 16
    """Scenarios of each family."""
    every: Count = 1
    """Checkpoints from one measurement to the next."""


class PpoConfig(Closed):
    """Hyper-parameters of PPO (Schulman et al. 2017, doi:10.48550/arXiv.1707.06347).

    Stable-Baselines3 has further ones, which stay as they are there.
    """

    steps: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 64
    """Decisions of each row between two updates."""
    minibatch: Count = 4096
    """Decisions of one gradient step."""
    epochs: Annotated[int, Field(strict=True, ge=1, le=1000)] = 4
    """Number of passes over all decisions of an update."""
    learning_rate: Positive = 3e-4
    """Step size of Adam at the beginning; it falls linearly to a tenth [-]."""
    running: tuple[Name, ...] = ()
    """Goals whose options have a say only while their behaviour runs, as ways to explore: only decisions in whose
    period it ran are learned from. What the others bring is that of the last one that counted."""
    holds: dict[Name, Count] = Field(default_factory=dict)
    """Goal -> decision periods for which a robot keeps an option; 1 for goals that are not named."""
    start: dict[Name, Name] = Field(default_factory=dict)
    """Goal -> the option that is likeliest at the beginning; all are equally likely for goals that are not named."""
    lead: Positive = 2.0
    """Output by which it is ahead of the others."""
    discount: Share = 0.98
    """Weight of a reward one decision period later [-]."""
    entropy: NonNegative = 0.01
    """Weight of the entropy, which keeps all options in use [-]."""
    plays: Literal["sampled", "likeliest"] = "sampled"
    """How the policy takes options after training: with their probabilities, as it does while it learns, or always the
    likeliest."""
    hidden: Annotated[tuple[Annotated[int, Field(strict=True, ge=1, le=4096)], ...], Field(max_length=10)] = (64, 64)
    """Widths of the hidden layers, of policy and value function alike; an observation has some tens of components."""


class CreditConfig(Closed):
    """The rewards that count for a decision of a bandit, and the time for which its option is held."""

    hold: NonNegative = 10.0
    """Longest time for which a row keeps its option [s]; 0: one decision for a whole mission."""
    until: tuple[Name, ...] = ()
    """Components of the observation whose change ends this time."""
    horizon: Positive = 30.0
    """Time after the decision over which rewards count [s]."""
    discount: Share = 0.95
    """Weight of a reward one second later [-]."""


class BanditConfig(Closed):
    """A strategy that learns from the rewards that follow its choices."""

    strategy: StrategySpec
    """The strategy with its parameters."""
    context: tuple[Name, ...] = ()
    """Components of the observation that are its context."""
    credit: CreditConfig = CreditConfig()
    """Rewards that count."""
    exported: dict[Name, Any] = Field(default_factory=dict)
    """Parameters that the strategy gets after learning, for instance to stop exploring."""

    @model_validator(mode="after")
    def _exists(self) -> Self:
        self.learned  # noqa: B018  (a mistake in the parameters is an error when the file is read)
        return self

    @property
    def learned(self) -> StrategySpec:
        """The strategy after learning."""
        spec = self.strategy
        return StrategySpec(name=spec.name, parameters={**spec.parameters, **self.exported}, sharing=spec.sharing)


class MembersConfig(Closed):
    """Learning from whole missions of the members of a population."""

    opening: Scenarios = 4
    """Scenarios of each family that every option alone does first."""


class EsConfig(MembersConfig):
    """Evolution strategies: members are linear policies about a point that climbs."""

    pairs: Annotated[int, Field(strict=True, ge=1, le=10_000)] = 16
    """Pairs of members; the two of a pair are opposite to each other."""
    scenarios: Scenarios = 1
    """Scenarios of each family that all members of a generation do."""
    sigma: Positive = 0.4
    """Standard deviation of the parameters of members [-]."""
    learning_rate: Positive = 0.12
    """Step size of Adam [-]."""
    limit: Positive = 0.5
    """Largest absolute fitness: a failed mission counts as one that costs so much more, in logarithms [-]."""
    lead: Positive = 2.0
    """Output by which the best option alone is ahead of the others at the beginning [-]."""
    averaged: Annotated[float, Field(strict=True, ge=0.0, lt=1.0)] = 0.9
    """Weight of the old mean in the running mean that is exported [-]."""


MachineSize = Annotated[int, Field(strict=True, ge=1, le=MOST_STATES)]


class DesignConfig(MembersConfig):
    """Automatic design of finite state machines by iterated races."""

    states: MachineSize = 4
    """Most states of a machine."""
    transitions: MachineSize = 4
    """Most transitions of a state."""
    candidates: Annotated[int, Field(strict=True, ge=1, le=10_000)] = 20
    """New machines of each race; those that are equal to others are left out."""
    fresh: Share = 0.2
    """Share of the new machines that are drawn at random; the others are varied best ones. 1: random search."""
    kept: Annotated[int, Field(strict=True, ge=1, le=1000)] = 4
    """Best machines that go on to the next race."""
    race: RaceConfig = RaceConfig(block=4, blocks=5)
    """The race; scenarios are counted for each family."""


class TrainingConfig(Closed):
    """One training."""

    name: Name
    """Name of the training and of its result."""
    description: str = ""
    """What is learned, in one sentence."""
    tasks: Annotated[tuple[TaskConfig, ...], Field(min_length=1)]
    """The families to train on."""
    goal: JointName | None = None
    """Goal of which the options are learned, or several joined by `+`, each of which PPO decides for itself;
    AvoidCollision, or the only goal of missions, unless given."""
    observation: ObservationConfig = ObservationConfig()
    """Observation of each robot."""
    reward: RewardConfig | Name = RewardConfig()
    """Rewards of each robot; or `module:name` of a function of one's own, see `Batch`."""
    checkpoints: Count = 20
    """Number of checkpoints; each saves everything and resets all worlds."""
    decisions: Count = 100_000
    """Decisions of all rows from one checkpoint to the next, at least; missions for `es` and `design`, which count what
    they did beyond it."""
    validation: ValidationConfig = ValidationConfig()
    """Validation at checkpoints."""
    ppo: PpoConfig | None = None
    """Learn a policy by PPO; this or another learner."""
    bandit: BanditConfig | None = None
    """Train a strategy."""
    es: EsConfig | None = None
    """Learn a linear policy by evolution strategies."""
    design: DesignConfig | None = None
    """Design a finite state machine."""

    @model_validator(mode="after")
    def _one_learner(self) -> Self:
        given = [name for name in LEARNERS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"expected one of {', '.join(LEARNERS)}, got {', '.join(given) or 'none'}")
        return self

    @property
    def learner(self) -> str:
        """Kind of learner."""
        return next(name for name in LEARNERS if getattr(self, name) is not None)


def load_training(name: str, learner: str, directories: Sequence[Path] = ()) -> TrainingConfig:
    """Return the training of a name, in `directories` or among those that ship, or of a path to a YAML file.

    Raises:
        DocumentError: there is no such file, it has a mistake, or is a training by another learner.

    """
    config = load_file("training", name, TrainingConfig, directories)
    if config.learner != learner:
        raise DocumentError(f"{name}: expected a training by {learner}, got one by {config.learner}")
    return config
