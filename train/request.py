"""The request of a command: one record of the runs, the results that are kept, and the limits of the machine."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from clean_swarm_env.recording.recorder import RecordSettings
from train.memory import NO_STORE, StoreRequest
from train.running.commands import FAILED, INTERRUPTED
from train.running.dask_engine import DaskEngine
from train.running.engine import Engine, WorkerLost
from train.running.needs import ALONE, Machine
from train.running.processes import Processes
from train.running.run_folder import COMMAND, Json, RunFolder


@dataclass(frozen=True)
class Request:
    """What a user asks of a command that does missions; a command reads the settings that it has options for."""

    name: str
    """Experiment, family or training, by name or by path."""
    strategies: tuple[str, ...] = ()
    """Strategies to compare; see `conditions_of`."""
    seed: int = 0
    """Seed of everything random."""
    scenarios: int | None = None
    """Number of scenarios or start configurations, in place of the document's own."""
    knowledge: str | None = None
    """Expert knowledge in place of the family's own."""
    goal: str | None = None
    """Goal that the strategies choose options for; see `DecidedGoal`."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    worlds: int = 1
    """World seeds of each scenario of a family."""
    starts: Path | None = None
    """File of start configurations, in place of the experiment's own."""
    conditions: tuple[str, ...] = ()
    """Names of the conditions of an experiment to run; empty: all."""
    store: StoreRequest = NO_STORE
    """The knowledge store."""
    output: Path | None = None
    """Directory of the results; a new one below results/ unless given."""
    resume: bool = False
    """Whether to do only what the directory lacks."""
    every_table: bool = False
    """Whether to print all tables, not only that of what is compared."""
    record: RecordSettings | None = None
    """How missions are recorded, in a directory below that of the results; they are not unless given."""
    machine: Machine = ALONE
    """What the missions may use."""
    words: tuple[str, ...] = ()
    """The command as it was typed: for people, who read it in the manifest. Nothing obeys it."""

    @property
    def engine(self) -> Engine:
        """What does the missions: processes of this machine, or workers at the place that it names."""
        place = self.machine.place
        return Processes(self.machine.workers) if place is None else DaskEngine(place)

    @contextmanager
    def results(self, directory: Path, manifest: Json) -> Iterator[RunFolder]:
        """Give the run folder of the results, new or to resume, which no other command writes meanwhile."""
        folder = RunFolder(directory, {**manifest, COMMAND: [*self.words]}, resume=self.resume)
        with folder.alone():
            yield folder

    def command(self, directory: Path) -> str:
        """Return the command that goes on with the results in a directory."""
        where = () if self.output is not None else ("--output", str(directory))
        return shlex.join([*self.words, *where, *(() if self.resume else ("--resume",))])

    def ended(self, end: BaseException, directory: Path, kept: str = "") -> int:
        """Print on the standard error what ended the command and how to go on; return the exit code."""
        text = f"{str(end) or 'interrupted'}{kept}; to go on:\n  {self.command(directory)}"
        Console(stderr=True, highlight=False, soft_wrap=True, emoji=False).print(text, markup=False)
        return FAILED if isinstance(end, WorkerLost) else INTERRUPTED
