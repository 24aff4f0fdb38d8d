"""`clean-swarm explain`, `record` and `replay`: a run from its recording, or done again."""

import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from json import dumps
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.console import Console

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.writing import check_output
from train.cli.options import MAY_NAME_CODE, check_there, error_console

RunDirectory = Annotated[
    Path, typer.Argument(help=f"Directory of an evaluation's results; {MAY_NAME_CODE}.", metavar="RUN")
]
ScenarioOption = Annotated[str | None, typer.Option(help="Scenario of the run; the first one unless given.")]
ConditionOption = Annotated[str | None, typer.Option(help="Condition of the run; the first one unless given.")]


def explain_command(
    run: RunDirectory,
    robot: Annotated[int, typer.Option(help="Number of the robot, from 0 on.")],
    time: Annotated[
        float | None,
        typer.Option(help="Time in the mission [s] to explain; without it the robot's largest turns are listed."),
    ] = None,
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    what_if: Annotated[bool, typer.Option("--what-if", help="Show the robot's next 5 s under each option.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Explain what a robot decided at a time, what it planned, and why; the run is repeated up to then."""
    check_there(run)
    if time is None and what_if:
        raise ConfigurationError("--what-if: expected --time beside it")
    if time is not None and not 0.0 <= time < math.inf:
        raise ConfigurationError(f"--time: expected seconds from 0 on, got {time:g}")
    from clean_swarm_env.recording.reader import RecordedMission  # these import Numba
    from train.evaluation import explain as explaining
    from train.evaluation.repeat import task_of
    from train.running.commands import progress
    from train.running.needs import most_numbers

    if time is None:
        with recorded(run, scenario, condition) as path:
            turns = explaining.largest_turns(RecordedMission(path, most=most_numbers()), robot)
        typer.echo(dumps(turns, indent=2) if json else explaining.turns_in_words(turns, robot))
        return
    task = task_of(run, scenario, condition)
    with TemporaryDirectory() as folder, progress("repeating the run", 1) as update:
        update(most=min(time, task.first.mission.time_limit))
        explained = explaining.explained(task, Path(folder) / "run.swarm", robot, time, ahead=what_if)
    error_console().print(f"run again up to {time:g} s{_changes(run)}", markup=False)
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
    """Write the recording of a run; a run without one is repeated. docs/recordings.md describes the file."""
    check_there(run)
    from clean_swarm_env.recording.file import SUFFIX  # these import Numba
    from clean_swarm_env.recording.reader import RecordedMission

    check_output(output, (SUFFIX,), new=True)
    with recorded(run, scenario, condition, minds=minds, output=output) as path:
        if path != output:
            output.parent.mkdir(parents=True, exist_ok=True)
            copyfile(path, output)
    recording = RecordedMission(output, ())
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
    """Write a page that plays a run, or two side by side; runs without a recording are repeated.

    Of one directory it plays the two conditions that cost least unless others are named, and says what else there is.
    """
    check_there(*runs)
    from clean_swarm_env.recording.reader import RecordedMission  # imports NumPy
    from train.replay.page_file import write_page
    from train.running.finished_runs import JOURNAL, cheapest_first, runs_of

    held = runs_of(runs[0] / JOURNAL) if len(runs) == 1 and runs[0].is_dir() else []
    known, many = cheapest_first(held), len({record.scenario for record in held})
    conditions: list[str | None] = [*(condition or known[:2])] or [None]
    chosen = runs * 2 if len(runs) == 1 and len(conditions) == 2 else runs
    if len(chosen) > 2 or len(conditions) not in (1, len(chosen)):
        raise ConfigurationError("replay: expected one or two runs, and a condition for each or for all")
    named = zip(chosen, conditions * (len(chosen) // len(conditions)), strict=True)
    with ExitStack() as stack:
        paths = [stack.enter_context(recording_at(run, scenario, name)) for run, name in named]
        write_page([RecordedMission(path, ()) for path in paths], html)
    typer.echo(f"{html}: open it in a browser")
    if held:
        others = ", ".join(name for name in known if name not in conditions) or "no others"
        shown = " beside ".join(filter(None, conditions))
        typer.echo(f"it shows {shown}; also there: {others} (--condition); {many} scenarios (--scenario)")


@contextmanager
def recorded(
    run: Path,
    scenario: str | None,
    condition: str | None,
    *,
    minds: bool = True,
    output: Path | None = None,
) -> Iterator[Path]:
    """Give the recording of a run in a directory of results, with or without minds.

    A run that has none is repeated, and recorded in `output`, or for a while. The standard error says at the end which
    was done.
    """
    from train.evaluation.repeat import record_run, recording_of, task_of  # these import Numba
    from train.running.commands import progress
    from train.running.run_folder import RECORDINGS

    task = task_of(run, scenario, condition)
    path = recording_of(task, run, minds=minds)
    told = f"read from {path}"
    with TemporaryDirectory() as folder:
        if path is None:
            lacking = "has no recording of it" + minds * " (evaluate --minds makes one)"
            told = f"run again: {run / RECORDINGS} {lacking}{_changes(run)}"
            path = output or Path(folder) / "run.swarm"
            with progress("repeating the run", 1) as update:
                update(most=task.first.mission.time_limit)
                record_run(task, path, minds=minds)
        yield path
    error_console().print(told, markup=False)


def _changes(run: Path) -> str:
    """Return what to say about packages whose version has changed since a run that is repeated; nothing if none has."""
    from train.evaluation.repeat import changed_versions  # imports Numba

    changed = ", ".join(changed_versions(run))
    return f"; the course may differ from the one then: {changed}" if changed else ""


@contextmanager
def recording_at(run: Path, scenario: str | None, condition: str | None, *, minds: bool = True) -> Iterator[Path]:
    """Give a recording, or that of a run in a directory of results; see `recorded`."""
    with recorded(run, scenario, condition, minds=minds) if run.is_dir() else nullcontext(run) as path:
        yield path
