"""`clean-swarm report`: the results in a directory, or in two, as one page."""

from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import typer

from clean_swarm_env.config.types import ConfigurationError


def report_command(
    directories: Annotated[
        list[Path],
        typer.Argument(help="Directories of evaluations or of trainings: one, or two.", metavar="DIR [DIR2]"),
    ],
    output: Annotated[
        Path | None, typer.Option(help="Page to write, one that exists is replaced; DIR/report.html unless given.")
    ] = None,
    replays: Annotated[
        bool,
        typer.Option("--replays", help="Write a page for each recorded run of an evaluation, and link it."),
    ] = False,
) -> None:
    """Write results as one page without network: tables, distributions, differences, curves, selection, scenarios."""
    from selector.documents.writing import write_whole
    from train.replay.page_file import write_page
    from train.report_page.page import report_of_results  # imports SciPy
    from train.report_page.results import results_in

    if len(directories) > 2:
        raise ConfigurationError(f"report: expected one or two directories, got {len(directories)}")
    results = [results_in(directory) for directory in directories]
    if replays and not results[0].records:
        raise ConfigurationError("--replays: expected an evaluation, got a training; `replay` shows one recording")
    page = output or directories[0] / "report.html"
    folder = page.with_name(f"{page.stem}-replays")
    links: dict[str, str] = {}
    for held in results if replays else []:
        for recording in held.recordings:
            about = recording.head["about"]
            label = f"{held.path.name}: " if len(results) > 1 else ""
            path = folder / f"{len(links) + 1}-{recording.path.stem}.html"
            write_page([recording], path)
            links[f"{about.get('scenario')}-{label}{about.get('condition')}"] = quote(f"{folder.name}/{path.name}")
    write_whole(page, report_of_results(results, links).encode())
    typer.echo(f"{page}: open it in a browser")
