"""The request of a command: one record of the runs, the results that are kept, and the limits of the machine."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from rich.console import Console

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.plain import short
from train.memory import NO_STORE, StoreRequest
from train.running.bits import WorkerBits, noted_bits
from train.running.commands import FAILED, INTERRUPTED
from train.running.dask_engine import DaskEngine
from train.running.engine import Engine, WorkerLost
from train.running.needs import ALONE, Machine
from train.running.processes import Processes
from train.running.run_folder import COMMAND, SHARE_FOLDERS, WORKERS, Json, RunFolder
from train.running.runs import RunKey

ALL = "all"
"""In place of the number of a share: the results of all shares are gathered."""


@dataclass(frozen=True)
class RunShare:
    """One of `count` parts of the runs of an evaluation, or the gathering of them all."""

    number: int
    """From 1 on; 0 gathers."""
    count: int

    @classmethod
    def of_text(cls, text: str) -> RunShare:
        """Return the share `I/N`, or what gathers, `all/N`."""
        found = re.fullmatch(rf"({ALL}|[1-9]\d{{0,4}})/([1-9]\d{{0,4}})", text)
        number, count = (0 if found[1] == ALL else int(found[1]), int(found[2])) if found else (1, 0)
        if number > count:
            raise ConfigurationError(f"--share: expected I/N with I from 1 to N, got {short(text)}")
        return cls(number, count)

    @property
    def gathers(self) -> bool:
        """Whether this is the gathering of all shares."""
        return self.number == 0

    def __str__(self) -> str:
        return f"{self.number or ALL}/{self.count}"

    def folder(self, directory: Path) -> Path:
        """Return the run folder of this share in the directory of all shares."""
        return directory / SHARE_FOLDERS / f"{self.number}-of-{self.count}"

    def folders(self, directory: Path) -> list[Path]:
        """Return the run folders of all shares."""
        return [replace(self, number=number).folder(directory) for number in range(1, self.count + 1)]

    def part(self, keys: Sequence[RunKey]) -> Sequence[RunKey]:
        """Return every `count`-th of the keys, so that each share has some of every condition."""
        return keys if self.gathers else keys[self.number - 1 :: self.count]


@dataclass(frozen=True)
class Request:
    """What a user asks of a command that does missions; a command reads the settings that it has options for."""

    name: str
    """Experiment, family, training or study, by name or by path."""
    strategies: tuple[str, ...] = ()
    """Strategies to compare; see `entrants_of`."""
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
    scoring: bool = False
    """Whether every option of a goal is run and scored for the store."""
    output: Path | None = None
    """Directory of the results; a new one below results/ unless given."""
    resume: bool = False
    """Whether to do only what the directory lacks."""
    share: RunShare | None = None
    """The part of the runs that is done, or the gathering of all parts; all runs are done unless given."""
    every_table: bool = False
    """Whether to print all tables, not only that of what is compared."""
    figure: Path | None = None
    """File to which the figure is written, too."""
    record: RecordSettings | None = None
    """How missions are recorded, in a directory below that of the results; they are not unless given."""
    machine: Machine = ALONE
    """What the missions may use."""
    bits: WorkerBits = field(default_factory=WorkerBits)
    """The CPUs that take part in shares or elsewhere."""
    words: tuple[str, ...] = ()
    """The command as it was typed: for people, who read it in the manifest. Nothing obeys it."""

    @property
    def engine(self) -> Engine:
        """What does the missions: processes of this machine, or workers at the place that it names."""
        place = self.machine.place
        return Processes(self.machine.workers) if place is None else DaskEngine(place, self.bits)

    @contextmanager
    def results(self, directory: Path, manifest: Json, growing: str = "") -> Iterator[RunFolder]:
        """Give the run folder of the results, new or to resume, which no other command writes meanwhile.

        It notes the CPUs that take part.
        """
        self.bits.add(noted_bits(directory))
        folder = RunFolder(directory, {**manifest, COMMAND: [*self.words]}, resume=self.resume, growing=growing)
        with folder.alone():
            folder.note(WORKERS, self.bits.cpus)  # now, for shares that begin while this one runs
            try:
                yield folder
            finally:
                folder.note(WORKERS, self.bits.cpus)

    def command(self, directory: Path, *more: str) -> str:
        """Return the command that goes on with the results in a directory."""
        where = () if self.output is not None else ("--output", str(directory))
        return shlex.join([*self.words, *where, *more, *(() if self.resume else ("--resume",))])

    def ended(self, end: BaseException, directory: Path, kept: str = "") -> int:
        """Print on the standard error what ended the command and how to go on; return the exit code."""
        text = f"{str(end) or 'interrupted'}{kept}; to go on:\n  {self.command(directory)}"
        Console(stderr=True, highlight=False, soft_wrap=True).print(text, markup=False)
        return FAILED if isinstance(end, WorkerLost) else INTERRUPTED
