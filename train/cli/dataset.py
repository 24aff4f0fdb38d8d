"""`clean-swarm learn dataset`: missions as a Minari dataset."""

from typing import Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import MOST_SCENARIOS, MOST_SEED, GivenOptions, asking, check_whole, error_console


@asking("seed", "configs")
def dataset_command(
    name: Annotated[str, typer.Argument(help="Name of the dataset, as Minari has it: group/name-v0.")],
    family: Annotated[str, typer.Option(help="Family of the missions: a name or a path.")] = "table1",
    size: Annotated[
        tuple[float, float] | None, typer.Option(help="Width and height of the torus, for a family with several [m].")
    ] = None,
    strategy: Annotated[
        str, typer.Option(help="Who decides, as in `evaluate --strategy`; one member, not learning.")
    ] = "Random",
    missions: Annotated[int, typer.Option(help="Number of missions; their seeds follow on the first.")] = 10,
    *,
    given: GivenOptions,
) -> None:
    """Run missions and keep every observation, action, reward and info as a Minari dataset (extra `minari`)."""
    check_whole({"--missions": (missions, 1, MOST_SCENARIOS)})
    check_whole({"--seed": (given.values["seed"], 0, MOST_SEED - MOST_SCENARIOS)})
    if strategy == "fixed" or "+" in strategy:
        raise ConfigurationError(f"--strategy: expected one strategy, such as fixed:OPTION, got {strategy!r}")
    from train.learning.dataset import write_dataset  # imports Numba

    request = given.request(family, strategies=(strategy,), scenarios=missions)
    with error_console().status("running") as status:
        done = iter(range(1, missions + 1))
        text, decisions = write_dataset(
            name, request, size, lambda: status.update(f"{next(done)} of {missions} missions")
        )
    typer.echo(text)
    typer.echo(f"{missions} missions, {decisions} decisions in the Minari dataset {name}")
