"""An evaluation from request to report: plan, open the results, run what is missing, tell what came out."""

import shlex
from collections.abc import Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from train.analysis.report import Report, report_of, summary_json
from train.evaluation.plan import Plan, Request, check_coordination, check_planner, plan_of
from train.reports.experiment_tables import all_tables
from train.reports.figure import draw
from train.reports.text_table import markdown, on_terminal
from train.running.results import Results, default_directory
from train.running.runs import MissionRunner, RunTask, execute_all, tasks_of
from train.running.warm_up import compile_first

FINISHED, FAILED, INTERRUPTED = 0, 1, 130
"""Exit codes; 130 is that of a program ended by Ctrl-C."""


def evaluate(
    request: Request, *, workers: int, output: Path | None, resume: bool, run_mission: MissionRunner, console: Console
) -> int:
    """Run an evaluation, write its results and print its tables; return the exit code.

    `console` shows the tables, progress goes to the standard error. A bad request raises an error of one line before
    anything is written.
    """
    plan = plan_of(request)
    check_coordination(plan.experiment, plan.directories, request.experiment)
    check_planner(plan.experiment, request.experiment)
    tasks = tasks_of(plan.experiment, plan.seed, plan.directories)
    results = Results(output or default_directory(plan.stem, resume=resume), plan.manifest, resume=resume)
    try:
        _run_missing(tasks, results, workers, run_mission)
    except (KeyboardInterrupt, BrokenProcessPool) as end:
        results.close()
        broken = isinstance(end, BrokenProcessPool)
        _say_how_to_resume(request, results, len(tasks), "a worker process was killed" if broken else "interrupted")
        return FAILED if broken else INTERRUPTED
    results.close()
    report = report_of(plan.experiment, plan.seed, results.records, plan.measured, own_starts=plan.own_starts)
    _write(report, plan, results)
    for grid in all_tables(report):
        console.print(on_terminal(grid), soft_wrap=True)
        console.print()
    console.print(f"results in {results.directory}", soft_wrap=True, highlight=False)
    return FINISHED


def _run_missing(tasks: Sequence[RunTask], results: Results, workers: int, run_mission: MissionRunner) -> None:
    finished = {record.key for record in results.records}
    missing = [task for task in tasks if (task.scenario, task.condition) not in finished]
    if missing:
        compile_first(missing[0], run_mission)
    with progress(len(tasks), len(finished)) as advance, closing(execute_all(missing, workers, run_mission)) as runs:
        for record in runs:
            results.add(record)
            next(advance)


@contextmanager
def progress(total: int, finished: int) -> Iterator[Iterator[None]]:
    """Show a bar with the time left on the standard error; each `next` of what it gives is one more run."""
    columns = (TextColumn("runs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("left"))
    with Progress(*columns, TimeRemainingColumn(elapsed_when_finished=False), console=Console(stderr=True)) as bar:
        task = bar.add_task("runs", total=total, completed=finished)

        def steps() -> Iterator[None]:
            while True:
                bar.advance(task)
                yield

        yield steps()


def _write(report: Report, plan: Plan, results: Results) -> None:
    title = f"# {plan.experiment.name}\n\n{plan.experiment.description}\nSeed {plan.seed}; {plan.starts_from}.\n\n"
    results.write("summary.json", summary_json(report))
    results.write("table.md", title + "\n".join(markdown(grid) for grid in all_tables(report)))
    results.write_bytes("figure.png", draw(report))


def _say_how_to_resume(request: Request, results: Results, total: int, what: str) -> None:
    words = ["clean-swarm", "evaluate", request.experiment, "--seed", str(request.seed)]
    words += ["--scenarios", str(request.scenarios)] if request.scenarios is not None else []
    words += ["--starts", str(request.starts)] if request.starts is not None else []
    words += [word for name in request.conditions for word in ("--condition", name)]
    words += [word for path in request.directories for word in ("--configs", str(path))]
    words += ["--output", str(results.directory), "--resume"]
    errors = Console(stderr=True, highlight=False, soft_wrap=True)
    errors.print(
        f"{what}: {len(results.records)} of {total} runs are kept; to go on:\n  {shlex.join(words)}", markup=False
    )
