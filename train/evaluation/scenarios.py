"""Scenarios of families and experiments, and the tasks of an experiment."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig, Scenario, Split, place_of
from clean_swarm_env.config.starts import for_start, run_seed
from clean_swarm_env.deciders.named import decider_named
from train.running.runs import RunKey
from train.running.trial_task import TrialTask


def scenario_named(family: FamilyConfig, seed: int, name: str) -> Scenario:
    """Return the scenario of a family with a name such as `test-3`; DocumentError if there is none."""
    index, world = place_of(name)
    split: Split = "train" if name.startswith("train") else "test"
    return family.scenario(seed, index, split, world)


def experiment_tasks(
    experiment: ExperimentConfig,
    seed: int,
    directories: tuple[Path, ...] = (),
    goal: str = "",
    done: Collection[RunKey] = (),
) -> list[TrialTask]:
    """Return tasks for every condition on every start that is not `done`; ConfigurationError for one that does not fit.

    `goal` is what strategies decide that were made for none.
    """
    found = []
    for condition in experiment.conditions:
        mission, member = experiment.under(condition), condition.strategy
        made = decider_named(member, directories).goals
        drawn = [
            Scenario(start.id, run_seed(seed, start.id), for_start(mission, start), start)
            for start in experiment.starts
            if (start.id, condition.name) not in done
        ]
        own = (experiment.name, seed, tuple(drawn), condition.name, member, "" if made else goal)
        found += TrialTask(*own, directories=directories).parts()
    return found


def variants_of(family: FamilyConfig) -> Mapping[str, FamilyConfig]:
    """Return the families under which strategies run, by name: with each disturbance, or only itself without a name."""
    return family.disturbed if isinstance(family, RobustnessConfig) else {"": family}
