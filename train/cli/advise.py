"""`clean-swarm advise`: which coordination a mission needs, and whether a learned selector is worth it."""

import os
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from selforg.plugins import named_plugins
from train.cli.listing import check_named
from train.cli.options import REPORTING, GivenOptions, asking, check_whole, wide_console
from train.running.commands import FINISHED

if TYPE_CHECKING:  # imports Numba
    from train.request import Request

MOST_MINUTES, LEAST_MISSIONS, MOST_MISSIONS = 1e5, 100, 1_000_000
ADVICE = Path("advice")
"""Where advice is written unless another directory is named."""


@asking("seed", "knowledge", *REPORTING)
def advise_command(
    mission: Annotated[
        str,
        typer.Argument(
            help="Name of a mission, family, experiment or task, or path to its YAML file.", metavar="MISSION"
        ),
    ],
    minutes: Annotated[float, typer.Option(help="Time of processors for all missions [min].")] = 10.0,
    missions: Annotated[
        int | None,
        typer.Option(
            help="In place of --minutes: missions of the search, so that any machine gives the same advice; "
            "some 400 are done at least, and up to twice as many where few are given."
        ),
    ] = None,
    kinds: Annotated[
        bool, typer.Option("--kinds", help="Of a family: also say what is best for each kind of its scenarios.")
    ] = False,
    robust: Annotated[
        bool,
        typer.Option(
            "--robust",
            help="Also do what is judged in ten perturbed worlds: lost and late messages, slip, errors. "
            "These are some 800 missions beside --minutes.",
        ),
    ] = False,
    learn: Annotated[
        bool,
        typer.Option("--learn", help="Then train a selector for the mission, judge it, and ship it if it is better."),
    ] = False,
    training: Annotated[float, typer.Option(help="With --learn: time of processors for all trainings [min].")] = 5.0,
    *,
    given: GivenOptions,
) -> None:
    """Say which options the robots of a mission should hold, how sure that is, and whether changing them pays."""
    for name, value in {"--minutes": minutes, "--training": training}.items():
        if not 0.0 < value <= MOST_MINUTES:
            raise ConfigurationError(f"{name}: expected a positive number up to {MOST_MINUTES:g}, got {value:g}")
    check_whole({"--missions": (missions, LEAST_MISSIONS, MOST_MISSIONS)})
    check_named(given.directories, name=mission, knowledge=given.values["knowledge"])
    from train.advising.evaluation import AdviceEvaluation  # these import SciPy and Numba
    from train.evaluation import pipeline
    from train.running.run_folder import default_directory

    resume = given.values["resume"]
    output = given.values["output"] or default_directory(Path(mission).stem, resume=resume, root=ADVICE)
    if learn:
        from train.learning.session import check_installed

        check_installed("ppo")
    request = with_other_starts(given.request(mission, output=output))
    evaluation = AdviceEvaluation(request, minutes, missions, kinds=kinds, robust=robust)
    console = wide_console()
    code = pipeline.evaluate(evaluation, console)
    if code == FINISHED and not evaluation.nothing_to_choose:
        for line in use_of(mission, output, given.directories, request.seed + 1, family=evaluation.of_family):
            console.print(line, soft_wrap=True)
        if learn:
            from train.advising.learning import train_selector  # imports torch

            code = train_selector(evaluation, training, console)
    raise typer.Exit(code)


def with_other_starts(request: "Request") -> "Request":
    """Return a request whose starts are others than those of the advice with whose knowledge it begins."""
    from train.running.run_folder import MANIFEST, read_manifest

    before = Path(request.knowledge or "")
    if request.knowledge is None or not (before / MANIFEST).is_file():
        return request
    seed = read_manifest(before).get("identity", {}).get("seed")
    return replace(request, seed=request.seed + 1) if seed == request.seed else request


def use_of(mission: str, folder: Path, directories: Sequence[Path], seed: int, *, family: bool) -> list[str]:
    """Return how the advice in a folder is used, line by line; `seed`: of starts that it was not made from."""
    used = str(folder) if os.sep in str(folder) else f".{os.sep}{folder}"  # a path, and no name
    more = [word for path in directories for word in ("--configs", str(path))]
    more += [word for name in named_plugins() for word in ("--import", name)]
    command = shlex.join(["clean-swarm", "evaluate", mission, "--knowledge", used, "--seed", str(seed), *more])
    given = f"family={mission!r}" if family else repr(mission)
    return [
        f"use it:  {command} --strategy MaxScore",
        f"         clean_swarm_v0.parallel_env({given}, knowledge={used!r})",
        f"         {shlex.join(['clean-swarm', 'play', used, *more])}",
    ]
