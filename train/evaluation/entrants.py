"""Entrants of a comparison on a family: fixed options, a rule made by hand, learned strategies, trained policies."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.errors import validated
from selector.documents.find import find_file
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec, spec_from_text
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from selforg.registry import unknown
from train.running.pilots import Pilot, PolicyPilot, RulePilot, StrategyPilot, columns_of

FIXED, RULE, POLICY, LEARNED = "fixed", "rule", "policy", "learned"

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

    `learned:NAME` (the file of a strategy) and `policy:NAME` take names or paths; + joins those of several seeds of one
    training to one entrant. `LABEL=...` names an entrant.
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
        several = kind in (POLICY, LEARNED)
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
    if kind == POLICY:
        return PolicyPilot(load_policy(find_policy(name, directories)), problem)
    if member == RULE:
        return _by_hand(problem, len(teams))
    features: tuple[str, ...] = ()
    if kind == LEARNED:
        file = find_file("strategies", name, directories)
        description = description_of(file)
        spec, features = description.spec, description.features
    else:
        spec = spec_of(member)
    columns = columns_of(problem, features, f"strategy {spec.name}")
    keys = row_keys(np.random.SeedSequence(0), len(teams))
    strategy = spec.build(replace(problem, features=features), keys, teams, directories)
    if kind == LEARNED:
        load_strategy(file, strategy)
    return StrategyPilot(strategy, columns)


def spec_of(member: str) -> StrategySpec:
    """Return the strategy of a member that needs no observation and no file.

    Raises:
        DocumentError: there is no such strategy, or the member is of another kind.

    """
    kind, _, name = member.partition(":")
    if kind == FIXED:
        return validated(StrategySpec, {"name": "Fixed", "parameters": {"option": name}}, member)
    if kind in (POLICY, LEARNED) or member == RULE:
        raise ConfigurationError(f"--learn: {member}: expected a strategy that chooses once in a mission")
    return spec_from_text(member)


def identified(member: str, directories: Sequence[Path] = ()) -> str:
    """Return a member that names a file with a digest of the file: another training is another member."""
    kind, _, name = member.partition(":")
    if kind == POLICY:
        return f"{member} sha256:{load_policy(find_policy(name, directories)).spec.weights_sha256}"
    if kind == LEARNED:
        return f"{member} sha256:{hashlib.sha256(find_file('strategies', name, directories).read_bytes()).hexdigest()}"
    return member


def _by_hand(problem: Problem, rows: int) -> RulePilot:
    """Return the pilot of the rule made by hand, the best one found for many robots in little space."""
    for option in SITUATIONS.values():
        if option not in problem.options:
            raise ConfigurationError(unknown("option", option, problem.options))
    options = np.array([problem.options.index(name) for name in SITUATIONS.values()], dtype=np.int64)
    return RulePilot(problem, tuple(SITUATIONS), np.tile(options, (rows, 1)))
