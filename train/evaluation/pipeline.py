"""The pipeline of all evaluations: check, tasks, runs, report.

`evaluate` is the whole pipeline. Subclasses of `Evaluation` define the tasks and the report.
"""

import json
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import replace

import numpy as np
from rich.console import Console

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.deciders.named import FIXED
from clean_swarm_env.learning.warm_up import compiled_before
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.task import task_class
from selector.store.exact_sums import REWARD_LIMIT
from train.evaluation.comparing import Comparing
from train.evaluation.evaluation import Evaluation
from train.reports.knowledge_tables import learned_scores
from train.reports.text_table import TerminalTable, publish
from train.running.commands import FINISHED, progress
from train.running.engine import WorkerLost, compile_first
from train.running.finished_runs import Results
from train.running.run_folder import CHOSEN_OPTIONS, default_directory
from train.running.runs import RunRecord
from train.running.trial_task import TrialTask

NO_CONTEXT = np.zeros((1, 0), dtype=np.float32)
"""Context of the one row of a strategy that chooses for a whole mission."""


def evaluate(evaluation: Evaluation, console: Console) -> int:
    """Do the missing runs, write the results and print the tables; return the exit code.

    The standard error shows the progress, `console` the tables.
    """
    request = evaluation.request
    root = request.output or default_directory(evaluation.stem, resume=request.resume)
    if evaluation.memory is not None and not request.resume:
        evaluation.memory.check_new()
    for remark in evaluation.remarks():
        Console(stderr=True, highlight=False, soft_wrap=True, emoji=False).print(remark, markup=False)
    with request.results(root, evaluation.manifest) as folder:
        results = Results(folder, evaluation.mistake)
        if folder.learned:
            evaluation.start_with(folder.learned)
        total = _count(evaluation.tasks({}))  # known before the first run
        try:
            _run_missing(evaluation, results, total)
            _publish(evaluation, results, console)
        except (KeyboardInterrupt, WorkerLost) as end:
            kept = f": {len(results.runs)} of {max(total, len(results.runs))} runs are kept{evaluation.so_far}"
            return request.ended(end, folder.path, kept)
        finally:
            results.close()
    return FINISHED


def _publish(evaluation: Evaluation, results: Results, console: Console) -> None:
    """Write and print the results."""
    memory, folder, request = evaluation.memory, results.folder, evaluation.request
    publication = evaluation.publication(results.records)
    if folder.learned:
        known = knowledge_of(evaluation.mission, evaluation.directories)
        title = f"known at the beginning in the context {evaluation.context!r}"
        grids = (*publication.grids, learned_scores(known, title, evaluation.mission))
        publication = replace(publication, grids=grids)
    evaluation.conclude()
    publish(publication, folder, console, request)
    if memory is not None and memory.learns:
        title = f"known now in the context {memory.context!r}"
        console.print(TerminalTable(learned_scores(memory.now(), title, evaluation.mission)))


def _run_missing(evaluation: Evaluation, results: Results, total: int) -> None:
    """Do the runs that are not done, and those of a search that follow from their results."""
    settings, tasks = evaluation.request.record, evaluation.tasks(results.runs)
    if tasks and not compiled_before():
        compile_first(tasks[0])
    if settings is not None:
        directory = results.folder.path.resolve() / settings.directory  # workers may have another
        settings = replace(settings, directory=directory)
    in_turn = evaluation if isinstance(evaluation, Comparing) and evaluation.learns_in_turn else None
    left = _count(tasks)
    done, most = max(total - left, 0), 0.0
    bar = progress("missions", total, done, results.folder.path)
    costs: dict[str, list[float]] = {}
    with bar as update, evaluation.request.engine.rounds() as each_done:
        while tasks or in_turn:
            recorded = [replace(task, record=settings) for task in tasks]
            most += sum(scenario.mission.time_limit for task in tasks for scenario in task.scenarios)
            update(total=max(total, done + left, evaluation.expected(results.runs)), most=most)
            with closing(_lessons(in_turn, results, settings) if in_turn else each_done(recorded)) as runs:
                for record in runs:
                    results.add(record)
                    costs.setdefault(record.condition, []).append(getattr(record.result, f"{evaluation.led_by}_s"))
                    update(advance=1, more=evaluation.leading(costs))
            done, tasks, in_turn = done + left, evaluation.tasks(results.runs), None
            left = _count(tasks)


def _count(tasks: Sequence[TrialTask]) -> int:
    """Return the number of runs of tasks."""
    return sum(len(task.keys) for task in tasks)


def _lessons(
    evaluation: Comparing, results: Results, settings: RecordSettings | None
) -> Generator[RunRecord, None, None]:
    """Run one mission after the other, each with an option that its decider chooses and then learns from.

    The store gets the score of a run once the run is on the disk. Scores of kept runs that it lacks are given first:
    the command was killed, or the disk was full, in between.
    """
    memory, done = evaluation.memory, dict(results.runs)
    assert memory is not None
    choosers, choices, given = evaluation.choosers(), "", set()
    held, goal = memory.held(), evaluation.problem.goal
    for scenario in evaluation.scenarios:
        for condition, decider in choosers.items():
            chosen = decider.decide(NO_CONTEXT).options
            option = decider.problem.options[chosen[0]]
            (drawn,) = evaluation.comparison.tasks([scenario], (), [condition])
            task = replace(drawn.knowing(evaluation.learned), member=f"{FIXED}:{option}", goal=goal)
            kept = done.get((scenario, condition))
            record = kept or replace(task, record=settings).run()[0]
            score = mission_score(evaluation.mission, record.result.cost_s)
            options = {goal: option}
            choice = {"scenario": scenario, "condition": condition, "options": options, "score": score}
            choices += json.dumps(choice) + "\n"
            results.folder.write(CHOSEN_OPTIONS, choices)
            if kept is None:
                yield record
            if (scenario, option) not in given:  # the same mission under another condition would count twice
                if held:
                    held -= 1
                else:
                    memory.give(goal, option, score)
            given.add((scenario, option))
            decider.update(chosen, np.array([score]), NO_CONTEXT)


def mission_score(mission: MissionConfig, cost: float) -> float:
    """Return the score of a mission by its `cost` [s]; see `Task.best_score`.

    The lowest score is the lowest reward that a store takes.
    """
    return max(task_class(mission).best_score - cost / mission.time_limit, -REWARD_LIMIT)
