"""`clean-swarm study` and `tune`: what choosing brings, scores, claims, and a search for parameters of options."""

from pathlib import Path
from typing import Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.listing import check_named
from train.cli.options import (
    MOST_SCENARIOS,
    REPORTING,
    SITUATIONS,
    Family,
    GivenOptions,
    Situations,
    asking,
    check_whole,
    situations_in,
    wide_console,
)
from train.running.commands import FINISHED

COMMON = ("seed", "knowledge", "goal", *REPORTING)
"""Options of headroom, look-ahead and periods."""


@asking(*COMMON)
def headroom_command(
    family: Family,
    situations: Situations = SITUATIONS,
    searched: Annotated[int, typer.Option(help="Training scenarios on which each rule is tried.")] = 16,
    judged: Annotated[int, typer.Option(help="Test scenarios on which the result is judged.")] = 50,
    kinds: Annotated[
        bool, typer.Option("--kinds", help="Choose by a scenario's kind: its spots, stations, consequences.")
    ] = False,
    finalists: Annotated[
        int, typer.Option(help="Options to end the search with, the worse half drops out again and again; 0: all.")
    ] = 0,
    told: Annotated[
        list[str] | None, typer.Option(help="Term of the observation for the rule; can be repeated.")
    ] = None,
    *,
    given: GivenOptions,
) -> None:
    """Search for the best option of each case: what choosing could save."""
    check_whole({"--searched": (searched, 1, MOST_SCENARIOS), "--judged": (judged, 2, MOST_SCENARIOS)})
    check_whole({"--finalists": (finalists, 0, MOST_SCENARIOS)})
    names = () if kinds else situations_in(situations)
    check_named(given.directories, families=family, knowledge=given.values["knowledge"])
    from train.evaluation import pipeline  # imports SciPy and Numba
    from train.evaluation.headroom import HeadroomEvaluation

    request, terms = given.request(family, scenarios=judged), tuple(told or ())
    evaluation = HeadroomEvaluation(request, names, searched, finalists=finalists, told=terms)
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
    from train.evaluation.look_ahead import LookAheadEvaluation, LookingAhead

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
    from train.evaluation.family import FamilyEvaluation

    evaluation = FamilyEvaluation(given.request(family, strategies=tuple(strategy)), periods=period)
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))


def claims_command(
    results: Annotated[list[Path], typer.Argument(help="Directories of `evaluate --family`, one for each family.")],
    strategy: Annotated[list[str], typer.Option(help="Label of a strategy in all of them; can be repeated.")],
    against: Annotated[
        str, typer.Option(help="Label of its yardstick; the best fixed option of each unless given.")
    ] = "",
) -> None:
    """Compare strategies over several families, with intervals and p-values that are corrected for their number."""
    from train.evaluation.claims import claims_over, claims_table  # imports SciPy and Numba
    from train.reports.text_table import TerminalTable

    wide_console().print(TerminalTable(claims_table(*claims_over(results, strategy, against))))


Names = Annotated[
    list[str],
    typer.Argument(
        help="Families, experiments or tasks; a name is looked for in this order, a path is that of a family or an "
        "experiment.",
        metavar="FAMILY|EXPERIMENT|TASK...",
    ),
]


@asking("scenarios", "seed", "knowledge", "share", *REPORTING)
def score_command(
    names: Names,
    store: Annotated[
        str | None,
        typer.Option(help="File of the knowledge store; the one of `learn knowledge` unless given."),
    ] = None,
    *,
    given: GivenOptions,
) -> None:
    """Run every option of each goal on the same scenarios and keep its scores, with their counts and spreads."""
    if given.values["output"] is not None and len(names) > 1:
        raise ConfigurationError(f"--output: expected one name, got {len(names)}")
    from train.evaluation import pipeline  # these import SciPy, Numba and Matplotlib
    from train.memory import StoreRequest, store_path

    console, kept = wide_console(), StoreRequest(store_path(store), learn=True)
    for name in names:
        for evaluation in pipeline.scored_missions(given.request(name, store=kept, scoring=True)):
            code = pipeline.evaluate(evaluation, console)
            if code != FINISHED:
                raise typer.Exit(code)


MOST_TRIALS = 100_000


@asking("seed", "store", *REPORTING)
def tune_command(
    study: Annotated[str, typer.Argument(help="Name of a study, or path to its YAML file.", metavar="STUDY")],
    *,
    given: GivenOptions,
) -> None:
    """Search for parameters and scores of options by missions; a last race on fresh training scenarios decides."""
    check_named(given.directories, studies=study)
    from selector.documents.find import load_file
    from train.studies.config import StudyConfig, study_versions

    study_versions()  # a missing package is an error of one line
    from train.studies.study import run_study

    config = load_file("studies", study, StudyConfig, given.directories)
    raise typer.Exit(run_study(config, given.request(study), wide_console()))


@asking("seed", "knowledge", "store", *REPORTING)
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
