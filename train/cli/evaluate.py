"""`clean-swarm evaluate` and `run`: an experiment, strategies on a family of scenarios, a task beside its baseline."""

import json as json_format
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from clean_swarm_env.config.task_names import OWN_TASK, task_names
from selector.documents.find import find_file
from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.trust import is_import
from selforg.registry import unknown
from train.cli.listing import check_named, conditions_in
from train.cli.options import (
    MOST_SEED,
    REPORTING,
    Configs,
    GivenOptions,
    asking,
    check_there,
    check_whole,
    wide_console,
)

MOST_WORLD_SEEDS = 100


@asking("scenarios", "seed", "knowledge", "goal", "store", "learn", "record", "minds", *REPORTING)
def evaluate_command(
    experiment: Annotated[str, typer.Argument(help="Name of an experiment, or path to its YAML file.")] = "table1",
    starts: Annotated[Path | None, typer.Option(help="JSON file of start configurations to run on.")] = None,
    condition: Annotated[list[str] | None, typer.Option(help="Run this condition only; can be repeated.")] = None,
    family: Annotated[
        str | None, typer.Option(help="Compare strategies on scenarios of this family, by name or path.")
    ] = None,
    strategy: Annotated[
        list[str] | None,
        typer.Option(
            help="With --family: fixed (every option; the default), fixed:OPTION, fsm:NAME, policy:NAME, policy:FILE "
            "(a directory, .zip of Stable-Baselines3, .pt of TorchScript or .onnx), velocity:FILE (a model that "
            "drives), learned:NAME, learned:FILE, STRATEGY, STRATEGY:parameter=value or module:Class of your own; + "
            "joins what several training seeds gave, LABEL=... names it; can be repeated; Off and Random come beside.",
        ),
    ] = None,
    world_seeds: Annotated[
        int, typer.Option(help="With --family: world seeds of each scenario; the oracle needs two or more.")
    ] = 1,
    *,
    given: GivenOptions,
) -> None:
    """Run an experiment under all its conditions, or strategies on a family; the default is the paper's Table 1."""
    values = given.values
    check_whole({"--world-seeds": (world_seeds, 1, MOST_WORLD_SEEDS)})
    if values["learn"] and values["workers"] not in (None, 1):
        expected = "expected 1 with --learn, where missions learn in turn"
        raise ConfigurationError(f"--workers: {expected}, got {values['workers']}")
    if family is None:
        check_named(given.directories, experiments=experiment)
        unused = {"--strategy": strategy, "--knowledge": values["knowledge"], "--world-seeds": world_seeds > 1}
        _check_absent("with --family", unused)
        known = conditions_in(find_file("experiments", experiment, given.directories)) if condition else []
        for name in condition or ():
            if known and name not in known:
                raise ConfigurationError(f"{Path(experiment).stem}: {unknown('condition', name, known)}")
    else:
        _check_absent("without --family", {"--starts": starts, "--condition": condition})
        check_named(given.directories, strategy, families=family, knowledge=values["knowledge"])
    check_there(starts)
    from clean_swarm_env.config.load import load_robustness  # these import Numba
    from train.evaluation import pipeline
    from train.evaluation.base import Evaluation
    from train.evaluation.experiment import ExperimentEvaluation
    from train.evaluation.family import FamilyEvaluation

    evaluation: Evaluation
    if family is not None:
        strategies = tuple(strategy or ("fixed",))
        evaluation = FamilyEvaluation(given.request(family, strategies=strategies, worlds=world_seeds))
    elif (robustness := load_robustness(experiment, given.directories)) is not None:
        unused = {"--starts": starts, "--condition": condition, "--store": values["store"], "--learn": values["learn"]}
        _check_absent("with experiments without disturbances", unused)
        evaluation = FamilyEvaluation(given.request(experiment, strategies=robustness.strategies), robustness)
    else:
        _check_absent("with --family, or an experiment with disturbances", {"--goal": values["goal"]})
        evaluation = ExperimentEvaluation(given.request(experiment, starts=starts, conditions=tuple(condition or ())))
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))


def _check_absent(where: str, given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value:
            raise ConfigurationError(f"{name}: expected {where} only")


MOST_ROBOTS, MOST_RUNS, MOST_SECONDS = 10_000, 10_000, 1e7
"""The bounds of missions."""
ARENAS = ("torus", "open")


def run_command(
    task: Annotated[str, typer.Argument(help="Name of a task.")],
    robots: Annotated[int | None, typer.Option(help="Number of robots; the task's own unless given.")] = None,
    seconds: Annotated[float | None, typer.Option(help="Simulated time [s]; the task's own unless given.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of everything random.")] = 0,
    runs: Annotated[int, typer.Option(help="Number of runs, each from a start of its own.")] = 20,
    option: Annotated[
        str | None, typer.Option(help="Option that serves the goal; the one of the highest score unless given.")
    ] = None,
    knowledge: Annotated[str | None, typer.Option(help="Expert knowledge in place of the task's own.")] = None,
    arena: Annotated[str | None, typer.Option(help="torus or open; the task's own unless given.")] = None,
    configs: Configs = None,
    record: Annotated[
        Path | None, typer.Option(help="Directory for a recording of every run, mechanism and baseline.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Run a task by an option and by its baseline: the measures of its success, their targets and the difference."""
    check_whole({"--robots": (robots, 1, MOST_ROBOTS), "--seed": (seed, 0, MOST_SEED), "--runs": (runs, 1, MOST_RUNS)})
    if seconds is not None and not 0.0 < seconds <= MOST_SECONDS:
        raise ConfigurationError(f"--seconds: expected a positive number up to {MOST_SECONDS:g}, got {seconds:g}")
    if arena is not None and arena not in ARENAS:
        raise ConfigurationError(f"--arena: expected {' or '.join(ARENAS)}, got {arena!r}")
    if not is_import(task) and task not in task_names():
        raise ConfigurationError(unknown("task", task, task_names()) + OWN_TASK)
    from clean_swarm_env.recording.recorder import RecordSettings
    from train.evaluation.task_run import TaskRun, outcome_grid, run_task  # imports Numba
    from train.reports.text_table import TerminalTable

    ground: Any = arena  # which has been checked
    asked = TaskRun(
        task,
        seed=seed,
        scenarios=runs,
        knowledge=knowledge,
        directories=tuple(configs or ()),
        record=None if record is None else RecordSettings(record.resolve()),
        option=option,
        robots=robots,
        seconds=seconds,
        ground=ground,
    )
    outcome = run_task(asked)
    if json:
        typer.echo(json_format.dumps(outcome.content, indent=2))
        return
    wide_console().print(TerminalTable(outcome_grid(outcome)))
