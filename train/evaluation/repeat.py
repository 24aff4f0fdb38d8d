"""Repetition of runs of an evaluation; a run depends on the manifest only, so that a repetition is the same run."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import Decider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.recording.file import SUFFIX, blocks_of
from clean_swarm_env.recording.reader import NoFrames, RecordedMission, RecordedParts
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission import period_of
from clean_swarm_env.world.mission_end import RUNNING
from selector.documents.errors import validated, within
from selector.documents.fields import Closed, Number
from selector.documents.plain import must_know, short
from selector.documents.reading import json_lines
from selector.documents.trust import check_trust, is_import, reading_files
from selector.documents.writing import check_output, writing_to
from train.evaluation.comparison import Comparison
from train.running.finished_runs import JOURNAL, runs_of
from train.running.needs import ALONE, check_needs
from train.running.pulse import tell
from train.running.run_folder import (
    CHOSEN_OPTIONS,
    LEARNED_BEFORE,
    MANIFEST,
    RECORDINGS,
    fingerprints,
    read_manifest,
    versions,
)
from train.running.runs import RunKey
from train.running.trial_task import TrialTask

Repeated = tuple[Batch, DecidedGoal, Decider, Observations]
"""A run after a control period: the world, the goals that are decided, who decides them, and what it decided on."""
LISTED = 8
"""Largest number of scenarios in an error."""


class _Choice(Closed):
    """A line of `CHOSEN_OPTIONS`."""

    scenario: str
    condition: str
    options: dict[str, str]
    """The option that served each goal."""
    score: Number


def task_of(directory: Path, scenario: str | None = None, condition: str | None = None) -> TrialTask:
    """Return one of the finished runs of an evaluation; without names the first scenario and the first condition.

    Raises:
        ConfigurationError: there are no results of an evaluation, no such scenario or condition, or the files of
            mechanisms, knowledge, robots, policies or strategies have changed since.

    """
    manifest, path = read_manifest(directory), directory / MANIFEST
    if "learner" in manifest["identity"]:
        training = "a training: replay files below its recordings/, or evaluate its result"
        raise ConfigurationError(f"{directory}: expected the results of an evaluation, got those of {training}")
    comparison = Comparison.read(manifest, directory)
    _check_same_files(comparison, path)
    keys = [record.key for record in runs_of(directory / JOURNAL)]
    if not keys:
        raise ConfigurationError(f"{directory}: has no finished run")
    name, chosen = _chosen(keys, scenario, condition, directory)
    if chosen not in (bases := comparison.bases):
        raise ConfigurationError(f"{path}: identity.conditions: expected the run {chosen!r} among them")
    with within(str(directory)), reading_files(str(path)):
        (task,) = comparison.tasks([name], (), [chosen])
        if is_import(own := task.named.strategy):
            check_trust(own, f"import {own}")
    task = task.knowing(manifest.get(LEARNED_BEFORE, {}))
    if task.named.identity != bases[chosen].member:
        told = f"condition {task.condition!r} has changed since the evaluation; its runs cannot be repeated"
        raise ConfigurationError(f"{path}: {told}")
    options = chosen_options(directory).get(task.keys[0])
    with within(f"{directory / CHOSEN_OPTIONS}"):
        return task.serving(options) if options else task


def _chosen(keys: Sequence[RunKey], scenario: str | None, condition: str | None, directory: Path) -> RunKey:
    """Return the run of a scenario and a condition; the first of those that are not given."""
    known = list(dict.fromkeys(name for name, _ in keys))
    wanted = known[0] if scenario is None else scenario
    if wanted not in known:
        listed = ", ".join([*known[:LISTED], *(["..."] if len(known) > LISTED else [])])
        raise ConfigurationError(f"{directory}: unknown scenario {wanted!r} (known: {listed}; {len(known)} in all)")
    names = [own for name, own in keys if name == wanted]
    chosen = names[0] if condition is None else condition
    must_know("condition", chosen, names, str(directory))
    return wanted, chosen


def chosen_options(directory: Path) -> dict[tuple[str, str], dict[str, str]]:
    """Return the options that served each mission of an evaluation that learned: goal -> option by run."""
    lines = (validated(_Choice, value, where) for where, value in json_lines(directory / CHOSEN_OPTIONS))
    return {(one.scenario, one.condition): one.options for one in lines}


def changed_versions(directory: Path) -> list[str]:
    """Return the packages whose version has changed since an evaluation, such as `numba 0.61, now 0.62`."""
    held = read_manifest(directory).get("versions", {})
    if not isinstance(held, dict):
        raise ConfigurationError(f"{directory / MANIFEST}: versions: expected a mapping, got {short(held)}")
    return [f"{name} {held[name]}, now {now}" for name, now in versions().items() if held.get(name, now) != now]


def steps_of(task: TrialTask) -> Iterator[Repeated]:
    """Repeat a run with networks that note their reasons.

    Yield it after each control period.
    """
    scenarios = iter(task.scenarios)
    batch, decided, decider = task.team(source=lambda _: next(scenarios, None), explained=True)
    observations = batch.reset()
    decider.reset(batch.worlds.rows_of(0), task.first.seed)
    while batch.progress.outcome[0] == RUNNING:
        for _ in batch.ticks(decided.decide(decider, observations)):
            yield batch, decided, decider, observations
        tell(batch.decision_period)
        if batch.progress.outcome[0] == RUNNING:
            observations = batch.end_period().observations


def _check_same_files(comparison: Comparison, path: Path) -> None:
    now = fingerprints(comparison.directories)
    for name, held in sorted(comparison.files.items()):
        if now.get(name) != held:
            told = "has changed since the evaluation; its runs cannot be repeated"
            raise ConfigurationError(f"{path}: {name} {told}")


def record_run(task: TrialTask, output: Path, *, minds: bool = True, until: float = math.inf) -> Repeated:
    """Repeat a run, up to a time [s] if one is given, and write it to a new file; return how it stands then.

    Raises:
        ConfigurationError: the file exists or cannot be written, or the mission is too large.

    """
    check_output(output, (SUFFIX,), new=True)
    check_needs(task.first.mission, 1, ALONE, hint="the run cannot be repeated here")
    last = period_of(until, task.first.mission.world.control_rate) + 1
    with writing_to(output, anew=True):
        for repeated in steps_of(replace(task, record=RecordSettings(output.parent, minds, name=output.name))):
            if repeated[0].worlds.ticks[0] == last:
                repeated[0].close()
                break
    return repeated


def recording_of(task: TrialTask, results: Path, *, minds: bool) -> Path | None:
    """Return the recording of a run in the directory of its results, with minds if asked for; None without one."""
    for path in sorted((results / RECORDINGS).glob(f"*{SUFFIX}")):
        head = RecordedParts(blocks_of(path), str(path)).head
        own = (head["about"].get("scenario"), head["about"].get("condition")) == task.keys[0]
        if own and head["minds"] >= minds:
            with suppress(NoFrames):
                if RecordedMission(path, ()).result is not None:
                    return path
    return None
