"""Recording of a run that is over, by running it again."""

from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.file import SUFFIX
from clean_swarm_env.recording.reader import Recording
from clean_swarm_env.recording.recorder import RecordSettings
from train.evaluation.repeat import Repeated


def record_run(task: Repeated, output: Path, *, minds: bool = True) -> Recording:
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
    return Recording(output)
