"""The pipeline of all evaluations, of an experiment or of a family: check, tasks, runs, report.

`evaluate` is the whole pipeline. `ExperimentEvaluation` and `FamilyEvaluation` define the tasks and the report.
"""

import json
import shlex
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Generator, Iterator, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.warm_up import compiled_before
from clean_swarm_env.recording.recorder import RecordSettings
from selector.store.exact_sums import REWARD_LIMIT
from selector.strategies.strategy import DecisionStrategy
from train.knowledge_store import Memory
from train.reports.knowledge_tables import learned_scores
from train.reports.text_table import on_terminal
from train.reports.write_report import Publication, publish
from train.running.exit_codes import FAILED, FINISHED, INTERRUPTED
from train.running.finished_runs import Results
from train.running.processes import each_done
from train.running.run_folder import CHOSEN_OPTIONS, RunFolder, default_directory
from train.running.runs import RunKey, RunRecord, Task
from train.running.warm_up import compile_first

NO_CONTEXT = np.zeros((1, 0))
"""Context of the one row of a strategy that chooses for a whole mission."""
Choosers = Mapping[str, DecisionStrategy]
"""Goal -> strategy with one row, which chooses one option for the whole team and mission."""


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
        memory: the knowledge store of this evaluation, if any.
        mission: the mission; before the runs begin it gets what was learned of its options.
        scenarios: names of the scenarios, in the order in which missions learn.
        directories: the user's own directories of configurations.
        scored: condition -> goal -> option, where runs of fixed options are scored for the store.

    """

    stem: str
    manifest: dict[str, Any]
    words: list[str]
    total: int
    growing = ""
    memory: Memory | None = None
    mission: MissionConfig
    scenarios: list[str]
    directories: tuple[Path, ...]
    scored: Mapping[str, Mapping[str, str]] = MappingProxyType({})

    @property
    def learns_in_turn(self) -> bool:
        """Whether missions run one after the other, each with options chosen by what those before have brought."""
        return self.memory is not None and self.memory.learns and not self.scored

    @abstractmethod
    def tasks(self, done: Collection[RunKey]) -> Sequence[Task]:
        """Return the tasks for all runs except those that are `done`."""

    @abstractmethod
    def mistake(self, record: RunRecord) -> str:
        """Return why a run kept in the directory is not one of this evaluation; empty if it is."""

    @abstractmethod
    def choosers(self) -> Mapping[str, Choosers]:
        """Return for each condition the strategies that choose an option of each goal once in a mission."""

    @abstractmethod
    def task_with(self, scenario: str, condition: str, options: Mapping[str, str]) -> Task:
        """Return the task of one run in which `options` serve the goals; goal -> option."""

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
    if evaluation.memory is not None and not execution.resume:
        evaluation.memory.check_new()
    folder = RunFolder(directory, evaluation.manifest, resume=execution.resume, growing=evaluation.growing)
    with folder.alone():
        return _evaluated(evaluation, execution, folder)


def _evaluated(evaluation: Evaluation, execution: Execution, folder: RunFolder) -> int:
    memory = evaluation.memory
    if folder.learned:
        evaluation.mission = evaluation.mission.beginning_with(folder.learned)
    results = Results(folder, evaluation.mistake)
    try:
        _run_missing(evaluation, results, execution)
    except (KeyboardInterrupt, BrokenProcessPool) as end:
        results.close()
        broken = isinstance(end, BrokenProcessPool)
        _print_how_to_resume(evaluation, results, "a worker process was killed" if broken else "interrupted")
        return FAILED if broken else INTERRUPTED
    results.close()
    publication = evaluation.publication(results.records)
    if folder.learned and memory is not None:
        known = knowledge_of(evaluation.mission, evaluation.directories)
        title = f"known at the beginning in the context {memory.context!r}"
        grids = (*publication.grids, learned_scores(known, title, evaluation.mission.time_limit))
        publication = replace(publication, grids=grids)
    publish(publication, folder, execution.console)
    if memory is not None:
        if memory.learns:
            _give_scores(evaluation, memory, results.records)
            title = f"known now in the context {memory.context!r}"
            execution.console.print(on_terminal(learned_scores(memory.now(), title, evaluation.mission.time_limit)))
        memory.close()
    return FINISHED


def _run_missing(evaluation: Evaluation, results: Results, execution: Execution) -> None:
    tasks = evaluation.tasks({record.key for record in results.records})
    if tasks and not compiled_before():
        compile_first(tasks[0])
    settings = execution.record
    if settings is not None:
        settings = replace(settings, directory=results.folder.path / settings.directory)
        tasks = [task.recorded(settings) for task in tasks]
    done = evaluation.total - sum(task.runs for task in tasks)
    in_turn = evaluation.learns_in_turn
    runs = _lessons(evaluation, results, settings) if in_turn else each_done(tasks, execution.workers)
    with _progress(evaluation.total, done) as advance, closing(runs) as each:
        for record in each:
            results.add(record)
            advance()


def _lessons(
    evaluation: Evaluation, results: Results, settings: RecordSettings | None
) -> Generator[RunRecord, None, None]:
    """Run one mission after the other, each with options that its strategies choose and then learn from.

    The store gets the score of a run once the run is on the disk. Scores of kept runs that it lacks are given first:
    the command was killed, or the database went away, in between.
    """
    memory, done = evaluation.memory, {record.key: record for record in results.records}
    assert memory is not None
    choosers, choices, given = evaluation.choosers(), "", set()
    held = memory.held()
    for scenario in evaluation.scenarios:
        for condition, strategies in choosers.items():
            chosen = {goal: strategy.select(NO_CONTEXT) for goal, strategy in strategies.items()}
            options = {goal: strategies[goal].problem.options[number[0]] for goal, number in chosen.items()}
            kept, task = done.get((scenario, condition)), evaluation.task_with(scenario, condition, options)
            record = kept or (task.recorded(settings) if settings else task).run()[0]
            score = mission_score(evaluation.mission, record.result.cost_s)
            choice = {"scenario": scenario, "condition": condition, "options": options, "score": score}
            choices += json.dumps(choice) + "\n"
            results.folder.write(CHOSEN_OPTIONS, choices)
            trial = (scenario, *options.items())
            if kept is None:
                yield record
            if trial not in given:  # the same mission under another condition would count twice
                if held:
                    held -= len(options)
                else:
                    memory.give((goal, option, score) for goal, option in options.items())
            given.add(trial)
            for goal, strategy in strategies.items():
                strategy.update(chosen[goal], np.array([score]), NO_CONTEXT)


def _give_scores(evaluation: Evaluation, memory: Memory, records: Sequence[RunRecord]) -> None:
    """Give the scores of fixed options to the store, all at once; nothing if it has them already."""
    if memory.given():
        return
    memory.give(
        (goal, option, mission_score(evaluation.mission, record.result.cost_s))
        for record in records
        for goal, option in evaluation.scored.get(record.condition, {}).items()
    )


def mission_score(mission: MissionConfig, cost: float) -> float:
    """Return the score of a mission by its `cost` [s]: the share of its time limit that is left [-].

    1 is the best possible score. A mission with the score 0 costs as much as its time limit. The lowest score is the
    lowest reward that a store takes.
    """
    return max(1.0 - cost / mission.time_limit, -REWARD_LIMIT)


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
