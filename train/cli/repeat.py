"""`clean-swarm explain` and `record`: repeat a run of an evaluation to see its decisions."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from train.cli.options import error_console

RunDirectory = Annotated[Path, typer.Argument(help="Directory of an evaluation's results.", metavar="RUN")]
ScenarioOption = Annotated[str | None, typer.Option(help="Scenario of the run; the first one unless given.")]
ConditionOption = Annotated[str | None, typer.Option(help="Condition of the run; the first one unless given.")]


def explain_command(
    run: RunDirectory,
    robot: Annotated[int, typer.Option(help="Number of the robot, from 0 on.")],
    time: Annotated[float, typer.Option(help="Time in the mission [s]; the decision that held then is explained.")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Repeat a run up to a time and explain what a robot decided then, what it planned, and why."""
    from train.evaluation import explain as explaining  # imports Numba
    from train.evaluation.repeat import task_of

    task = task_of(run, scenario, condition)
    with _repeating(run):
        explained = explaining.explained(task, robot, time)
    if json:
        typer.echo(explaining.as_json(*explained))
    else:
        Console(highlight=False, markup=False).print(explaining.step_on_terminal(*explained))


def record_command(
    run: RunDirectory,
    output: Annotated[Path, typer.Option(help="File to write, NAME.swarm; one that exists is refused.")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    minds: Annotated[bool, typer.Option(help="Record what the robots' networks decide, too.")] = True,
) -> None:
    """Repeat a run and record it: docs/recordings.md describes the file."""
    from train.evaluation.record_run import record_run  # imports Numba
    from train.evaluation.repeat import task_of

    task = task_of(run, scenario, condition)
    with _repeating(run):
        recording = record_run(task, output, minds=minds)
    typer.echo(f"{recording.frames} steps of {recording.head['robots']} robots in {output}")


@contextmanager
def _repeating(run: Path) -> Iterator[None]:
    """Print on the standard error which versions have changed since a run, and show that it is being repeated."""
    from train.evaluation.repeat import changed_versions  # imports Numba

    errors = error_console()
    changed = changed_versions(run)
    if changed:
        errors.print(f"note: the course may differ from the one then: {', '.join(changed)}", markup=False)
    with errors.status("repeating the run"):
        yield
