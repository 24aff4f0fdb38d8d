"""Conditions of the command line: strategies with labels, and whether they fit a mission."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import FIXED, decider_named, without_digest
from clean_swarm_env.deciders.unseen import decided_and_held, remarks_of, undecided
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.learning.observation.observer import Observer
from clean_swarm_env.world.task import task_class
from selector.documents.fields import JOINT, checked_name
from selector.documents.trust import BASELINE, FILED_KINDS
from train.analysis.verdict import RANDOM
from train.evaluation.comparison import Deciders

UNTAUGHT = "has learned nothing and learns nothing; --learn, or `clean-swarm train bandit`, teaches it"
"""What is said of a strategy that could learn."""


def label_and_members(text: str) -> tuple[str | None, tuple[str, ...]]:
    """Return the label of a strategy, None without one, and what decides.

    `LABEL=...` names it; + joins files of several seeds of one training.
    """
    label, equals, rest = text.partition("=")
    if not equals or ":" in label:
        label, rest = "", text
    kind, _, names = rest.partition(":")
    filed = kind in FILED_KINDS and kind != FIXED
    members = tuple(f"{kind}:{name}" for name in names.split("+")) if filed else (rest,)
    return (label if rest != text else None), members


def conditions_of(strategies: Sequence[str], options: Sequence[str]) -> dict[str, Deciders]:
    """Return the conditions of the command line by label; `fixed` stands for one for each option.

    `learned:NAME` (the file of a strategy), `policy:NAME` and `fsm:NAME` take names or paths, `velocity:FILE` a model
    that drives; + joins those of several seeds of one training to one condition. `LABEL=...` names a condition.
    """
    found: list[tuple[str, tuple[str, ...]]] = []
    for text in strategies:
        label, members = label_and_members(text)
        if label is not None:
            checked_name(label, f"--strategy {text}: label")
        if members == (FIXED,):
            found += [(f"{FIXED}:{option}", (f"{FIXED}:{option}",)) for option in options]
        else:
            found.append((label or (text if len(members) == 1 else text.partition(":")[0]), members))
    labels = [label for label, _ in found]
    for label in labels:
        if labels.count(label) > 1:
            raise ConfigurationError(f"--strategy: {label!r} is given twice; LABEL=... gives it another name")
    return {label: Deciders(members=members) for label, members in found}


def check_goals(strategies: Sequence[str], mission: MissionConfig, directories: Sequence[Path]) -> None:
    """Raise an error of one line for a strategy that was made for goals that a mission does not let it decide."""
    for label, condition in conditions_of(strategies, ()).items():
        for member in condition.members:
            if why := undecided(decider_named(member, directories), mission, directories):
                raise ConfigurationError(f"--strategy {label}: {why}")


def check_fit(
    label: str,
    condition: Deciders,
    batch: Batch,
    goal: str | None,
    directories: Sequence[Path],
    *,
    asked: bool = True,
) -> list[str]:
    """Return which goals a condition decides that was made for some.

    Those decide the `goal`, too, if it is `asked` for; None: the usual one.

    Raises:
        ValueError: a member does not exist, or does not fit a batch with options as actions.

    """
    teams, usual, told = np.zeros(batch.rows, dtype=np.int64), usual_terms(batch.mission), list[str]()
    models = [coordinator.model for coordinator in batch.worlds.coordinators]
    for member in condition.members:
        named = decider_named(member, directories)
        decided = DecidedGoal(batch, named.decides(goal if asked or not named.goals else None))
        seen = Observer(batch.worlds, batch.progress, named.observation(usual)).names
        decided.check(named.build(replace(decided.problem, features=seen), teams))
        told += decided_and_held(label, named, decided.names, models)
    return told


def with_baselines(
    conditions: Mapping[str, Deciders], options: Sequence[str], mission: MissionConfig
) -> dict[str, Deciders]:
    """Return the conditions, and after them those of the task's baselines that are not among them and exist."""
    taken = {member for condition in conditions.values() for member in condition.members}
    task = task_class(mission)
    leads = task.baseline and (not task.baseline_option or task.baseline_option in options)
    names = task.yardsticks or ((BASELINE,) if leads else ())
    for name in conditions.keys() & {*names}:
        if name not in taken:
            raise ConfigurationError(f"--strategy {name}=...: expected another label, since a baseline has this one")
    exist = [RANDOM, BASELINE, *(f"{FIXED}:{name}" for option in options for name in option.split(JOINT))]
    return {**conditions, **{name: Deciders(members=(name,)) for name in names if name in exist and name not in taken}}


def remarks_on(
    conditions: Mapping[str, Deciders],
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
    for label, condition in conditions.items():
        named = decider_named(without_digest(condition.members[0]), directories)
        decided = DecidedGoal(batch, named.decides(goal))
        parts = decided.parts if named.knows else ()
        missing = [option for options in parts for option in options if option not in named.knows]
        if missing:
            told.append(f"{label}: never takes {', '.join(missing)}, which it was trained without")
        told += remarks_of(label, named, missions or [batch.mission], directories)
        if named.learns:
            told.append(f"{label}: {UNTAUGHT}")
    return told
