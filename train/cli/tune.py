"""`clean-swarm tune` and `study configure`: search for parameters of options by missions."""

from typing import Annotated

import typer

from train.cli.options import KEEPING, GivenOptions, asking, check_named, check_whole, wide_console

MOST_TRIALS = 100_000


@asking("seed", "store", *KEEPING)
def tune_command(
    study: Annotated[str, typer.Argument(help="Name of a study, or path to its YAML file.", metavar="STUDY")],
    *,
    given: GivenOptions,
) -> None:
    """Search for parameters and scores of options by missions; a last race on fresh training scenarios decides."""
    check_named(given.directories, studies=study)
    from train.studies.config import load_study, study_versions

    study_versions()  # a missing package is an error of one line
    from train.studies.study import run_study

    raise typer.Exit(run_study(load_study(study, given.directories), given.request(study), wide_console()))


@asking("seed", "knowledge", "store", *KEEPING)
def configure_command(
    option: Annotated[str, typer.Argument(help="Name of an option of the expert knowledge.", metavar="OPTION")],
    family: Annotated[str, typer.Option(help="Family of scenarios, by name or by path.")],
    method: Annotated[str, typer.Option(help="random, TPE, CMA-ES, NSGA-II or MAP-Elites.")] = "TPE",
    trials: Annotated[int, typer.Option(help="Candidates of each method.")] = 60,
    *,
    given: GivenOptions,
) -> None:
    """Configure an option for a family: a study of all its numbers and flags, from a quarter to four times each."""
    check_whole({"--trials": (trials, 2, MOST_TRIALS)})
    knowledge = given.values["knowledge"]
    check_named(given.directories, families=family, knowledge=knowledge)
    from train.studies.config import study_versions

    study_versions()
    from train.studies.configured import configured_study
    from train.studies.study import run_study

    changes = {"method": method, "trials": trials}
    study = configured_study(option, family, knowledge, changes, given.directories)
    raise typer.Exit(run_study(study, given.request(option), wide_console()))
