"""The pipeline of all evaluations, of an experiment or of a family: check, tasks, runs, report.

`evaluate` is the whole pipeline. `ExperimentEvaluation` and `FamilyEvaluation` define the tasks and the report.
"""

import json
import shlex
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import MofNCompleteColumn

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.warm_up import compiled_before
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission_end import best_score
from selector.store.exact_sums import REWARD_LIMIT
from train.cluster.bits import WorkerBits, noted_bits, noting, own_bits
from train.evaluation.base import Evaluation
from train.evaluation.gathering import RunShare, gathered
from train.knowledge_store import Memory
from train.reports.knowledge_tables import learned_scores
from train.reports.text_table import on_terminal
from train.reports.write_report import publish
from train.running.engine import Engine, WorkerLost, each_done
from train.running.exit_codes import FAILED, FINISHED, INTERRUPTED
from train.running.finished_runs import Results
from train.running.progress import progress
from train.running.run_folder import ASKED, CHOSEN_OPTIONS, COMMAND, LEARNED_BEFORE, RunFolder, default_directory
from train.running.runs import RunKey, RunRecord
from train.running.warm_up import compile_first

NO_CONTEXT = np.zeros((1, 0))
"""Context of the one row of a strategy that chooses for a whole mission."""


@dataclass(frozen=True)
class Execution:
    """How an evaluation is executed; none of these settings changes a result."""

    engine: Engine
    """What does the runs."""
    output: Path | None
    """Directory for the results; a new one below results/ unless given."""
    resume: bool
    """Whether to do only the runs that are missing in the directory."""
    console: Console
    """Shows the tables; the standard error shows the progress."""
    record: RecordSettings | None = None
    """How the runs are recorded, in a directory below that of the results; they are not unless given."""
    share: RunShare | None = None
    """The part of the runs that is done, or the gathering of all parts; all runs are done unless given."""
    bits: WorkerBits = field(default_factory=WorkerBits)
    """The CPUs that take part in shares or elsewhere."""

    def wanted(self, evaluation: Evaluation) -> Sequence[RunKey]:
        """Return scenario and condition of the runs that are asked for."""
        return evaluation.keys if self.share is None else self.share.part(evaluation.keys)


def evaluate(evaluation: Evaluation, execution: Execution) -> int:
    """Do the missing runs, write the results and print the tables; return the exit code."""
    root = execution.output or default_directory(evaluation.stem, resume=execution.resume)
    if evaluation.memory is not None and not execution.resume:
        evaluation.memory.check_new()
    manifest = {**evaluation.manifest, ASKED: evaluation.asked.model_dump(), COMMAND: evaluation.words}
    share, known = execution.share, list[RunRecord]()
    if share is not None and share.gathers:
        known, learned = gathered(evaluation, root, share.count)
        manifest |= {LEARNED_BEFORE: learned} if LEARNED_BEFORE in manifest else {}
    for place in [root] if share is None else share.folders(root):
        execution.bits.add(noted_bits(place))
    if share is not None and not share.gathers:
        execution.bits.add(own_bits())
        root = share.folder(root)
    folder = RunFolder(root, manifest, resume=execution.resume, growing=evaluation.growing)
    with noting(folder, execution.bits):
        return _evaluated(evaluation, execution, Results(folder, evaluation.mistake, known))


def _evaluated(evaluation: Evaluation, execution: Execution, results: Results) -> int:
    memory, folder = evaluation.memory, results.folder
    if folder.learned:
        evaluation.mission = evaluation.mission.beginning_with(folder.learned)
    try:
        _run_missing(evaluation, results, execution)
    except (KeyboardInterrupt, WorkerLost) as end:
        _print_how_to_resume(evaluation, execution, results, str(end) or "interrupted")
        return FAILED if isinstance(end, WorkerLost) else INTERRUPTED
    finally:
        results.close()
    if execution.share is not None and not execution.share.gathers:
        done = f"share {execution.share} is done; `clean-swarm gather {execution.output}` merges all shares"
        execution.console.print(done, soft_wrap=True, highlight=False)
        return FINISHED
    publication = evaluation.publication(results.records)
    if folder.learned:
        known = knowledge_of(evaluation.mission, evaluation.directories)
        title = f"known at the beginning in the context {evaluation.context!r}"
        grids = (*publication.grids, learned_scores(known, title, evaluation.mission))
        publication = replace(publication, grids=grids)
    publish(publication, folder, execution.console)
    if memory is not None:
        if memory.learns:
            _give_scores(evaluation, memory, results.records)
            title = f"known now in the context {memory.context!r}"
            execution.console.print(on_terminal(learned_scores(memory.now(), title, evaluation.mission)))
        memory.close()
    return FINISHED


def _run_missing(evaluation: Evaluation, results: Results, execution: Execution) -> None:
    wanted = execution.wanted(evaluation)
    others = set(evaluation.keys) - set(wanted)
    tasks = evaluation.tasks(others | {record.key for record in results.records})
    if tasks and not compiled_before():
        compile_first(tasks[0])
    settings = execution.record
    if settings is not None:
        directory = (execution.output or results.folder.path).resolve()  # workers may have another
        settings = replace(settings, directory=directory / settings.directory)
        tasks = [task.recorded(settings) for task in tasks]
    done = len(wanted) - sum(len(task.keys) for task in tasks)
    in_turn = evaluation.learns_in_turn
    runs = _lessons(evaluation, results, settings) if in_turn else each_done(tasks, execution.engine)
    with progress("runs", MofNCompleteColumn(), len(wanted), done) as update, closing(runs) as each:
        for record in each:
            results.add(record)
            update(advance=1)


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
    """Return the score of a mission by its `cost` [s]; see `best_score`.

    The lowest score is the lowest reward that a store takes.
    """
    return max(best_score(mission) - cost / mission.time_limit, -REWARD_LIMIT)


def _print_how_to_resume(evaluation: Evaluation, execution: Execution, results: Results, what: str) -> None:
    """Print on the standard error what happened, and the command that continues the evaluation."""
    if execution.share is not None:
        command = execution.share.command(evaluation, execution.output)
    else:
        command = shlex.join([*evaluation.words, "--output", str(results.folder.path), "--resume"])
    kept = f"{len(results.records)} of {len(execution.wanted(evaluation))} runs are kept; to go on:\n  {command}"
    Console(stderr=True, highlight=False, soft_wrap=True).print(f"{what}: {kept}", markup=False)
