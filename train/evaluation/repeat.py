"""Repetition of runs of an evaluation; a run depends on the manifest only, so that a repetition is the same run."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.recording.file import SUFFIX, blocks_of
from clean_swarm_env.recording.reader import NoFrames, RecordedMission, RecordedParts
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission import Course, MissionRun, period_of, result_of
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import shown, validated, within
from selector.documents.fields import Closed, Number
from selector.documents.plain import short
from selector.documents.reading import json_value, read_text
from selector.documents.writing import writing_to
from selforg.registry import unknown
from train.evaluation.repeat_trial import evaluation_seed, family_tasks, trial_steps
from train.evaluation.trial_task import TrialTask, experiment_tasks, identities
from train.running.needs import ALONE, Workload, check_needs
from train.running.provenance import fingerprints, versions
from train.running.run_folder import CHOSEN_OPTIONS, LEARNED_BEFORE, MANIFEST, RECORDINGS, read_manifest
from train.running.runs import RunTask

Repeated = RunTask | TrialTask
"""One run that can be repeated; a task of trials has one scenario then."""
NOT_REPEATED = {
    "learner": "a training: replay files below its recordings/, or evaluate what it learned",
    "study": "a study: evaluate what it found",
}
"""Key of the identity of results whose missions are not run again -> what they are of, and what to do."""
LISTED = 8
"""Largest number of scenarios in an error."""


class _Choice(Closed):
    """A line of `CHOSEN_OPTIONS`."""

    scenario: str
    condition: str
    options: dict[str, str]
    """The option that served each goal."""
    score: Number


def task_of(directory: Path, scenario: str | None = None, condition: str | None = None) -> Repeated:
    """Return one run of an evaluation; without names the first scenario and the first condition.

    The runs of an experiment are those of its configuration, the runs of a family those that were finished.

    Raises:
        ConfigurationError: there are no results of an evaluation, no such scenario or condition, or the files of
            mechanisms, knowledge, robots, policies or strategies have changed since.

    """
    manifest = read_manifest(directory)
    path, identity = directory / MANIFEST, manifest["identity"]
    for key, kind in NOT_REPEATED.items():
        if key in identity:
            raise ConfigurationError(f"{directory}: expected the results of an evaluation, got those of {kind}")
    directories = held_directories(manifest, path)
    _check_same_files(identity.get("files"), directories, path)
    if "family" in identity:
        tasks: Sequence[Repeated] = family_tasks(identity, directories, directory)
    else:
        tasks = _experiment_tasks(identity, directories, path)
    of_scenario = _of_scenario(tasks, scenario, directory)
    names = [task.condition for task in of_scenario]
    if condition is not None and condition not in names:
        raise ConfigurationError(f"{directory}: {unknown('condition', condition, names)}")
    task = of_scenario[0 if condition is None else names.index(condition)].knowing(manifest.get(LEARNED_BEFORE, {}))
    options = chosen_options(directory).get((task.scenario, task.condition))
    with within(f"{directory / CHOSEN_OPTIONS}"):
        return task.serving(options) if options else task


def held_directories(manifest: Mapping[str, Any], path: Path) -> tuple[Path, ...]:
    """Return the user's own directories of configurations that a manifest names."""
    listed = manifest["identity"].get("directories", manifest.get("directories", []))
    if not (isinstance(listed, list) and all(isinstance(name, str) for name in listed)):
        raise ConfigurationError(f"{path}: identity.directories: expected paths, got {short(listed)}")
    return tuple(Path(name) for name in listed)


def _experiment_tasks(identity: Mapping[str, Any], directories: tuple[Path, ...], path: Path) -> Sequence[Repeated]:
    where = f"{path}: identity.configuration"
    experiment = validated(ExperimentConfig, identity.get("configuration"), where)
    with within(where):
        tasks = experiment_tasks(experiment, evaluation_seed(identity, path), directories)
        now = identities(tasks)
    held = identity.get("deciders", {})
    if not isinstance(held, dict) or set(held) != set(now):
        expected = ", ".join(now) or "none"
        raise ConfigurationError(f"{path}: identity.deciders: expected those of {expected}, got {short(held)}")
    for condition, identity_now in now.items():
        if held[condition] != identity_now:
            raise ConfigurationError(f"{path}: condition {condition!r} is no longer what the evaluation ran with")
    return tasks


def chosen_options(directory: Path) -> dict[tuple[str, str], dict[str, str]]:
    """Return the options that served each mission of an evaluation that learned: goal -> option by run."""
    path = directory / CHOSEN_OPTIONS
    lines = read_text(path).splitlines() if path.exists() else []
    chosen = {}
    for number, line in enumerate(lines, start=1):
        where = f"{shown(path)}: line {number}"
        one = validated(_Choice, json_value(line, where), where)
        chosen[one.scenario, one.condition] = one.options
    return chosen


def changed_versions(directory: Path) -> list[str]:
    """Return the packages whose version has changed since an evaluation, such as `numba 0.61, now 0.62`."""
    held = read_manifest(directory).get("versions", {})
    if not isinstance(held, dict):
        raise ConfigurationError(f"{directory / MANIFEST}: versions: expected a mapping, got {short(held)}")
    return [f"{name} {held[name]}, now {now}" for name, now in versions().items() if held.get(name, now) != now]


def steps_of(task: Repeated) -> Iterator[Worlds]:
    """Repeat a run with networks that note their reasons; yield the world after each control period."""
    if isinstance(task, TrialTask):
        yield from trial_steps(task)
        return
    run = MissionRun(task.mission, task.start, task.mission_seed, task.scores, task.strategy, task.directories)
    course = Course(run, explained=True)
    while course.in_progress:
        course.tick()
        yield course.worlds


def steps_until(task: Repeated, time: float) -> Iterator[Worlds]:
    """Repeat a run as `steps_of` does, up to the control period in which `time` [s] lies.

    Raises:
        ConfigurationError: the mission was not running at this time; the text says when it ended.

    """
    wanted = period_of(time, task.mission.world.control_rate) + 1
    if not wanted:
        raise ConfigurationError(f"--time: expected seconds from 0 on, got {time:g}")
    worlds = None
    for worlds in steps_of(task):
        yield worlds
        if worlds.ticks[0] == wanted:
            return
    if worlds is None:
        raise ConfigurationError("--time: the mission has nothing to do and is over at once")
    result = result_of(worlds, 0)
    how = "was completed after" if result.completed else "ended uncompleted at its time limit of"
    raise ConfigurationError(f"--time {time:g}: this mission {how} {result.duration_s:g} s")


def _of_scenario(tasks: Sequence[Repeated], scenario: str | None, directory: Path) -> list[Repeated]:
    known = list(dict.fromkeys(task.scenario for task in tasks))
    wanted = known[0] if scenario is None else scenario
    if wanted not in known:
        listed = ", ".join([*known[:LISTED], *(["..."] if len(known) > LISTED else [])])
        raise ConfigurationError(f"{directory}: unknown scenario {wanted!r} (known: {listed}; {len(known)} in all)")
    return [task for task in tasks if task.scenario == wanted]


def _check_same_files(held: object, directories: Sequence[Path], path: Path) -> None:
    now = fingerprints(directories)
    if held == now:
        return
    of_then = held if isinstance(held, dict) else {}
    name = next(name for name in sorted(now.keys() | of_then.keys()) if now.get(name) != of_then.get(name))
    raise ConfigurationError(f"{path}: {name} is no longer what the evaluation ran with; its runs cannot be repeated")


def record_run(task: Repeated, output: Path, *, minds: bool = True) -> Path:
    """Repeat a whole run and write it to a new file; return the file.

    Raises:
        ConfigurationError: the file exists or cannot be written, or the mission has nothing to do or is too large.

    """
    if output.suffix != SUFFIX:
        raise ConfigurationError(f"{output}: expected a name that ends with {SUFFIX}")
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file")
    if not output.parent.is_dir():
        raise ConfigurationError(f"{output}: cannot be written (no such directory)")
    check_needs(Workload(task.mission, 1), ALONE, "the run cannot be repeated here")
    with writing_to(output, anew=True):
        task.recorded(RecordSettings(output.parent, minds, name=output.name)).run()
    return output


def recording_of(run: Path, scenario: str | None, condition: str | None, folder: Path, *, minds: bool = True) -> Path:
    """Return the file of a recording: `run` itself, or that of a run in a directory of results, with or without minds.

    A run that was recorded so is read. Others are repeated, and recorded in `folder`.
    """
    if not run.is_dir():
        return run
    task = task_of(run, scenario, condition)
    for path in sorted((run / RECORDINGS).glob(f"*{SUFFIX}")):
        head = RecordedParts(blocks_of(path), str(path)).head
        own = (head["about"].get("scenario"), head["about"].get("condition")) == (task.scenario, task.condition)
        if own and head["minds"] >= minds:
            with suppress(NoFrames):
                if RecordedMission(path, ()).result is not None:
                    return path
    number = len(list(folder.iterdir())) + 1
    return record_run(task, folder / f"{number}{SUFFIX}", minds=minds)
