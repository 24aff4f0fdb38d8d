"""`clean-swarm headroom`: what choosing by the situation can save on a family, beside the best single choice."""

from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import MOST_SCENARIOS, MOST_SEED, Configs, check_whole, wide_console


def headroom_command(
    family: Annotated[str, typer.Argument(help="Name of a family, or path to its YAML file.")],
    situations: Annotated[
        str, typer.Option(help="Components of the observation; the largest tells a robot's situation.")
    ] = "free_far,free_near,carrying_far,carrying_near",
    searched: Annotated[int, typer.Option(help="Training scenarios on which each rule is tried.")] = 16,
    judged: Annotated[int, typer.Option(help="Test scenarios on which the result is judged.")] = 50,
    seed: Annotated[int, typer.Option(help="Seed of everything random.")] = 0,
    knowledge: Annotated[str | None, typer.Option(help="Expert knowledge in place of the family's own.")] = None,
    goal: Annotated[
        str | None, typer.Option(help="Goal to decide on, or several joined by +; AvoidCollision unless given.")
    ] = None,
    spots: Annotated[
        bool, typer.Option("--spots", help="Choose by the scenario's number of spots of garbage, not by situations.")
    ] = False,
    terms: Annotated[
        str, typer.Option(help="Terms of the observation beside the default ones, for their components.")
    ] = "",
    configs: Configs = None,
) -> None:
    """Search for the best option of each case, and compare it with the best single option, Off and Random."""
    check_whole({"--searched": (searched, 1, MOST_SCENARIOS), "--judged": (judged, 2, MOST_SCENARIOS)})
    check_whole({"--seed": (seed, 0, MOST_SEED)})
    names = () if spots else _names(situations)
    if not names and not spots:
        raise ConfigurationError("--situations: expected components of the observation, got none")
    from clean_swarm_env.config.load import load_family  # imports SciPy and Numba
    from train.evaluation.headroom import HeadroomRequest, headroom_of, headroom_table
    from train.reports.text_table import on_terminal

    directories = tuple(configs or ())
    known = load_family(family, directories).with_knowledge(knowledge)
    request = HeadroomRequest(known, names, seed, searched, judged, goal, _names(terms), directories)
    wide_console().print(on_terminal(headroom_table(headroom_of(request), known.name)))


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())
