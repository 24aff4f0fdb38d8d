"""Parts of several commands: the options that they share, checks of numbers, consoles.

A command names the options that it shares with others (`asking`). It gets what was given for them as `GivenOptions`, of
which it makes the one `Request`. Libraries that take seconds are imported only then.
"""

import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.plain import short

if TYPE_CHECKING:  # imports Numba
    from train.request import Request

FILE_WIDTH = 10_000
"""Width of what is printed into a file or a pipe [characters]: nothing is folded there."""
MOST_SEED = 2**63 - 1
MOST_SCENARIOS = 10_000
MAY_NAME_CODE = "only with --trust may files name code, models that are code, or databases (docs/own_plugins.md)"
"""What the help of options says whose files may name code."""

Configs = Annotated[
    list[Path] | None,
    typer.Option(
        help=f"Directory of your own files, in folders as configs/ has them; can be repeated; {MAY_NAME_CODE}.",
    ),
]
Seed = Annotated[int, typer.Option(help="Seed of everything random.")]

SHARED: dict[str, tuple[Any, Any]] = {
    "scenarios": (
        Annotated[int | None, typer.Option(help="Number of scenarios; usually the document's.")],
        None,
    ),
    "seed": (Seed, 0),
    "knowledge": (Annotated[str | None, typer.Option(help="Expert knowledge in place of the mission's.")], None),
    "goal": (
        Annotated[
            str | None,
            typer.Option(help="Goals to decide, joined by +; usually AvoidCollision."),
        ],
        None,
    ),
    "workers": (
        Annotated[int | None, typer.Option(help="Processes to run in; usually all CPUs.")],
        None,
    ),
    "threads": (Annotated[int, typer.Option(help="Threads that step the worlds; the same bits with any number.")], 1),
    "output": (
        Annotated[Path | None, typer.Option(help="Directory for the results; usually a new one.")],
        None,
    ),
    "resume": (Annotated[bool, typer.Option("--resume", help="Do only what the directory lacks.")], False),
    "store": (
        Annotated[
            str | None,
            typer.Option(help="Begin with what this knowledge store knows.", metavar="FILE"),
        ],
        None,
    ),
    "learn": (Annotated[bool, typer.Option("--learn", help="Give learned rewards back to the store.")], False),
    "record": (
        Annotated[bool, typer.Option("--record", help="Record the missions, for `clean-swarm replay`.")],
        False,
    ),
    "minds": (
        Annotated[bool, typer.Option("--minds", help="Record what the robots' networks decide, too.")],
        False,
    ),
    "on": (
        Annotated[
            str | None,
            typer.Option(
                help="Run on a Dask scheduler, or in JOBS jobs of slurm, pbs, lsf or sge (docs/clusters.md).",
                metavar="tcp://HOST:PORT|SCHEDULER:JOBS",
            ),
        ],
        None,
    ),
    "force": (
        Annotated[
            bool,
            typer.Option("--force", help="Start even if it may be too large for this machine."),
        ],
        False,
    ),
    "every_table": (
        Annotated[bool, typer.Option("--all", help="Print all tables; table.md has them anyway.")],
        False,
    ),
    "configs": (Configs, None),
}
"""Options that commands share: name -> type and help, default."""
KEEPING = ("output", "resume", "workers", "on", "force", "configs")
"""Options of all commands that do missions and keep results."""
REPORTING = (*KEEPING, "every_table")
"""Options of those that report on them."""
TAKEN_OVER = ("scenarios", "seed", "knowledge", "goal", "output", "resume", "every_table")
"""Those that a request has as they are given."""
BOUNDS = {"scenarios": (1, MOST_SCENARIOS), "seed": (0, MOST_SEED), "workers": (1, 1000), "threads": (1, 1000)}
"""Least and largest number."""


@dataclass(frozen=True)
class GivenOptions:
    """What the user gave for the shared options of a command."""

    values: Mapping[str, Any]

    @property
    def directories(self) -> tuple[Path, ...]:
        """The user's own directories of configurations."""
        return tuple(self.values["configs"] or ())

    def request(self, name: str, **more: Any) -> "Request":  # noqa: ANN401  (fields of a request)
        """Return the request for an experiment, a family or a training, with `more` of its fields."""
        from clean_swarm_env.learning.warm_up import usable_cpus
        from clean_swarm_env.recording.recorder import RecordSettings  # these import Numba
        from train.memory import StoreRequest
        from train.request import Request
        from train.running.needs import Machine
        from train.running.run_folder import RECORDINGS

        value, minds = self.values.get, self.values.get("minds", False)
        workers = value("workers") or (usable_cpus() if "workers" in self.values else 1)
        settings = {
            **{name: given for name, given in self.values.items() if name in TAKEN_OVER},
            "directories": self.directories,
            "store": StoreRequest(value("store"), value("learn", False)),
            "record": RecordSettings(Path(RECORDINGS), minds) if minds or value("record") else None,
            "machine": Machine(workers, value("force", False), value("on"), value("threads", 1)),
            "words": ("clean-swarm", *sys.argv[1:]),
        }
        return Request(name, **{**settings, **more})

    def check(self) -> None:
        """Raise ConfigurationError for numbers out of bounds, and for options that exclude each other."""
        value = self.values.get
        check_whole({f"--{name}": (value(name), *bounds) for name, bounds in BOUNDS.items()})
        if value("learn") and value("on") is not None:
            raise ConfigurationError("--on: expected no --learn, where missions learn in turn")


def asking(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the shared options of these names; it gets what is given for them, checked, as `given`."""

    def with_options(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command).parameters.values()
        shared = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
            for name, (annotation, default) in SHARED.items()
            if name in names
        ]

        @wraps(command)
        def with_given(**words: Any) -> None:  # noqa: ANN401  (values of options)
            given = GivenOptions({one.name: words.pop(one.name) for one in shared})
            given.check()
            command(**words, given=given)

        parameters = [*(one for one in own if one.name != "given"), *shared]
        with_given.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        with_given.__annotations__ = {one.name: one.annotation for one in parameters}
        del with_given.__wrapped__
        return with_given

    return with_options


def check_whole(given: Mapping[str, tuple[int | None, int, int]]) -> None:
    """Raise ConfigurationError for a number out of bounds; `given`: option -> number, least and largest number."""
    for name, (value, least, most) in given.items():
        if value is not None and not least <= value <= most:
            which = f"at least {least}" if value < least else f"at most {most}"
            raise ConfigurationError(f"{name}: expected a whole number of {which}, got {short(value)}")


def check_there(*paths: Path | None, where: str = "") -> None:
    """Raise ConfigurationError for a file or directory that is not there, before slow libraries are imported."""
    for path in paths:
        if path is not None and not path.exists():
            raise ConfigurationError(f"{where}{path}: cannot be read (No such file or directory)")


def wide_console() -> Console:
    """Return a console for tables: as wide as the terminal, or as they need in a file."""
    found = Console(highlight=False, markup=False, emoji=False)
    return found if found.is_terminal else Console(width=FILE_WIDTH, highlight=False, markup=False, emoji=False)


def print_error(text: str) -> None:
    """Print the text of an error on the standard error, without markup."""
    error_console().print(f"error: {text}", markup=False, emoji=False)


def error_console() -> Console:
    """Return a console on the standard error."""
    return Console(stderr=True, soft_wrap=True, highlight=False, emoji=False)
