"""The command line of Clean Swarm: `app` has all commands.

A mistake in the input gives one line on the standard error and exit code 2, a full disk one line and exit code 1;
Ctrl-C and the signals by which a system ends programs (`train.cli`) give one line and exit code 130. The commands
import heavy libraries inside their functions, so that help is quick.
"""

import os
import sys
from argparse import ArgumentParser
from collections.abc import Iterator
from contextlib import contextmanager
from errno import ENAMETOOLONG
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from clean_swarm_env import __version__
from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.trust import permission_of, permitting
from selector.documents.writing import DISK_FULL
from selforg.plugins import PluginError, import_named
from train.cli import advise, evaluate, knowledge, listing, look, play, repeat, train, warm
from train.cli.options import error_console, print_error
from train.running.commands import BAD_INPUT, FAILED, INTERRUPTED

TRUST, IMPORT_PLUGIN = "--trust", "--import"
"""Options of all commands: to let files name code, and to import plug-ins."""
THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@contextmanager
def _interruptions_reported() -> Iterator[None]:
    """End with a line and exit code 130 when interrupted; typer alone would write no line."""
    try:
        yield
    except KeyboardInterrupt:
        error_console().print("interrupted")
        raise typer.Exit(INTERRUPTED) from None


PANELS = ("run", "look", "learn")
"""Groups of commands in the help, in this order."""


class _Grouped(TyperGroup):
    """The group of all commands, which its help shows under `PANELS`, one line each."""

    def make_context(self, *words: Any, **more: Any) -> Any:  # noqa: ANN401  (versions of typer differ in the types)
        """Read the words of a command."""
        with _interruptions_reported():
            return super().make_context(*words, **more)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        """Run a command."""
        with _interruptions_reported():
            return super().invoke(ctx)

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401
        """Write the commands, panel by panel."""
        width = max(map(len, self.commands))
        for panel in PANELS:
            own = {name: one for name, one in self.commands.items() if getattr(one, "rich_help_panel", "") == panel}
            with formatter.section(panel):
                for name, command in own.items():
                    formatter.write(f"  {name:<{width}}  {command.short_help}\n")


app = typer.Typer(
    cls=_Grouped,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"max_content_width": 120},
)
COMMANDS: dict[str, dict[str, tuple[Any, str]]] = {
    "run": {
        "advise": (advise.advise_command, "which coordination a mission needs, and whether a selector pays (10 min)"),
        "evaluate": (evaluate.evaluate_command, "an experiment, or strategies on a mission (1 to 60 min)"),
        "list": (listing.list_command, "what there is: kinds, and the names of one kind (seconds)"),
        "play": (play.play_command, "a mission in the browser, changed by hand (starts in seconds)"),
        "warm": (warm.warm_command, "compile everything, once (1 min)"),
    },
    "look": {
        "explain": (repeat.explain_command, "what a robot decided at a time, and why (seconds)"),
        "record": (repeat.record_command, "a run again, into a file (seconds)"),
        "replay": (repeat.replay_command, "a run as a page, or two side by side (seconds)"),
        "video": (look.video_command, "a run as a video (1 min)"),
        "report": (look.report_command, "results as a page with charts (seconds)"),
    },
}
"""Panel -> command -> its function, and what it is for with its usual time."""
GROUPS = {
    "look": (look.app, "look", "picture, draw: a run or a document as a file (seconds)"),
    "train": (train.app, "learn", "ppo, bandit, es, design: which option to choose (2 to 60 min)"),
    "knowledge": (knowledge.app, "learn", "stored scores of options: show, import, export, reset (seconds)"),
}
"""Group of commands -> its commands, its panel, and what it is for."""
for _panel, _commands in COMMANDS.items():
    for _name, (_command, _summary) in _commands.items():
        app.command(_name, short_help=_summary, rich_help_panel=_panel)(_command)
for _name, (_group, _panel, _summary) in GROUPS.items():
    app.add_typer(_group, name=_name, short_help=_summary, rich_help_panel=_panel)


def run_app() -> None:
    """Run the command line and exit with its code."""
    for name in THREAD_LIMITS:  # runs are parallel in processes, which inherit this limit
        os.environ.setdefault(name, "1")
    try:
        os.getcwd()
    except FileNotFoundError:
        print_error("the working directory is gone: change to another one")
        sys.exit(BAD_INPUT)
    anywhere = ArgumentParser(add_help=False, allow_abbrev=False)
    anywhere.add_argument(TRUST, action="store_true")
    anywhere.add_argument(IMPORT_PLUGIN, dest="plugins", action="append", nargs="?", const="", default=[])
    options, words = anywhere.parse_known_args()
    try:
        given = [*words, *(value for name, value in os.environ.items() if name.startswith("CLEAN_SWARM_"))]
        with permitting(permission_of(given, trusted=options.trust)):
            import_named(options.plugins)
            app(words)
    except (ConfigurationError, PluginError) as error:
        print_error(str(error))
        sys.exit(BAD_INPUT)
    except OSError as error:
        if error.errno == ENAMETOOLONG:
            print_error(f"{str(error.filename)[:60]}...: {error.strerror}")
            sys.exit(BAD_INPUT)
        if error.errno not in DISK_FULL:
            raise
        print_error(f"{error.filename or 'the disk'}: cannot be written ({error.strerror}); earlier results stay")
        sys.exit(FAILED)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"clean-swarm {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    _: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
    __: Annotated[
        bool,
        typer.Option(TRUST, help="Run code and open databases that files name (docs/own_plugins.md); anywhere."),
    ] = False,
    ___: Annotated[
        str | None,
        typer.Option(
            IMPORT_PLUGIN,
            help="Import a plug-in: a module or FILE.py (docs/own_plugins.md); anywhere on the line.",
            metavar="NAME",
        ),
    ] = None,
) -> None:
    """Compare and learn the selection of self-organisation mechanisms by teams of robots."""
