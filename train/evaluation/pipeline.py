"""The pipeline of all evaluations, of an experiment or of a family: check, tasks, runs, report.

`evaluate` is the whole pipeline. `ExperimentEvaluation` and `FamilyEvaluation` define the tasks and the report.
"""

import shlex
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from clean_swarm_env.recording.recorder import RecordSettings
from train.reports.write_report import Publication, publish
from train.running.exit_codes import FAILED, FINISHED, INTERRUPTED
from train.running.finished_runs import Results
from train.running.processes import each_done
from train.running.run_folder import RunFolder, default_directory
from train.running.runs import RunKey, RunRecord, Task
from train.running.warm_up import compile_first, compiled_before


class Evaluation(ABC):
    """Base class of evaluations, which define runs and a report on them.

    The constructor gets the user's request, and raises an error of one line, before anything is written, for everything
    that does not exist or fit.

    Attributes:
        stem: name of the default directory for the results.
        manifest: content of `manifest.json`; `identity` decides whether runs can be resumed, the rest is for readers.
        words: the command of this evaluation, without its directory.
        total: number of runs.
        growing: name of a mapping in the identity to which entries can be added later; empty: none.

    """

    stem: str
    manifest: dict[str, Any]
    words: list[str]
    total: int
    growing = ""

    @abstractmethod
    def tasks(self, done: Collection[RunKey]) -> Sequence[Task]:
        """Return the tasks for all runs except those that are `done`."""

    @abstractmethod
    def mistake(self, record: RunRecord) -> str:
        """Return why a run kept in the directory is not one of this evaluation; empty if it is."""

    @abstractmethod
    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the report on the finished runs; all runs of this evaluation are among them."""


@dataclass(frozen=True)
class Execution:
    """How an evaluation is executed; none of these settings changes a result."""

    workers: int
    """Number of processes."""
    output: Path | None
    """Directory for the results; a new one below results/ unless given."""
    resume: bool
    """Whether to do only the runs that are missing in the directory."""
    console: Console
    """Shows the tables; the standard error shows the progress."""
    record: RecordSettings | None = None
    """How the runs are recorded, in a directory below that of the results; they are not unless given."""


def evaluate(evaluation: Evaluation, execution: Execution) -> int:
    """Do the missing runs, write the results and print the tables; return the exit code."""
    directory = execution.output or default_directory(evaluation.stem, resume=execution.resume)
    folder = RunFolder(directory, evaluation.manifest, resume=execution.resume, growing=evaluation.growing)
    results = Results(folder, evaluation.mistake)
    try:
        _run_missing(evaluation, results, execution)
    except (KeyboardInterrupt, BrokenProcessPool) as end:
        results.close()
        broken = isinstance(end, BrokenProcessPool)
        _print_how_to_resume(evaluation, results, "a worker process was killed" if broken else "interrupted")
        return FAILED if broken else INTERRUPTED
    results.close()
    publish(evaluation.publication(results.records), folder, execution.console)
    return FINISHED


def _run_missing(evaluation: Evaluation, results: Results, execution: Execution) -> None:
    tasks = evaluation.tasks({record.key for record in results.records})
    if tasks and not compiled_before():
        compile_first(tasks[0])
    if execution.record is not None:
        settings = replace(execution.record, directory=results.folder.path / execution.record.directory)
        tasks = [task.recorded(settings) for task in tasks]
    done = evaluation.total - sum(task.runs for task in tasks)
    with _progress(evaluation.total, done) as advance, closing(each_done(tasks, execution.workers)) as each:
        for records in each:
            for record in records:
                results.add(record)
                advance()


@contextmanager
def _progress(total: int, done: int) -> Iterator[Callable[[], None]]:
    """Show a progress bar on the standard error; the function returned has to be called after each run."""
    columns = (TextColumn("runs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("left"))
    with Progress(*columns, TimeRemainingColumn(elapsed_when_finished=False), console=Console(stderr=True)) as bar:
        yield partial(bar.advance, bar.add_task("runs", total=total, completed=done))


def _print_how_to_resume(evaluation: Evaluation, results: Results, what: str) -> None:
    """Print on the standard error what happened, and the command that continues the evaluation."""
    command = shlex.join([*evaluation.words, "--output", str(results.folder.path), "--resume"])
    kept = f"{len(results.records)} of {evaluation.total} runs are kept; to go on:\n  {command}"
    Console(stderr=True, highlight=False, soft_wrap=True).print(f"{what}: {kept}", markup=False)
