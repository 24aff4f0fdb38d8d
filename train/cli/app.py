"""The command line: `clean-swarm evaluate`, `train`, `run`, `draw`, `explain`, `record`, `list`, `knowledge`.

What is wrong with the input is one line on the standard error and exit code 2; Ctrl-C ends with exit code 130. The
heavy imports wait until a command needs them, so that help is quick.
"""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError
from train.cli import draw as draw_cli
from train.cli import knowledge as knowledge_cli
from train.cli import run as goal_cli
from train.cli import train as training_cli

if TYPE_CHECKING:
    from train.running.runs import MissionRunner

BAD_INPUT, INTERRUPTED = 2, 130
TABLE_WIDTH = 140
"""Least width of the printed tables [characters]: a folded table says less than one cut by a narrow terminal."""
THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
app.add_typer(knowledge_cli.app, name="knowledge")
app.add_typer(training_cli.app, name="train")
app.command()(goal_cli.run)
app.command("draw")(draw_cli.draw_diagram)


def main() -> None:
    """Run the command line and exit with its code."""
    for name in THREAD_LIMITS:  # runs are parallel as processes; worker processes inherit this
        os.environ.setdefault(name, "1")
    try:
        app()
    except ConfigurationError as error:
        Console(stderr=True, soft_wrap=True, highlight=False).print(f"error: {error}", markup=False)
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"clean-swarm {version('clean-swarm')}")
        raise typer.Exit


@app.callback()
def _common(
    _: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
) -> None:
    """Compare and learn the selection of self-organisation mechanisms by robots that clean a torus."""


Configs = Annotated[
    list[Path] | None,
    typer.Option(
        help="Directory of your own configurations, with mechanisms/, knowledge/, robots/, missions/, experiments/; "
        "searched before the shipped ones; can be repeated.",
    ),
]


@app.command()
def evaluate(
    experiment: Annotated[str, typer.Argument(help="Name of an experiment, or path to its YAML file.")] = "table1",
    scenarios: Annotated[
        int | None, typer.Option(help="Run on this number of random start configurations drawn from the seed.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of everything random.")] = 0,
    workers: Annotated[int | None, typer.Option(help="Processes to run in; all usable CPUs unless given.")] = None,
    output: Annotated[
        Path | None, typer.Option(help="Directory for the results; a new one below results/ unless given.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Do only the runs that the directory lacks.")] = False,
    starts: Annotated[Path | None, typer.Option(help="JSON file of start configurations to run on.")] = None,
    condition: Annotated[list[str] | None, typer.Option(help="Run this condition only; can be repeated.")] = None,
    family: Annotated[
        str | None, typer.Option(help="Compare strategies on scenarios of this family, by name or path.")
    ] = None,
    strategy: Annotated[
        list[str] | None,
        typer.Option(
            help="With --family: fixed (every option), rule, policy:NAME, STRATEGY:FILE or STRATEGY:parameter=value; "
            "+ joins what several training seeds gave, LABEL=... names it; can be repeated.",
        ),
    ] = None,
    knowledge: Annotated[
        str | None, typer.Option(help="With --family: expert knowledge in place of the family's own.")
    ] = None,
    configs: Configs = None,
) -> None:
    """Run an experiment under all its conditions, or strategies on a family; the default is the paper's Table 1."""
    for name, value, least in (("--scenarios", scenarios, 1), ("--workers", workers, 1), ("--seed", seed, 0)):
        if value is not None and value < least:
            raise ConfigurationError(f"{name}: expected a whole number of at least {least}, got {value}")
    if family is not None:
        _check_absent("without --family", {"--starts": starts, "--condition": condition})
        code = _evaluate_family(
            family, strategy or ["fixed"], seed, scenarios, knowledge, configs or [], workers, output, resume
        )
        raise typer.Exit(code)
    _check_absent("with --family", {"--strategy": strategy, "--knowledge": knowledge})
    from train.evaluation import experiment as evaluation
    from train.evaluation.plan import Request
    from train.running.runs import usable_cpus

    raise typer.Exit(
        evaluation.evaluate(
            Request(experiment, seed, scenarios, starts, tuple(condition or ()), tuple(configs or ())),
            workers=workers or usable_cpus(),
            output=output,
            resume=resume,
            run_mission=mission_runner(),
            console=Console(width=max(Console().width, TABLE_WIDTH)),
        )
    )


def _check_absent(where: str, given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value:
            raise ConfigurationError(f"{name}: expected {where} only")


def _evaluate_family(
    family: str, strategies: list[str], seed: int, scenarios: int | None, knowledge: str | None, configs: list[Path],
    workers: int | None, output: Path | None, resume: bool,
) -> int:  # fmt: skip
    from train.evaluation.family import FamilyRequest, check_entrants, evaluate_family
    from train.running.runs import usable_cpus

    request = FamilyRequest(family, tuple(strategies), seed, scenarios, knowledge, tuple(configs))
    check_entrants(request)
    console = Console(width=max(Console().width, TABLE_WIDTH))
    return evaluate_family(request, workers=workers or usable_cpus(), output=output, resume=resume, console=console)


RunDirectory = Annotated[Path, typer.Argument(help="Directory of an evaluation's results.", metavar="RUN")]
Scenario = Annotated[str | None, typer.Option(help="Scenario of the run; the first one unless given.")]
Condition = Annotated[str | None, typer.Option(help="Condition of the run; the first one unless given.")]


@app.command("explain")
def explain_step(
    run: RunDirectory,
    robot: Annotated[int, typer.Option(help="Number of the robot, from 0 on.")],
    time: Annotated[float, typer.Option(help="Time in the mission [s]; the decision that held then is explained.")],
    scenario: Scenario = None,
    condition: Condition = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Repeat a run up to a time and explain what a robot decided then, what it planned, and why."""
    from train.evaluation import explain, repeat

    task = repeat.task_of(run, scenario, condition)
    with _repeating(run):
        told = explain.explained(task, robot, time)
    if json:
        typer.echo(explain.as_json(*told))
    else:
        Console(highlight=False, markup=False).print(explain.on_terminal(*told))


@app.command("record")
def record_run(
    run: RunDirectory,
    output: Annotated[Path, typer.Option(help="NPZ file to write; one that exists is refused.")],
    scenario: Scenario = None,
    condition: Condition = None,
) -> None:
    """Repeat a run and keep every step of every robot's networks, and the options held, in an NPZ file."""
    from train.evaluation import record, repeat

    task = repeat.task_of(run, scenario, condition)
    with _repeating(run):
        steps = record.record(task, output)
    typer.echo(f"{steps} steps of {task.mission.robots.count} robots in {output}")


@contextmanager
def _repeating(run: Path) -> Iterator[None]:
    """Say on the standard error what takes its time, and which versions have changed since."""
    from train.evaluation.repeat import changed_versions

    errors = Console(stderr=True, soft_wrap=True, highlight=False)
    changed = changed_versions(run)
    if changed:
        errors.print(f"note: the course may differ from the one then: {', '.join(changed)}", markup=False)
    with errors.status("repeating the run"):
        yield


@app.command("list")
def list_experiments(configs: Configs = None) -> None:
    """List the experiments with their conditions, and the families of scenarios."""
    from clean_swarm_env.config.files import load_experiment, load_family, names

    for name in names("experiments", configs or ()):
        experiment = load_experiment(name, configs or ())
        starts = f"{len(experiment.starts)} given" if experiment.starts else f"{experiment.scenarios} random"
        typer.echo(f"{name}: {experiment.description}")
        typer.echo(f"  {starts} start configurations; conditions: {', '.join(c.name for c in experiment.conditions)}")
    typer.echo("families of scenarios:")
    for name in names("families", configs or ()):
        typer.echo(f"  {name}: {load_family(name, configs or ()).description}")


def mission_runner() -> "MissionRunner":
    """Return the function that runs a mission."""
    from clean_swarm_env.world.mission import run_mission

    return run_mission
