"""`clean-swarm study` and `tune`: what choosing brings, scores, claims, and a search for parameters of options."""

from pathlib import Path
from typing import Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.listing import check_named
from train.cli.options import (
    KEEPING,
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


@asking("seed", "knowledge", "goal", *REPORTING)
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


@asking("scenarios", "seed", "knowledge", *REPORTING)
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


@asking("seed", "store", *KEEPING, "every_table")
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
