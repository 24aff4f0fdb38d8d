"""`clean-swarm explain`, `record` and `replay`: repeat a run of an evaluation to see its decisions."""

import math
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.options import MAY_NAME_CODE, check_there, error_console

if TYPE_CHECKING:
    from train.running.trial_task import TrialTask

RunDirectory = Annotated[
    Path, typer.Argument(help=f"Directory of an evaluation's results; {MAY_NAME_CODE}.", metavar="RUN")
]
ScenarioOption = Annotated[str | None, typer.Option(help="Scenario of the run; the first one unless given.")]
ConditionOption = Annotated[str | None, typer.Option(help="Condition of the run; the first one unless given.")]


def explain_command(
    run: RunDirectory,
    robot: Annotated[int, typer.Option(help="Number of the robot, from 0 on.")],
    time: Annotated[float, typer.Option(help="Time in the mission [s]; the decision that held then is explained.")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    what_if: Annotated[bool, typer.Option("--what-if", help="Show the robot's next 5 s under each option.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Repeat a run up to a time and explain what a robot decided then, what it planned, and why."""
    check_there(run)
    from train.evaluation import explain as explaining  # imports Numba

    with repeating(run, scenario, condition, time) as task:
        explained = explaining.explained(task, robot, time, ahead=what_if)
    if json:
        typer.echo(explaining.as_json(*explained))
    else:
        Console(highlight=False, markup=False, emoji=False).print(explaining.step_on_terminal(*explained))


def record_command(
    run: RunDirectory,
    output: Annotated[Path, typer.Option(help="File to write, NAME.swarm; one that exists is refused.")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    minds: Annotated[bool, typer.Option(help="Record what the robots' networks decide, too.")] = True,
) -> None:
    """Repeat a run and record it: docs/recordings.md describes the file."""
    check_there(run)
    from clean_swarm_env.recording.reader import RecordedMission  # imports NumPy
    from train.evaluation.repeat import record_run

    with repeating(run, scenario, condition) as task:
        recording = RecordedMission(record_run(task, output, minds=minds), ())
    typer.echo(f"{recording.frames} steps of {recording.head['robots']} robots in {output}")


def replay_command(
    runs: Annotated[
        list[Path],
        typer.Argument(
            help=f"Recordings, or directories of results: one or two; {MAY_NAME_CODE}.", metavar="RUN [RUN2]"
        ),
    ],
    html: Annotated[Path, typer.Option(help="Page to write; one that exists is replaced.")],
    scenario: ScenarioOption = None,
    condition: Annotated[
        list[str] | None, typer.Option(help="Condition of a run in a directory; twice for two runs, in their order.")
    ] = None,
) -> None:
    """Write a page that plays a run, or two side by side; runs without a recording are repeated."""
    check_there(*runs)
    from clean_swarm_env.recording.reader import RecordedMission  # imports NumPy
    from train.evaluation.repeat import recording_of
    from train.replay.page_file import write_page

    conditions: list[str | None] = [*condition] if condition else [None]
    chosen = runs * 2 if len(runs) == 1 and len(conditions) == 2 else runs
    if len(chosen) > 2 or len(conditions) not in (1, len(chosen)):
        raise ConfigurationError("replay: expected one or two runs, and a condition for each or for all")
    recordings = []
    with TemporaryDirectory() as folder:
        for run, name in zip(chosen, conditions * (len(chosen) // len(conditions)), strict=True):
            with repeating(run, scenario, name) if run.is_dir() else nullcontext():
                recordings.append(RecordedMission(recording_of(run, scenario, name, Path(folder)), ()))
        write_page(recordings, html)
    typer.echo(f"{html}: open it in a browser")


@contextmanager
def repeating(run: Path, scenario: str | None, condition: str | None, until: float = math.inf) -> Iterator["TrialTask"]:
    """Give the task of a run, and show the progress while it is repeated up to a time [s].

    The standard error says which versions have changed since the run.
    """
    from train.evaluation.repeat import changed_versions, task_of  # imports Numba
    from train.running.commands import progress

    task = task_of(run, scenario, condition)
    changed = changed_versions(run)
    if changed:
        error_console().print(f"note: the course may differ from the one then: {', '.join(changed)}", markup=False)
    with progress("repeating the run", 1) as update:
        update(most=min(until, task.first.mission.time_limit))
        yield task
