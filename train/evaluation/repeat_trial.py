"""Repetition of single runs of a strategy on a family; each runs alone and has the course that it had in its batch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig, place_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission_end import RUNNING
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import validated, within
from selector.documents.plain import short
from train.deciders.decided_goal import DecidedGoal
from train.deciders.named import decider_named
from train.evaluation.entrants import Entrant
from train.evaluation.trial_task import TrialTask
from train.running.finished_runs import JOURNAL, runs_of
from train.running.run_folder import MANIFEST
from train.running.runs import under

DIGEST = " sha256:"
"""What follows a member that names a file in the manifest."""


def family_tasks(identity: Mapping[str, Any], directories: tuple[Path, ...], directory: Path) -> list[TrialTask]:
    """Return a task for each finished run in a directory, in their order there.

    Raises:
        ConfigurationError: a mistake in the manifest, no finished run, or a policy or strategy that has changed since.

    """
    path = directory / MANIFEST
    members = dict(_members(identity.get("strategies"), directories, path))
    runs = _runs(identity["family"], members, f"{path}: identity.family")
    seed, goal = evaluation_seed(identity, path), str(identity.get("goal"))
    tasks = []
    for scenario, condition in (record.key for record in runs_of(directory / JOURNAL)):
        if condition not in runs:
            raise ConfigurationError(f"{path}: identity.strategies: expected the run {condition!r} among them")
        family, member = runs[condition]
        with within(f"{directory / JOURNAL}"):
            place = place_of(scenario)
        tasks.append(TrialTask(family, seed, (place,), condition, member, goal, directories))
    if not tasks:
        raise ConfigurationError(f"{directory}: holds no finished run")
    return tasks


def trial_steps(task: TrialTask) -> Iterator[Worlds]:
    """Repeat a run with networks that note their reasons; yield the world after each control period."""
    scenarios, settings = iter((task.scenario_of(task.places[0]),)), task.settings
    batch = Batch(
        task.mission,
        source=lambda _: next(scenarios, None),
        directories=task.directories,
        explained=True,
        observation=settings.observation,
        action=settings.action,
    )
    decided = DecidedGoal(batch, settings.goal)
    decider = task.decider(decided.problem, np.zeros(batch.robots, dtype=np.int64))
    observations = batch.reset()
    decider.reset(batch.worlds.rows_of(0), task.mission_seed)
    while batch.progress.outcome[0] == RUNNING:
        yield from batch.ticks(decided.decide(decider, observations))
        if batch.progress.outcome[0] == RUNNING:
            observations = batch.end_period().observations


def evaluation_seed(identity: Mapping[str, Any], path: Path) -> int:
    """Return the seed of an evaluation."""
    seed = identity.get("seed")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise ConfigurationError(f"{path}: identity.seed: expected a whole number from 0 on, got {short(seed)}")
    return seed


def _runs(held: object, members: Mapping[str, str], where: str) -> dict[str, tuple[FamilyConfig, str]]:
    """Return family and member of each condition; with disturbances, of each condition under each."""
    family = held_family(held, list(members), where)
    if not isinstance(family, RobustnessConfig):
        return {condition: (family, member) for condition, member in members.items()}
    return {
        under(name, condition): (disturbed, member)
        for name, disturbed in family.disturbed.items()
        for condition, member in members.items()
    }


def held_family(held: object, labels: Sequence[str], where: str) -> FamilyConfig:
    """Return the family of a manifest, with disturbances and the `labels` of strategies where it has them."""
    if isinstance(held, dict) and "disturbances" in held:
        return validated(RobustnessConfig, held | {"strategies": list(labels)}, where)
    return validated(FamilyConfig, held, where)


def _members(strategies: object, directories: tuple[Path, ...], path: Path) -> Iterator[tuple[str, str]]:
    """Yield condition and member of each strategy."""
    for entrant, then in held_entrants(strategies, path):
        for condition, member, held in zip(entrant.conditions, entrant.members, then, strict=True):
            if decider_named(member, directories).identity != held:
                raise ConfigurationError(
                    f"{path}: {member} is no longer what the evaluation ran with; its runs cannot be repeated"
                )
            yield condition, member


def held_entrants(strategies: object, path: Path) -> Iterator[tuple[Entrant, list[str]]]:
    """Yield the entrants of a manifest, each with its members and their digests."""
    if not isinstance(strategies, dict):
        raise ConfigurationError(f"{path}: identity.strategies: expected a mapping, got {short(strategies)}")
    for label, held in strategies.items():
        if not (isinstance(held, list) and all(isinstance(member, str) for member in held)):
            raise ConfigurationError(f"{path}: identity.strategies.{label}: expected texts, got {short(held)}")
        yield Entrant(label, tuple(member.partition(DIGEST)[0] for member in held)), held
