"""`clean-swarm headroom`, `look-ahead` and `periods`: what choosing brings on a family, and how often to choose."""

from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import (
    MOST_SCENARIOS,
    MOST_SEED,
    Configs,
    Family,
    GoalText,
    OtherKnowledge,
    Seed,
    check_named,
    check_whole,
    wide_console,
)

MOST_COPIES, MOST_TIME = 1000, 1e6
"""Most copies of a world, and longest times [s]."""


def headroom_command(
    family: Family,
    situations: Annotated[
        str, typer.Option(help="Components of the observation; the largest tells a robot's situation.")
    ] = "free_far,free_near,carrying_far,carrying_near",
    searched: Annotated[int, typer.Option(help="Training scenarios on which each rule is tried.")] = 16,
    judged: Annotated[int, typer.Option(help="Test scenarios on which the result is judged.")] = 50,
    seed: Seed = 0,
    knowledge: OtherKnowledge = None,
    goal: GoalText = None,
    kinds: Annotated[
        bool, typer.Option("--kinds", help="Choose by a scenario's numbers of spots and stations, not by situations.")
    ] = False,
    configs: Configs = None,
) -> None:
    """Search for the best option of each case, and compare it with the best single option, Off and Random."""
    check_whole({"--searched": (searched, 1, MOST_SCENARIOS), "--judged": (judged, 2, MOST_SCENARIOS)})
    check_whole({"--seed": (seed, 0, MOST_SEED)})
    names = () if kinds else tuple(name.strip() for name in situations.split(",") if name.strip())
    if not names and not kinds:
        raise ConfigurationError("--situations: expected components of the observation, got none")
    check_named(configs, families=family, knowledge=knowledge)
    from clean_swarm_env.config.load import load_family  # imports SciPy and Numba
    from train.evaluation.choosing.headroom import HeadroomRequest, headroom_of, headroom_table
    from train.reports.text_table import on_terminal

    directories = tuple(configs or ())
    known = load_family(family, directories).with_knowledge(knowledge)
    request = HeadroomRequest(known, names, seed, searched, judged, goal, directories)
    wide_console().print(on_terminal(headroom_table(headroom_of(request), known.name)))


def look_ahead_command(
    family: Family,
    base: Annotated[str, typer.Option(help="What copies follow after an option: an option, or policy:NAME.")],
    scenarios: Annotated[int, typer.Option(help="Test scenarios.")] = 30,
    copies: Annotated[int, typer.Option(help="Copies of the world for each option.")] = 4,
    hold: Annotated[float, typer.Option(help="Seconds for which an option is held.")] = 5.0,
    horizon: Annotated[float, typer.Option(help="Seconds for which copies run.")] = 120.0,
    seed: Seed = 0,
    knowledge: OtherKnowledge = None,
    goal: Annotated[str | None, typer.Option(help="Goal to decide on; AvoidCollision unless given.")] = None,
    configs: Configs = None,
) -> None:
    """Let teams look ahead with copies of their world, and compare what it costs with every option alone."""
    check_whole({"--scenarios": (scenarios, 2, MOST_SCENARIOS), "--seed": (seed, 0, MOST_SEED)})
    check_whole({"--copies": (copies, 1, MOST_COPIES)})
    for name, time in (("--hold", hold), ("--horizon", horizon)):
        if not 0.0 < time <= MOST_TIME:
            raise ConfigurationError(f"{name}: expected more than 0 s and at most {MOST_TIME:g} s, got {time:g}")
    check_named(configs, families=family, knowledge=knowledge)
    from clean_swarm_env.config.load import load_family  # imports SciPy and Numba
    from train.evaluation.choosing.look_ahead import LookAheadRequest, look_ahead_table
    from train.reports.text_table import on_terminal

    directories = tuple(configs or ())
    known = load_family(family, directories).with_knowledge(knowledge)
    request = LookAheadRequest(known, base, seed, scenarios, copies, hold, horizon, goal, directories)
    wide_console().print(on_terminal(look_ahead_table(request)))


def periods_command(
    family: Family,
    strategy: Annotated[list[str], typer.Option(help="As that of `evaluate`; can be repeated.")],
    period: Annotated[
        list[float],
        typer.Option(help="Seconds between two decisions; can be repeated. The others are compared with the first."),
    ],
    scenarios: Annotated[int, typer.Option(help="Test scenarios.")] = 20,
    seed: Seed = 0,
    knowledge: OtherKnowledge = None,
    goal: GoalText = None,
    configs: Configs = None,
) -> None:
    """Compare strategies that decide more or less often, and hold their options meanwhile."""
    check_whole({"--scenarios": (scenarios, 2, MOST_SCENARIOS), "--seed": (seed, 0, MOST_SEED)})
    if len(set(period)) < max(len(period), 2):
        raise ConfigurationError(f"--period: expected at least two different ones, got {period}")
    check_named(configs, families=family, knowledge=knowledge)
    from clean_swarm_env.config.load import load_family  # imports SciPy and Numba
    from train.evaluation.choosing.periods import PeriodsRequest, periods_table
    from train.evaluation.family import FamilyRequest
    from train.reports.text_table import on_terminal

    directories = tuple(configs or ())
    known = load_family(family, directories).with_knowledge(knowledge)
    request = FamilyRequest(family, tuple(strategy), seed, scenarios, goal=goal, directories=directories)
    wide_console().print(on_terminal(periods_table(PeriodsRequest(known, request, tuple(period)))))
