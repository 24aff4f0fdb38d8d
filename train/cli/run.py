"""`clean-swarm run`: a goal of the library in its scene, with the measures of its success."""

import json as json_format
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.writing import write_whole
from train.cli.options import MOST_SEED, Configs, Learn, RunStore, check_whole, wide_console

MOST_ROBOTS, MOST_RUNS, MOST_SECONDS = 10_000, 10_000, 1e7
"""The bounds of missions, for scenes as well."""
ARENAS = ("torus", "open")


def run_command(
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
    store: RunStore = None,
    learn: Learn = False,
    configs: Configs = None,
    output: Annotated[Path | None, typer.Option(help="Markdown file to write the table of all goals to.")] = None,
    record: Annotated[
        Path | None, typer.Option(help="Directory for a recording of every run, mechanism and baseline.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Run a goal in its scene and print the measures by which it succeeds, their targets and the baseline."""
    for name, given in (("--option", option), ("--robots", robots), ("--seconds", seconds)):
        if every and given is not None:
            raise ConfigurationError(f"{name}: expected one goal, not --all")
    if output is not None and not every:
        raise ConfigurationError("--output: expected --all, got one goal")
    check_whole({"--robots": (robots, 1, MOST_ROBOTS), "--seed": (seed, 0, MOST_SEED), "--runs": (runs, 1, MOST_RUNS)})
    if seconds is not None and not 0.0 < seconds <= MOST_SECONDS:
        raise ConfigurationError(f"--seconds: expected a positive number up to {MOST_SECONDS:g}, got {seconds:g}")
    if arena is not None and arena not in ARENAS:
        raise ConfigurationError(f"--arena: expected {' or '.join(ARENAS)}, got {arena!r}")
    from clean_swarm_env.scenes import goals  # imports Numba
    from train.goals import goal_tables
    from train.goals.scene_runs import GoalRequest, as_mapping, run_goal
    from train.knowledge_store import StoreRequest
    from train.reports.knowledge_tables import learned_scores
    from train.reports.text_table import on_terminal

    if (goal is None) is not every:
        known = f"; the goals are {', '.join(goals())}" if goal is None else ""
        raise ConfigurationError(f"run: expected a goal or --all, got {'both' if every else 'neither'}{known}")
    outcomes, directories, kept = [], tuple(configs or ()), StoreRequest(store, learn)
    with Console(stderr=True).status("running") as status:
        for name in goals() if every else (str(goal),):
            status.update(f"running {name}")
            kind: Any = arena  # which has been checked
            request = GoalRequest(name, option, robots, seconds, kind, seed, runs, directories, knowledge, kept, record)
            outcomes.append(run_goal(request))
    if json:
        plain = [as_mapping(outcome) for outcome in outcomes]
        typer.echo(json_format.dumps(plain if every else plain[0], indent=2))
    elif output is not None:
        write_whole(output, goal_tables.as_page(outcomes).encode())
        typer.echo(f"{len(outcomes)} goals in {output}")
    else:
        for outcome in outcomes:
            wide_console().print(goal_tables.goal_on_terminal(outcome))
            if outcome.known is not None:
                wide_console().print(on_terminal(learned_scores(outcome.known, "known at the beginning")))
