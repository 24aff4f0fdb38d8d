"""Entrants of a comparison on a family: the deciders of the command line, with names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import FILED, FIXED, decider_named
from clean_swarm_env.deciders.unseen import decided_and_held, remarks_of, undecided
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.learning.observation.observer import Observer
from clean_swarm_env.world.task import task_class
from selector.documents.errors import within
from selector.documents.fields import JOINT
from selector.documents.trust import BASELINE
from train.analysis.verdict import RANDOM

UNTAUGHT = "has learned nothing and learns nothing; --learn, or `clean-swarm train bandit`, teaches it"
"""What is said of a strategy that could learn."""


@dataclass(frozen=True)
class Entrant:
    """One strategy with its members: one for each seed that it was trained with, or the strategy alone."""

    label: str
    members: tuple[str, ...]
    """Members as `decider_named` takes them."""

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
    that drives; + joins those of several seeds of one training to one entrant. `LABEL=...` names an entrant.
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


def check_goals(given: Sequence[str], mission: MissionConfig, directories: Sequence[Path]) -> None:
    """Raise an error of one line for a strategy that was made for goals that a mission does not let it decide."""
    for entrant in entrants_of(given, ()):
        for member in entrant.members:
            if why := undecided(decider_named(member, directories), mission, directories):
                raise ConfigurationError(f"--strategy {entrant.label}: {why}")


def check_fit(entrants: Sequence[Entrant], batch: Batch, goal: str | None, directories: Sequence[Path]) -> list[str]:
    """Return which goals strategies decide that were made for some; `goal` is the one that is asked for, None without.

    Raises:
        ValueError: a strategy does not exist, or does not fit a batch with options as actions.

    """
    teams, usual, told = np.zeros(batch.rows, dtype=np.int64), usual_terms(batch.mission), list[str]()
    models = [coordinator.model for coordinator in batch.worlds.coordinators]
    for entrant in entrants:
        for member in entrant.members:
            with within(f"--strategy {entrant.label}"):
                named = decider_named(member, directories)
                decided = DecidedGoal(batch, named.decides(goal))
                seen = Observer(batch.worlds, batch.progress, named.observation(usual)).names
                decided.check(named.build(replace(decided.problem, features=seen), teams))
        told += decided_and_held(entrant.label, named, decided.names, models)
    return told


def with_baselines(entrants: Sequence[Entrant], options: Sequence[str], mission: MissionConfig) -> list[Entrant]:
    """Return the entrants, and after them those of the task's baselines that are not among them and exist."""
    taken = {member for entrant in entrants for member in entrant.members}
    task = task_class(mission)
    leads = task.baseline and (not task.baseline_option or task.baseline_option in options)
    names = task.yardsticks or ((BASELINE,) if leads else ())
    exist = [RANDOM, BASELINE, *(f"{FIXED}:{name}" for option in options for name in option.split(JOINT))]
    return [*entrants, *(Entrant(name, (name,)) for name in names if name in exist and name not in taken)]


def remarks_on(
    entrants: Sequence[Entrant],
    batch: Batch,
    goal: str | None = None,
    directories: Sequence[Path] = (),
    missions: Sequence[MissionConfig] = (),
) -> list[str]:
    """Return which options of a batch strategies never take.

    And what of `missions` (unless given, that of the batch) policies never saw, and which strategies could learn, but
    have learned nothing.
    """
    told = []
    for entrant in entrants:
        named = decider_named(entrant.members[0], directories)
        decided = DecidedGoal(batch, named.decides(goal))
        parts = decided.parts if named.knows else ()
        missing = [option for options in parts for option in options if option not in named.knows]
        if missing:
            told.append(f"{entrant.label}: never takes {', '.join(missing)}, which it was trained without")
        told += remarks_of(entrant.label, named, missions or [batch.mission], directories)
        if named.learns:
            told.append(f"{entrant.label}: {UNTAUGHT}")
    return told
