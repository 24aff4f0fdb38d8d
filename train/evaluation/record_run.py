"""Recordings of runs that are over: one that was made meanwhile, or a new one by running again."""

from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.file import SUFFIX
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from train.evaluation.repeat import Repeated, task_of
from train.running.run_folder import RECORDINGS


def record_run(task: Repeated, output: Path, *, minds: bool = True) -> RecordedMission:
    """Repeat a whole run and write it to a new file; return the recording.

    Raises:
        ConfigurationError: the file exists or cannot be written, or the mission has nothing to do.

    """
    if output.suffix != SUFFIX:
        raise ConfigurationError(f"{output}: expected a name that ends with {SUFFIX}")
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file")
    if not output.parent.is_dir():
        raise ConfigurationError(f"{output}: cannot be written (no such directory)")
    task.recorded(RecordSettings(output.parent, minds, name=output.name)).run()
    return RecordedMission(output)


def recording_of(
    run: Path, scenario: str | None, condition: str | None, folder: Path, *, minds: bool = True
) -> RecordedMission:
    """Return a recording: that of a file, or one of a run in a directory of results, with minds if they are asked for.

    A run that was recorded so is read. Others are repeated, and recorded in `folder`.
    """
    if not run.is_dir():
        return RecordedMission(run)
    task = task_of(run, scenario, condition)
    for path in sorted((run / RECORDINGS).glob(f"*{SUFFIX}")):
        recording = RecordedMission(path)
        about = recording.head["about"]
        same = (about.get("scenario"), about.get("condition")) == (task.scenario, task.condition)
        if same and recording.result is not None and recording.head["minds"] >= minds:
            return recording
    number = len(list(folder.iterdir())) + 1
    return record_run(task, folder / f"{number}{SUFFIX}", minds=minds)
