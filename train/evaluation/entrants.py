"""Entrants of a comparison on a family: fixed options, a rule by hand, learned strategies and trained policies."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.errors import validated
from selector.strategies.learned_file import features_of, find_strategy, load_strategy, spec_of
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
"""The rule by hand: situation -> option."""


@dataclass(frozen=True)
class Entrant:
    """One strategy with its members: one for each seed that it was trained with, or the strategy alone."""

    label: str
    members: tuple[str, ...]
    """Each member in the words that `member_pilot` takes."""

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
    """Return the entrants that the words of the command line name; `fixed` is one entrant for each option.

    `learned:NAME` (a strategy's file) and `policy:NAME` take what ships by its name, else a path, and several of one
    training with + between them; `LABEL=...` gives it a name of its own.
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

    Policies and strategies are looked for in `directories`, then among those that ship.

    Raises:
        DocumentError: a member that does not exist or does not fit the problem.

    """
    kind, _, name = member.partition(":")
    if kind == POLICY:
        return PolicyPilot(load_policy(find_policy(name, directories)), problem)
    if member == RULE:
        return _by_hand(problem, len(teams))
    learned = find_strategy(name, directories) if kind == LEARNED else None
    if learned is not None:
        spec = spec_of(learned)
    elif kind == FIXED:
        spec = validated(StrategySpec, {"name": "Fixed", "parameters": {"option": name}}, member)
    else:
        spec = spec_from_text(member)
    features = features_of(learned) if learned is not None else ()
    columns = columns_of(problem, features, f"strategy {spec.name}")
    own = Problem(problem.goal, problem.options, problem.scores, features)
    strategy = spec.build(own, row_keys(np.random.SeedSequence(0), len(teams)), teams, directories)
    if learned is not None:
        load_strategy(learned, strategy)
    return StrategyPilot(strategy, columns)


def identified(member: str, directories: Sequence[Path] = ()) -> str:
    """Return a member with a digest of what was learned, if it names a file: another training is another member."""
    kind, _, name = member.partition(":")
    if kind == POLICY:
        return f"{member} sha256:{load_policy(find_policy(name, directories)).spec.weights_sha256}"
    if kind == LEARNED:
        return f"{member} sha256:{hashlib.sha256(find_strategy(name, directories).read_bytes()).hexdigest()}"
    return member


def _by_hand(problem: Problem, rows: int) -> RulePilot:
    """Return the best rule found by hand for many robots in little space."""
    for option in SITUATIONS.values():
        if option not in problem.options:
            raise ConfigurationError(unknown("option", option, problem.options))
    options = np.array([problem.options.index(name) for name in SITUATIONS.values()], dtype=np.int64)
    return RulePilot(problem, tuple(SITUATIONS), np.tile(options, (rows, 1)))
