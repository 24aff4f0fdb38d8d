"""Parts of several commands: options, checks of numbers, consoles."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError

TABLE_WIDTH = 140
"""Least width of the printed tables [characters]: folded cells are hard to read."""

Configs = Annotated[
    list[Path] | None,
    typer.Option(
        help="Directory of your own files, with experiments/, families/, knowledge/, mechanisms/, missions/, "
        "policies/, robots/, starts/, strategies/, training/; searched before the shipped ones; can be repeated.",
    ),
]


RunStore = Annotated[
    str | None,
    typer.Option(
        help="Begin with what this knowledge store knows: sqlite:///PATH, the path of a file, or postgresql://...",
        metavar="URL",
    ),
]
Learn = Annotated[bool, typer.Option("--learn", help="Give what is learned back to the store.")]


def check_least(given: Mapping[str, tuple[int | None, int]]) -> None:
    """Raise ConfigurationError for a number below the least one allowed; `given`: option -> number and least number."""
    for name, (value, least) in given.items():
        if value is not None and value < least:
            raise ConfigurationError(f"{name}: expected a whole number of at least {least}, got {value}")


def wide_console() -> Console:
    """Return a console for tables."""
    return Console(width=max(Console().width, TABLE_WIDTH), highlight=False, markup=False)


def error_console() -> Console:
    """Return a console on the standard error."""
    return Console(stderr=True, soft_wrap=True, highlight=False)
