"""Entrants of a comparison on a family: fixed options, a rule made by hand, learned strategies, trained policies."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.learning.actions import ActionConfig, Mode
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.observer import Observer
from selector.documents.arrays import check_known
from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import JOINT
from selector.documents.find import find_file
from selector.documents.imported import is_import
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.machine_file import load_machine
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec, named, named_in, spec_from_text
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from selforg.registry import unknown
from train.running.decided_goal import option_named
from train.running.machine_pilot import MachinePilot
from train.running.model_pilots import LOADERS, ModelPilot, VectorPilot
from train.running.pilots import AnyPilot, Pilot, PolicyPilot, RulePilot, StrategyPilot, columns_of, policy_pilot

FIXED, RULE, POLICY, LEARNED, MACHINE, VELOCITY = "fixed", "rule", "policy", "learned", "fsm", "velocity"
FILED = (POLICY, LEARNED, MACHINE, VELOCITY)
"""Kinds of strategies that name a file."""
NEVER_AVOIDING, RANDOM = f"{FIXED}:Off", "Random"
"""What every strategy has to beat: never to avoid, and any option in each decision period."""

SITUATIONS = {
    "free_far": "RepulsionFernandez-view1.5",
    "free_near": "RepulsionFernandez-view1.5",
    "carrying_far": "RepulsionGradient-from0.25",
    "carrying_near": "RepulsionFernandez-view0.5",
}
"""The rule made by hand: situation -> option."""


@dataclass(frozen=True)
class Entrant:
    """One strategy with its members: one for each seed that it was trained with, or the strategy alone."""

    label: str
    members: tuple[str, ...]
    """Members as `member_pilot` takes them."""

    @property
    def fixed(self) -> bool:
        """Whether the strategy always takes the same option."""
        return self.label.startswith(f"{FIXED}:")

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions under which the runs of the members are kept."""
        several = len(self.members) > 1
        return tuple(f"{self.label}#{k + 1}" if several else self.label for k in range(len(self.members)))


def entrants_of(given: Sequence[str], options: Sequence[str]) -> list[Entrant]:
    """Return the entrants of the command line; `fixed` stands for one entrant for each option.

    `learned:NAME` (the file of a strategy), `policy:NAME` and `fsm:NAME` take names or paths, `velocity:FILE` a model
    that steers; + joins those of several seeds of one training to one entrant. `LABEL=...` names an entrant.
    """
    found: list[Entrant] = []
    for text in given:
        label, equals, rest = text.partition("=")
        if not equals or ":" in label:
            label, rest = text, text
        if rest == FIXED:
            found += [Entrant(f"{FIXED}:{option}", (f"{FIXED}:{option}",)) for option in options]
            continue
        kind, _, names = rest.partition(":")
        several = kind in FILED
        members = tuple(f"{kind}:{name}" for name in names.split("+")) if several else (rest,)
        found.append(Entrant(kind if several and label == text and "+" in names else label, members))
    labels = [entrant.label for entrant in found]
    for label in labels:
        if labels.count(label) > 1:
            raise ConfigurationError(f"--strategy: {label!r} is given twice; LABEL=... gives it another name")
    return found


def member_pilot(member: str, problem: Problem, teams: Ints, directories: Sequence[Path] = ()) -> Pilot:
    """Return the pilot of a member for rows of `teams` (R,); `problem` has all components of the observation.

    Policies and strategies are searched in `directories` before the shipped directory.

    Raises:
        DocumentError: the member does not exist or does not fit the problem.

    """
    kind, _, name = member.partition(":")
    if action_of(member, directories).mode != "option":
        raise ConfigurationError(f"{member}: expected a strategy that chooses options, got one that steers or corrects")
    if kind == POLICY and Path(name).suffix in LOADERS:
        return ModelPilot(Path(name), problem)
    if kind == POLICY:
        return PolicyPilot(load_policy(find_policy(name, directories)), problem)
    if kind == MACHINE:
        return MachinePilot(load_machine(name, directories), problem, len(teams))
    if member == RULE:
        return _by_hand(problem, len(teams))
    features: tuple[str, ...] = ()
    known = problem
    if kind == LEARNED:
        file = find_file("strategies", name, directories)
        description = description_of(file)
        check_known(shown(file), "options", problem.options, description.options)
        spec, features, known = description.spec, description.features, problem.only(description.options)
    else:
        spec = spec_of(f"{FIXED}:{option_named(problem, name)}" if kind == FIXED else member)
    columns = columns_of(problem, features, f"strategy {spec.name}")
    keys = row_keys(np.random.SeedSequence(0), len(teams))
    strategy = spec.build(replace(known, features=features), keys, teams, directories)
    if kind == LEARNED:
        load_strategy(file, strategy)
    return StrategyPilot(strategy, columns, problem)


def action_of(member: str, directories: Sequence[Path] = ()) -> ActionConfig:
    """Return what a member gives: options, movement vectors, or options and corrections."""
    kind, _, name = member.partition(":")
    if kind != POLICY or Path(name).suffix in LOADERS:
        return ActionConfig(mode="velocity" if kind == VELOCITY else "option")
    spec = load_policy(find_policy(name, directories)).spec
    mode: Mode = "velocity" if not spec.options else "both" if spec.vector else "option"
    return ActionConfig(mode=mode, patience=spec.patience)


def any_pilot(member: str, problem: Problem, teams: Ints, directories: Sequence[Path] = ()) -> AnyPilot:
    """Return the pilot of a member, also of one that steers or corrects; see `member_pilot`."""
    kind, _, name = member.partition(":")
    if kind == VELOCITY:
        return VectorPilot.of_file(Path(name), len(problem.features))
    if kind == POLICY and Path(name).suffix not in LOADERS:
        return policy_pilot(load_policy(find_policy(name, directories)), problem)
    return member_pilot(member, problem, teams, directories)


def check_fit(
    entrants: Sequence[Entrant], batch: Batch, terms: Sequence[str], problem: Problem, directories: Sequence[Path]
) -> None:
    """Raise an error of one line for a strategy that does not exist or does not fit a batch with options as actions.

    `terms` are those of the observation beside the default ones.
    """
    teams, without = np.zeros(batch.rows, dtype=np.int64), ObservationConfig.usual(terms, steered=True)
    steered = replace(problem, features=Observer(batch.worlds, batch.progress, without).names)
    for entrant in entrants:
        for member in entrant.members:
            try:
                seen = steered if action_of(member, directories).mode == "velocity" else problem
                any_pilot(member, seen, teams, directories)
            except DocumentError as error:
                raise DocumentError(f"--strategy {entrant.label}: {error}") from error


def with_baselines(entrants: Sequence[Entrant], options: Sequence[str]) -> list[Entrant]:
    """Return the entrants, and after them those of `NEVER_AVOIDING` and `RANDOM` that are not among them and exist."""
    taken = {member for entrant in entrants for member in entrant.members}
    exist = [RANDOM, *(f"{FIXED}:{name}" for option in options for name in option.split(JOINT))]
    return [
        *entrants,
        *(Entrant(name, (name,)) for name in (NEVER_AVOIDING, RANDOM) if name in exist and name not in taken),
    ]


def never_taken(
    entrants: Sequence[Entrant], options: Sequence[str], directories: Sequence[Path] = ()
) -> dict[str, list[str]]:
    """Return the options that were not there when a strategy was trained, by the labels of such strategies."""
    found = {}
    for entrant in entrants:
        kind, _, name = entrant.members[0].partition(":")
        if kind == POLICY and Path(name).suffix not in LOADERS:
            known = load_policy(find_policy(name, directories)).spec.options
        elif kind == LEARNED:
            known = description_of(find_file("strategies", name, directories)).options
        else:
            continue
        found[entrant.label] = [option for option in options if known and option not in known]
    return {label: missing for label, missing in found.items() if missing}


def unlearned(entrants: Sequence[Entrant]) -> list[str]:
    """Return the labels of strategies that could learn, but have learned nothing and do not in an evaluation."""
    kinds = (*FILED, FIXED, RULE)
    own = {entrant.label: named_in(entrant.members[0])[0] for entrant in entrants}
    return [
        label
        for label, name in own.items()
        if name.partition(":")[0] not in kinds and named(name)._update is not DecisionStrategy._update
    ]


def spec_of(member: str) -> StrategySpec:
    """Return the strategy of a member that needs no observation and no file.

    Raises:
        DocumentError: there is no such strategy, or the member is of another kind.

    """
    kind, _, name = member.partition(":")
    if kind == FIXED:
        return validated(StrategySpec, {"name": "Fixed", "parameters": {"option": name}}, member)
    if kind in FILED or member == RULE:
        raise ConfigurationError(f"--learn: {member}: expected a strategy that chooses once in a mission")
    return spec_from_text(member)


def identified(member: str, directories: Sequence[Path] = ()) -> str:
    """Return a member that names a file with a digest of the file: another training is another member."""
    kind, _, name = member.partition(":")
    own, _ = named_in(member)
    if kind == VELOCITY or (kind == POLICY and Path(name).suffix in LOADERS):
        files = [path for path in (Path(name), Path(name).with_suffix(".pkl")) if path.is_file()]
        return f"{member} sha256:{hashlib.sha256(b''.join(path.read_bytes() for path in files)).hexdigest()}"
    if kind not in (*FILED, FIXED) and is_import(own):
        source = Path(inspect.getfile(named(own)))
        return f"{member} sha256:{hashlib.sha256(source.read_bytes()).hexdigest()}"
    if kind == POLICY:
        return f"{member} sha256:{load_policy(find_policy(name, directories)).spec.weights_sha256}"
    if kind in (LEARNED, MACHINE):
        file = find_file({LEARNED: "strategies", MACHINE: "machines"}[kind], name, directories)
        return f"{member} sha256:{hashlib.sha256(file.read_bytes()).hexdigest()}"
    return member


def _by_hand(problem: Problem, rows: int) -> RulePilot:
    """Return the pilot of the rule made by hand, the best one found for many robots in little space."""
    for option in SITUATIONS.values():
        if option not in problem.options:
            raise ConfigurationError(unknown("option", option, problem.options))
    options = np.array([problem.options.index(name) for name in SITUATIONS.values()], dtype=np.int64)
    return RulePilot(problem, tuple(SITUATIONS), np.tile(options, (rows, 1)))
