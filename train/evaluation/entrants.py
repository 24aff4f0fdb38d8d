"""What can be compared on a family: fixed options, a rule by hand, learned strategies and trained policies, by name."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from selector.strategies.learned_file import features_of, find_strategy, load_strategy, spec_of
from selector.strategies.policy_file import find_policy, load_policy
from selector.strategies.problem import Ints, Problem
from selector.strategies.registry import StrategySpec, spec_from_text
from selector.strategies.streams import row_keys
from selforg.registry import unknown
from train.running.rule_pilot import RulePilot
from train.running.trials import Pilot, PolicyPilot, StrategyPilot

FIXED, RULE, POLICY, LEARNED = "fixed", "rule", "policy", "learned"

SITUATIONS = {
    "free_far": "RepulsionFernandez-view1.5",
    "free_near": "RepulsionFernandez-view1.5",
    "carrying_far": "RepulsionGradient-from0.25",
    "carrying_near": "RepulsionFernandez-view0.5",
}
"""The rule by hand: situation -> option."""


def _by_hand(problem: Problem, rows: int) -> RulePilot:
    """Return the best rule found by hand for many robots in little space."""
    for option in SITUATIONS.values():
        if option not in problem.options:
            raise ConfigurationError(unknown("option", option, problem.options))
    options = np.array([problem.options.index(name) for name in SITUATIONS.values()], dtype=np.int64)
    return RulePilot(problem, tuple(SITUATIONS), np.tile(options, (rows, 1)))


@dataclass(frozen=True)
class Entrant:
    """One strategy; the members are what it became by training with different seeds, or itself alone."""

    label: str
    members: tuple[str, ...]
    """What each of them is, in words of `member_pilot`."""

    @property
    def fixed(self) -> bool:
        """Whether it is one option, whatever happens."""
        return self.label.startswith(f"{FIXED}:")


def entrants_of(given: Sequence[str], options: Sequence[str]) -> list[Entrant]:
    """Return what the words of the command line name; `fixed` is every option.

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


def member_pilot(member: str, problem: Problem, teams: Ints) -> Pilot:
    """Return what decides as `member` says, for rows of `teams` (R,); `problem` has all components of the observation.

    Raises DocumentError if it does not exist or does not fit the problem.
    """
    kind, _, name = member.partition(":")
    if kind == POLICY:
        return PolicyPilot(load_policy(find_policy(name)), problem)
    if kind == LEARNED:
        path = find_strategy(name)
        return _strategy_pilot(spec_of(path), problem, teams, features_of(path), path)
    if kind == FIXED:
        return _strategy_pilot(StrategySpec(name="Fixed", parameters={"option": name}), problem, teams, ())
    if member == RULE:
        return _by_hand(problem, len(teams))
    return _strategy_pilot(spec_from_text(member), problem, teams, ())


def identified(member: str) -> str:
    """Return a member with a digest of what was learned, if it names a file: another training is another member."""
    kind, _, name = member.partition(":")
    if kind == POLICY:
        return f"{member} sha256:{load_policy(find_policy(name)).spec.weights_sha256}"
    if kind == LEARNED:
        return f"{member} sha256:{hashlib.sha256(find_strategy(name).read_bytes()).hexdigest()}"
    return member


def _strategy_pilot(
    spec: StrategySpec, problem: Problem, teams: Ints, features: tuple[str, ...], learned: Path | None = None
) -> StrategyPilot:
    own = Problem(problem.goal, problem.options, problem.scores, features)
    for name in features:
        if name not in problem.features:
            raise ConfigurationError(f"strategy {spec.name}: feature {name!r} is not in the observation")
    strategy = spec.build(own, row_keys(np.random.SeedSequence(0), len(teams)), teams)
    if learned is not None:
        load_strategy(learned, strategy)
    return StrategyPilot(strategy, np.array([problem.features.index(name) for name in features], dtype=np.int64))
