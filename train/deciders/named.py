"""How a text names a decider: `fixed:OPTION`, `fsm:NAME`, `policy:NAME`, `learned:NAME`, `velocity:FILE`, ...

Alone stand the names of strategies, and `baseline`. A kind knows all that can be known of a decider before there are
robots: what it sees and gives, for what it was trained, what it would do. `policy:` and `velocity:` take files of other
libraries, too.
"""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.observation.config import TRUE_TERMS, ObservationConfig
from selector.documents.arrays import check_known
from selector.documents.errors import shown, validated
from selector.documents.find import find_file
from selector.documents.imported import is_import, source_of
from selector.documents.trust import BASELINE, FILED_KINDS
from selector.strategies.learned_file import LearnedDescription, description_of, load_strategy
from selector.strategies.machine_file import load_machine
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec, named, named_in, spec_from_text
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from train.deciders.decided_goal import option_named
from train.deciders.decider import BaselineDecider, Decider, columns_of, mode_of
from train.deciders.machine import MachineDecider
from train.deciders.models import LOADERS, ModelDecider, remembered
from train.deciders.policy import PolicyDecider
from train.deciders.strategies import StrategyDecider

FIXED, POLICY, LEARNED, MACHINE, VELOCITY = FILED_KINDS
FILED = (POLICY, LEARNED, MACHINE, VELOCITY)
"""Kinds of deciders that name a file."""


class NamedDecider(ABC):
    """A decider as a text names it.

    Args:
        text: the whole text.
        directories: of the user's configurations, searched before the shipped one.

    Attributes:
        name: the text after the kind.
        mode: what it gives: options, movement vectors, or both.
        goal: the goal whose options it chooses, whatever is asked; empty if that which is asked for.
        meant_for: the goal that it was made for; empty if any.
        trained_with: names of the components of an observation that it was trained with; none if it takes any.
        knows: names of the options that it was trained with; none if it knows all.
        learns: whether it is a strategy that could learn, and has learned nothing.

    """

    mode: Mode = "option"
    goal = ""
    meant_for = ""
    trained_with: tuple[str, ...] = ()
    knows: tuple[str, ...] = ()
    learns = False

    def __init__(self, text: str, directories: Sequence[Path] = ()) -> None:
        self.text, self.directories, self.name = text, directories, text.partition(":")[2]

    @property
    def identity(self) -> str:
        """The text with a digest of what it names, if that is a file: another training is another decider."""
        digest = self.digest()
        return f"{self.text} sha256:{digest}" if digest else self.text

    def digest(self) -> str:
        """Return the digest of the file that is named; empty without one."""
        return ""

    def observation(self, terms: Sequence[str]) -> ObservationConfig:
        """Return what it sees: the default terms, `terms`, and what is true if it was trained with that."""
        true = [term for term in TRUE_TERMS if any(component.startswith(term) for component in self.trained_with)]
        return ObservationConfig().beside((*terms, *true), driven=self.mode == "velocity")

    def spec(self) -> StrategySpec:
        """Return the strategy, if it is one that needs no observation and no file; else ConfigurationError."""
        raise ConfigurationError(f"--learn: {self.text}: expected a strategy that chooses once in a mission")

    @abstractmethod
    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider for rows of `teams` (R,); `problem` has all components of the observation.

        Raises:
            DocumentError: it does not exist, or does not fit the problem.

        """


class NamedStrategy(NamedDecider):
    """A registered strategy, or one of the user's own, with parameters."""

    @property
    def learns(self) -> bool:  # type: ignore[override]
        """Whether it could learn."""
        return named(named_in(self.text)[0]).can_learn()

    def digest(self) -> str:
        """Return the digest of the source of the user's own class."""
        own, _ = named_in(self.text)
        return _sha256(source_of(own, "strategy")) if is_import(own) else ""

    def spec(self) -> StrategySpec:
        """Return the strategy."""
        return spec_from_text(self.text)

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        return _decider_by(self.spec(), problem, teams)


class NamedOption(NamedDecider):
    """Always the same option."""

    def spec(self) -> StrategySpec:
        """Return the strategy."""
        return self._fixed(self.name)

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; of the options joined for several goals, the best that has the named ones."""
        return _decider_by(self._fixed(option_named(problem, self.name)), problem, teams)

    def _fixed(self, option: str) -> StrategySpec:
        return validated(StrategySpec, {"name": "Fixed", "parameters": {"option": option}}, f"{FIXED}:{option}")


class NamedLearned(NamedDecider):
    """The file of a strategy that has learned."""

    @cached_property
    def file(self) -> Path:
        """The file."""
        return find_file("strategies", self.name, self.directories)

    @cached_property
    def description(self) -> LearnedDescription:
        """What stands beside the learned arrays."""
        return description_of(self.file)

    @property
    def knows(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of the options that it has learned to choose among."""
        return self.description.options

    @property
    def meant_for(self) -> str:  # type: ignore[override]
        """The goal that it has learned for."""
        return self.description.goal

    def digest(self) -> str:
        """Return the digest of the file."""
        return _sha256(self.file)

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        description = self.description
        check_known(shown(self.file), "options", problem.options, description.options)
        known = problem.only(description.options)
        decider = _decider_by(description.spec, problem, teams, known, description.features)
        load_strategy(self.file, decider.strategy)
        return decider


class NamedMachine(NamedDecider):
    """A state machine."""

    def __init__(self, text: str, directories: Sequence[Path] = ()) -> None:
        super().__init__(text, directories)
        self._machine = load_machine(self.name, directories)
        self.meant_for = self._machine.goal

    def digest(self) -> str:
        """Return the digest of the file."""
        return _sha256(find_file("machines", self.name, self.directories))

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        return MachineDecider(self._machine, problem, len(teams))


class NamedPolicy(NamedDecider):
    """An exported network."""

    def __init__(self, text: str, directories: Sequence[Path] = ()) -> None:
        super().__init__(text, directories)
        self._policy = load_policy(find_policy(self.name, directories))
        spec = self._policy.spec
        self.mode = mode_of(options=bool(spec.options), vector=spec.vector)
        self.trained_with, self.knows, self.meant_for = spec.observations, spec.options, spec.goal

    def digest(self) -> str:
        """Return the digest of the weights."""
        return self._policy.spec.weights_sha256

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        return PolicyDecider(self._policy, problem)


class NamedModel(NamedDecider):
    """A model of another library."""

    def __init__(self, text: str, directories: Sequence[Path] = ()) -> None:
        super().__init__(text, directories)
        self._path = Path(self.name)
        known = remembered(self._path)
        self.trained_with = known.observations
        self.mode = "velocity" if text.startswith(f"{VELOCITY}:") else known.mode
        self.goal = self.meant_for = known.goal if self.mode != "velocity" else ""

    def digest(self) -> str:
        """Return the digest of the model and of the normalisation beside it."""
        files = [path for path in (self._path, self._path.with_suffix(".pkl")) if path.is_file()]
        return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        return ModelDecider(self._path, problem, self.mode)


class NamedBaseline(NamedDecider):
    """The baseline of the task, with which its mechanisms are compared."""

    def spec(self) -> StrategySpec:
        """Raise ConfigurationError: a baseline has nothing to learn."""
        raise ConfigurationError(f"--learn: {BASELINE}: expected a strategy that chooses once in a mission")

    def build(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider; see `NamedDecider`."""
        return BaselineDecider(problem)


DECIDER_KINDS: dict[str, type[NamedDecider]] = {
    BASELINE: NamedBaseline,
    FIXED: NamedOption,
    LEARNED: NamedLearned,
    MACHINE: NamedMachine,
    POLICY: NamedPolicy,
    VELOCITY: NamedModel,
}
"""Kind, which stands before a colon, or alone -> class; anything else is a strategy."""


def decider_named(text: str, directories: Sequence[Path] = ()) -> NamedDecider:
    """Return the decider that a text names; policies and strategies are searched in `directories` first.

    Raises:
        DocumentError: a policy does not exist or is damaged.

    """
    kind, _, name = text.partition(":")
    foreign = kind == POLICY and Path(name).suffix in LOADERS
    return (NamedModel if foreign else DECIDER_KINDS.get(kind, NamedStrategy))(text, directories)


def _decider_by(
    spec: StrategySpec,
    problem: Problem,
    teams: Ints,
    known: Problem | None = None,
    features: tuple[str, ...] = (),
) -> StrategyDecider:
    """Return the decider by a strategy that sees `features`, for all options or for those `known` to it."""
    columns = columns_of(problem, features, f"strategy {spec.name}")
    keys = row_keys(np.random.SeedSequence(0), len(teams))
    strategy = spec.build(replace(known or problem, features=features), keys, teams)
    return StrategyDecider(strategy, columns, problem)


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
