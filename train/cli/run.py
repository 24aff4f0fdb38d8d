"""`clean-swarm run`: any goal of the library in its scene, with the measure by which it succeeds."""

import json as json_format
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError

if TYPE_CHECKING:
    from train.goals.scene_runs import GoalOutcome

TABLE_WIDTH = 140
"""Least width of the printed tables [characters]."""
GROUNDS = ("torus", "open")


def run(
    goal: Annotated[str | None, typer.Argument(help="Name of a goal; --all runs every one.")] = None,
    every: Annotated[bool, typer.Option("--all", help="Run every goal and print the table of them all.")] = False,
    robots: Annotated[int | None, typer.Option(help="Number of robots; the scene's own unless given.")] = None,
    seconds: Annotated[float | None, typer.Option(help="Simulated time [s]; the scene's own unless given.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of the first run; the others follow.")] = 0,
    runs: Annotated[int, typer.Option(help="Number of runs, each with a seed of its own.")] = 20,
    option: Annotated[
        str | None, typer.Option(help="Option that serves the goal; the one of the highest score unless given.")
    ] = None,
    knowledge: Annotated[str, typer.Option(help="Expert knowledge in which the goal stands.")] = "library",
    arena: Annotated[str | None, typer.Option(help="torus or open; the scene's own unless given.")] = None,
    configs: Annotated[
        list[Path] | None,
        typer.Option(help="Directory whose mechanisms/ and knowledge/ go before the shipped ones; can be repeated."),
    ] = None,
    output: Annotated[Path | None, typer.Option(help="Markdown file to write the table of all goals to.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Run a goal in its scene and print the measures by which it succeeds, their targets and the baseline."""
    _check(goal, every, robots, seconds, seed, runs, option, arena, output)
    from train.goals.scene_runs import GoalRequest, as_mapping, run_goal

    outcomes = []
    with Console(stderr=True).status("running") as status:
        for name in _goals() if every else (str(goal),):
            status.update(f"running {name}")
            outcomes.append(
                run_goal(GoalRequest(name, option, robots, seconds, arena, seed, runs, tuple(configs or ()), knowledge))  # type: ignore[arg-type]
            )
    if json:
        given = [as_mapping(outcome) for outcome in outcomes]
        typer.echo(json_format.dumps(given if every else given[0], indent=2))
    else:
        _print(outcomes, output)


def _check(
    goal: str | None, every: bool, robots: int | None, seconds: float | None, seed: int, runs: int,
    option: str | None, arena: str | None, output: Path | None,
) -> None:  # fmt: skip
    """Raise ConfigurationError for what cannot be meant."""
    if (goal is None) is not every:
        known = f"; the goals are {', '.join(_goals())}" if goal is None else ""
        raise ConfigurationError(f"run: expected a goal or --all, got {'both' if every else 'neither'}{known}")
    for name, given in (("--option", option), ("--robots", robots), ("--seconds", seconds)):
        if every and given is not None:
            raise ConfigurationError(f"{name}: expected one goal, not --all")
    if output is not None and not every:
        raise ConfigurationError("--output: expected --all, got one goal")
    for name, value, least in (("--robots", robots, 1), ("--seed", seed, 0), ("--runs", runs, 1)):
        if value is not None and value < least:
            raise ConfigurationError(f"{name}: expected a whole number of at least {least}, got {value}")
    if seconds is not None and not (seconds > 0.0 and math.isfinite(seconds)):
        raise ConfigurationError(f"--seconds: expected a positive number, got {seconds}")
    if arena is not None and arena not in GROUNDS:
        raise ConfigurationError(f"--arena: expected {' or '.join(GROUNDS)}, got {arena!r}")


def _goals() -> tuple[str, ...]:
    from clean_swarm_env.scenes import goals

    return goals()


def _print(outcomes: "list[GoalOutcome]", output: Path | None) -> None:
    from train.goals import tables as goal_tables

    console = Console(width=max(Console().width, TABLE_WIDTH), highlight=False, markup=False)
    if output is not None:
        try:
            output.write_text(goal_tables.as_page(outcomes), encoding="utf-8")
        except OSError as error:
            raise ConfigurationError(f"--output: {output}: {error.strerror or error}") from error
        typer.echo(f"{len(outcomes)} goals in {output}")
    else:
        for outcome in outcomes:
            console.print(goal_tables.on_terminal(outcome))
