"""Parts of several commands: options, checks of numbers, consoles."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.load import named_file
from selector.documents.find import find_file
from selector.documents.plain import short
from selector.documents.trust import FOREIGN_ENDINGS

MEMBER_FILES = {"policy": "policies", "learned": "strategies", "fsm": "machines"}
"""Kind of a strategy -> kind of its file."""
TABLE_WIDTH = 140
"""Least width of the printed tables [characters]: folded cells are hard to read."""

Configs = Annotated[
    list[Path] | None,
    typer.Option(
        help="Directory of your own files, with experiments/, families/, knowledge/, mechanisms/, missions/, "
        "policies/, robots/, starts/, strategies/, studies/, training/; searched before the shipped ones; can be "
        "repeated.",
    ),
]

MOST_SEED = 2**63 - 1
MOST_SCENARIOS = 10_000
MOST_WORKERS = 1000
MOST_WORLD_SEEDS = 100

Family = Annotated[str, typer.Argument(help="Name of a family, or path to its YAML file.")]
GoalText = Annotated[
    str | None, typer.Option(help="Goal to decide on, or several joined by +; AvoidCollision unless given.")
]
OtherKnowledge = Annotated[str | None, typer.Option(help="Expert knowledge in place of the family's own.")]
Seed = Annotated[int, typer.Option(help="Seed of everything random.")]
Workers = Annotated[int | None, typer.Option(help="Processes to run in; all usable CPUs unless given.")]
Output = Annotated[Path | None, typer.Option(help="Directory for the results; a new one below results/ unless given.")]
Resume = Annotated[bool, typer.Option("--resume", help="Do only the runs that the directory lacks.")]
Force = Annotated[
    bool, typer.Option("--force", help="Start even what is estimated to need more memory than there is, or a week.")
]
RunStore = Annotated[
    str | None,
    typer.Option(
        help="Begin with what this knowledge store knows: sqlite:///PATH, the path of a file, or postgresql://...",
        metavar="URL",
    ),
]
ShareText = Annotated[
    str | None,
    typer.Option(
        "--share",
        help="Do the I-th of N parts of the runs, beside the other parts in --output; `gather` merges them.",
        metavar="I/N",
    ),
]
OnPlace = Annotated[
    str | None,
    typer.Option(
        "--on",
        help="Run missions on the workers of a Dask scheduler, or of up to JOBS jobs of SLURM (extra `cluster`).",
        metavar="tcp://HOST:PORT|slurm:JOBS",
    ),
]
AnyBits = Annotated[
    bool, typer.Option("--any-bits", help="Take machines on which missions end differently, and note them.")
]
Learn = Annotated[bool, typer.Option("--learn", help="Give what is learned back to the store.")]


def check_share(share: str | None, output: Path | None, *, learn: bool = False) -> None:
    """Raise ConfigurationError for a share without a directory, or of missions that learn in turn."""
    if share is not None and output is None:
        raise ConfigurationError("--share: expected --output, the directory of all shares")
    if share is not None and learn:
        raise ConfigurationError("--share: expected no --learn, where missions learn in turn")


def check_whole(given: Mapping[str, tuple[int | None, int, int]]) -> None:
    """Raise ConfigurationError for a number out of bounds; `given`: option -> number, least and largest number."""
    for name, (value, least, most) in given.items():
        if value is not None and value < least:
            raise ConfigurationError(f"{name}: expected a whole number of at least {least}, got {short(value)}")
        if value is not None and value > most:
            raise ConfigurationError(f"{name}: expected a whole number of at most {most}, got {short(value)}")


def check_named(configs: Sequence[Path] | None, strategies: Sequence[str] | None = None, **given: str | None) -> None:
    """Raise the error of a name that no file has, before libraries are imported that take seconds; kind -> name."""
    directories = tuple(configs or ())
    for kind, name in given.items():
        if name is not None and kind == "families":
            named_file(kind, name, directories)
        elif name is not None:
            find_file(kind, name, directories)
    for text in strategies or ():
        kind, _, names = (text if ":" in text.partition("=")[0] else text.partition("=")[2] or text).partition(":")
        for name in names.split("+") if kind in MEMBER_FILES and not names.endswith(FOREIGN_ENDINGS) else ():
            find_file(MEMBER_FILES[kind], name, directories, f"--strategy {text}: ")


def wide_console() -> Console:
    """Return a console for tables."""
    return Console(width=max(Console().width, TABLE_WIDTH), highlight=False, markup=False)


def print_error(text: str) -> None:
    """Print the text of an error on the standard error, without markup."""
    error_console().print(f"error: {text}", markup=False, emoji=False)


def error_console() -> Console:
    """Return a console on the standard error."""
    return Console(stderr=True, soft_wrap=True, highlight=False)
