"""How a text names a decider: `fixed:OPTION`, `fsm:NAME`, `policy:NAME`, `learned:NAME`, `velocity:FILE`, ...

Alone stand the names of strategies, and `baseline`. `policy:` and `velocity:` take files of other libraries, too.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import AskedGoal, option_named
from clean_swarm_env.deciders.decider import BaselineDecider, Decider, DeciderMaker, mode_of
from clean_swarm_env.deciders.machines import MachineDecider
from clean_swarm_env.deciders.models import LOADERS, ModelDecider, remembered
from clean_swarm_env.deciders.models_of_robots import ByModelDecider
from clean_swarm_env.deciders.strategies import PolicyDecider, StrategyDecider
from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.observation.config import ObservationConfig
from selector.documents.errors import shown, validated
from selector.documents.fields import JOINT
from selector.documents.find import find_file
from selector.documents.imported import source_of
from selector.documents.trust import BASELINE, FILED_KINDS, is_import
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.machine_file import load_machine
from selector.strategies.policy_file import described, find_policy, load_policy
from selector.strategies.probing import check_probing
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec, named, named_in, spec_from_text
from selforg.arrays import Ints

FIXED, POLICY, LEARNED, MACHINE, VELOCITY = FILED_KINDS
BY_MODEL = "models"
"""Kind of a decider that follows one for each model of robots."""
DIGEST = " sha256:"
"""What follows the text of a decider that names a file, before the digest of the file."""


@dataclass(frozen=True)
class NamedDecider:
    """What is known of a decider before there are robots. Code that a file names does not run before it is built."""

    text: str
    """The text that names it."""
    build: DeciderMaker
    """Makes it for a problem with all components of the observation; DocumentError if it does not fit."""
    digest: str = ""
    """Digest of the file that is named; empty without one."""
    strategy: str = ""
    """Name of the strategy, if it is one that needs no observation and no file."""
    mode: Mode = "option"
    """What it gives: options, movement vectors, or both."""
    goal: str = ""
    """The goal whose options it chooses, whatever is asked; empty if that which is asked for."""
    meant_for: AskedGoal = None
    """The goals that it was made for; None if any."""
    terms: tuple[str, ...] = ()
    """Terms of the observation that it was trained with; none if its file does not say."""
    sees: Mapping[str, Any] = field(default_factory=dict)
    """The whole configuration of its observation; empty if that is the usual one of its terms."""
    further: tuple[str, ...] = ()
    """Terms of the observation that it needs beside the usual ones."""
    knows: tuple[str, ...] = ()
    """Names of the options that it was trained with; none if it knows all."""
    training: Mapping[str, Any] = field(default_factory=dict)
    """How it was trained, as its file says; empty if it does not."""
    network: Mapping[str, Any] = field(default_factory=dict)
    """The network that chooses options, for recordings; empty without one."""
    probes: int = 0
    """How many robots of a team try another option first; see `Probing`."""

    @property
    def identity(self) -> str:
        """The text with a digest of what it names, if that is a file: another training is another decider."""
        return f"{self.text}{DIGEST}{self.digest}" if self.digest else self.text

    @property
    def learns(self) -> bool:
        """Whether it is a strategy that could learn, and has learned nothing."""
        return bool(self.strategy) and named(self.strategy).can_learn()

    @property
    def goals(self) -> tuple[str, ...]:
        """The goals that it was made for; none if any."""
        made = self.goal or self.meant_for or ()
        return tuple(made.split(JOINT) if isinstance(made, str) else made)

    def decides(self, asked: str | None) -> AskedGoal:
        """Return the goals whose options it chooses if one is `asked` for, or none."""
        return self.goal or asked or self.meant_for

    def check_team(self, robots: int) -> None:
        """Raise DocumentError if more robots are to try another option than the smallest team has."""
        check_probing(self.probes, robots)

    def observation(self, usual: Sequence[str]) -> ObservationConfig:
        """Return what it sees: its own terms, or the `usual` ones of a mission and those it needs."""
        if self.sees or self.terms:
            return validated(ObservationConfig, self.sees or {"terms": self.terms}, self.text, own=True)
        further = [term for term in self.further if term not in usual]
        return ObservationConfig().of((*usual, *further), driven=self.mode == "velocity")


def without_digest(identity: str) -> str:
    """Return the text of a decider from its identity."""
    return identity.partition(DIGEST)[0]


def decider_named(text: str, directories: Sequence[Path] = ()) -> NamedDecider:
    """Return the decider that a text names; policies and strategies are searched in `directories` first.

    Raises:
        DocumentError: the file that is named does not exist or is damaged.

    """
    kind, _, name = text.partition(":")
    return DECIDERS.get(kind, _strategy)(text, name, directories)


def _by_model(text: str, name: str, directories: Sequence[Path]) -> NamedDecider:
    """Return what follows a decider for each model of robots."""
    pairs = [one.partition("=")[::2] for one in name.split(";")]
    if not all(model and own for model, own in pairs) or len(dict(pairs)) < len(pairs):
        raise ConfigurationError(f"{text}: expected models:MODEL=STRATEGY;MODEL=STRATEGY")
    each = {model: decider_named(own, directories) for model, own in pairs}
    for own in each.values():
        if own.mode != "option" or own.text == BASELINE:
            raise ConfigurationError(f"{own.text}: expected a strategy that only chooses options")
        if own.sees:
            raise ConfigurationError(f"{own.text}: expected a policy that sees terms with their usual settings")
    seen = [term for own in each.values() for term in (*own.terms, *own.further)]
    digests = [own.digest for own in each.values() if own.digest]
    return NamedDecider(
        text,
        partial(ByModelDecider, {model: own.build for model, own in each.items()}),
        hashlib.sha256("".join(digests).encode()).hexdigest() if digests else "",
        meant_for=next((own.decides(None) for own in each.values() if own.decides(None)), None),
        further=tuple(dict.fromkeys(["model", *seen])),
        probes=max(own.probes for own in each.values()),
    )


def _baseline(text: str, *_: object) -> NamedDecider:
    """Return what lets the baseline of the task command."""
    return NamedDecider(text, BaselineDecider)


def _strategy(text: str, *_: object) -> NamedDecider:
    """Return a registered strategy, or one of the user's own, with parameters."""
    own = named_in(text)[0]
    spec = None if is_import(own) else spec_from_text(text)  # a mistake is told before anything is compiled

    def build(problem: Problem, teams: Ints) -> Decider:
        return StrategyDecider(spec or spec_from_text(text), problem, teams)

    digest = _sha256(source_of(own, "strategy")) if is_import(own) else ""
    return NamedDecider(text, build, digest, own)


def _option(text: str, name: str, _: Sequence[Path]) -> NamedDecider:
    """Return what always takes the same option; of options joined for several goals, the best that has those named."""

    def build(problem: Problem, teams: Ints) -> Decider:
        spec = StrategySpec(name="Fixed", parameters={"option": option_named(problem, name)})
        return StrategyDecider(spec, problem, teams)

    return NamedDecider(text, build, strategy="Fixed")


def _learned(text: str, name: str, directories: Sequence[Path]) -> NamedDecider:
    """Return the strategy of a file, which has learned."""
    file = find_file("strategies", name, directories)
    known = description_of(file)

    def build(problem: Problem, teams: Ints) -> Decider:
        problem.check_options(f"{shown(file)}: options", known.options)
        decider = StrategyDecider(known.spec, problem, teams, known.options, known.features)
        load_strategy(file, decider.strategy)
        return decider

    return NamedDecider(text, build, _sha256(file), knows=known.options, meant_for=known.goal)


def _machine(text: str, name: str, directories: Sequence[Path]) -> NamedDecider:
    """Return a state machine."""
    machine, digest = load_machine(name, directories), _sha256(find_file("machines", name, directories))
    return NamedDecider(
        text,
        partial(MachineDecider, machine),
        digest,
        meant_for=machine.goal,
        further=machine.terms,
        probes=machine.probing.robots,
    )


def _policy(text: str, name: str, directories: Sequence[Path]) -> NamedDecider:
    """Return an exported network, or a model of another library."""
    if Path(name).suffix in LOADERS:
        return _model(text, name)
    policy = load_policy(find_policy(name, directories))
    spec = policy.spec
    return NamedDecider(
        text,
        partial(PolicyDecider, policy),
        spec.weights_sha256,
        mode=mode_of(options=bool(spec.goals), vector=spec.vector),
        meant_for=[goal for joint in spec.goals for goal in joint.split(JOINT)] or None,
        terms=spec.terms,
        sees=spec.observation,
        knows=tuple(name for options in spec.goals.values() for joint in options for name in joint.split(JOINT)),
        training=spec.training,
        network=described(policy),
        probes=spec.probing.robots,
    )


def _model(text: str, name: str, *_: object) -> NamedDecider:
    """Return a model of another library, whose digest is that of the normalisation beside it, too."""
    path = Path(name)
    if not path.name:
        raise ConfigurationError(f"{text}: expected the path of a file after the colon")
    known = remembered(path)
    mode: Mode = "velocity" if text.startswith(f"{VELOCITY}:") else known.mode
    goal = known.goal if mode != "velocity" else ""
    digest = _sha256(*(file for file in (path, path.with_suffix(".pkl")) if file.is_file()))
    return NamedDecider(text, partial(ModelDecider, path, mode), digest, mode=mode, goal=goal)


DECIDERS: dict[str, Callable[[str, str, Sequence[Path]], NamedDecider]] = {
    BASELINE: _baseline,
    BY_MODEL: _by_model,
    FIXED: _option,
    LEARNED: _learned,
    MACHINE: _machine,
    POLICY: _policy,
    VELOCITY: _model,
}
"""Kind of a decider -> function that returns it; every other text names a strategy."""


def _sha256(*files: Path) -> str:
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()
