"""`clean-swarm study headroom`, `look-ahead` and `periods`: what choosing brings, and how often to choose."""

from typing import Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import (
    KEEPING,
    MOST_SCENARIOS,
    Family,
    GivenOptions,
    asking,
    check_named,
    check_whole,
    wide_console,
)

COMMON = ("seed", "knowledge", "goal", *KEEPING)
"""GivenOptions of all three."""


@asking(*COMMON)
def headroom_command(
    family: Family,
    situations: Annotated[
        str, typer.Option(help="Components of the observation; the largest tells a robot's situation.")
    ] = "free_far,free_near,carrying_far,carrying_near",
    searched: Annotated[int, typer.Option(help="Training scenarios on which each rule is tried.")] = 16,
    judged: Annotated[int, typer.Option(help="Test scenarios on which the result is judged.")] = 50,
    kinds: Annotated[
        bool, typer.Option("--kinds", help="Choose by a scenario's numbers of spots and stations, not by situations.")
    ] = False,
    *,
    given: GivenOptions,
) -> None:
    """Search for the best option of each case: what choosing could save."""
    check_whole({"--searched": (searched, 1, MOST_SCENARIOS), "--judged": (judged, 2, MOST_SCENARIOS)})
    names = () if kinds else tuple(name.strip() for name in situations.split(",") if name.strip())
    if not names and not kinds:
        raise ConfigurationError("--situations: expected components of the observation, got none")
    check_named(given.directories, families=family, knowledge=given.values["knowledge"])
    from train.evaluation import pipeline  # imports SciPy and Numba
    from train.evaluation.choosing.headroom import HeadroomEvaluation, Searched

    evaluation = HeadroomEvaluation(given.request(family, scenarios=judged), Searched(names, searched))
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))


@asking("share", *COMMON, scenarios=30)
def look_ahead_command(
    family: Family,
    base: Annotated[str, typer.Option(help="What copies follow after an option: an option, or policy:NAME.")],
    copies: Annotated[int, typer.Option(help="Copies of the world for each option.")] = 4,
    hold: Annotated[float, typer.Option(help="Seconds for which an option is held.")] = 5.0,
    horizon: Annotated[float, typer.Option(help="Seconds for which copies run.")] = 120.0,
    *,
    given: GivenOptions,
) -> None:
    """Let teams look ahead with copies of their world, beside every option alone."""
    check_whole({"--scenarios": (given.values["scenarios"], 2, MOST_SCENARIOS)})
    check_named(given.directories, families=family, knowledge=given.values["knowledge"])
    from selector.documents.errors import validated  # these import SciPy and Numba
    from train.evaluation import pipeline
    from train.evaluation.choosing.look_ahead import LookAheadEvaluation, LookingAhead

    times = {"base": base, "copies": copies, "hold": hold, "horizon": horizon}
    looking = validated(LookingAhead, times, "look-ahead", own=True)
    raise typer.Exit(pipeline.evaluate(LookAheadEvaluation(given.request(family), looking), wide_console()))


@asking("share", *COMMON, scenarios=20)
def periods_command(
    family: Family,
    strategy: Annotated[list[str], typer.Option(help="As that of `evaluate`; can be repeated.")],
    period: Annotated[
        list[float],
        typer.Option(help="Seconds between two decisions; can be repeated. The others are compared with the first."),
    ],
    *,
    given: GivenOptions,
) -> None:
    """Compare strategies that decide more or less often, and hold their options meanwhile."""
    check_whole({"--scenarios": (given.values["scenarios"], 2, MOST_SCENARIOS)})
    if len(set(period)) < max(len(period), 2):
        raise ConfigurationError(f"--period: expected at least two different ones, got {period}")
    check_named(given.directories, strategy, families=family, knowledge=given.values["knowledge"])
    from train.evaluation import pipeline  # imports SciPy and Numba
    from train.evaluation.choosing.periods import PeriodsEvaluation

    evaluation = PeriodsEvaluation(given.request(family, strategies=tuple(strategy)), period)
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))
