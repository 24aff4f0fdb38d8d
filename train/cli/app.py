"""The command line of Clean Swarm: `app` has all commands.

A mistake in the input gives one line on the standard error and exit code 2, a full disk one line and exit code 1;
Ctrl-C and the signals by which a system ends programs (`train.cli`) give one line and exit code 130. The commands
import heavy libraries inside their functions, so that help is quick.
"""

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.tasks import import_tasks, task_stories
from selector.documents.find import KINDS, SHIPPED, files_of
from selector.documents.plain import plain
from selector.documents.reading import read_mapping
from selector.documents.trust import permission_of, permitting
from selector.documents.writing import DISK_FULL
from train.cli import (
    claims,
    configure,
    dataset,
    draw,
    evaluate,
    headroom,
    knowledge,
    play,
    repeat,
    run,
    score,
    train,
    tune,
)
from train.cli.cluster import gather, script, warm
from train.cli.options import Configs, error_console, print_error
from train.cli.showing import picture, report, video
from train.running.exit_codes import BAD_INPUT, FAILED, INTERRUPTED

TRUST, IMPORT = "--trust", "--import"
"""Options of all commands: to let files name code, and to read tasks of the user's own from a file."""
DECLARED = {
    "strategies by name": ("selector/strategies", r"@STRATEGIES\.register\nclass (\w+)"),
    "mechanisms by name": (
        "selforg/mechanisms",
        r"(?m)^(?:@MECHANISMS\.register\nclass |\w+ = \w+\.variant\(\s*\")(\w+)",
    ),
    "terms of observations": (
        "clean_swarm_env/learning/observation",
        r"(?m)^(?:    name = |@compiled_term\(\s*)\"(\w+)\"",
    ),
}
"""What is listed -> folder and pattern of the sources that declare it: importing them takes seconds."""
THREAD_LIMITS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


class _Interruptible(TyperGroup):
    """A group that ends with a line and exit code 130 when it is interrupted; typer alone would write no line."""

    def make_context(self, *words: Any, **more: Any) -> Any:  # noqa: ANN401  (versions of typer differ in the types)
        """Read the words of a command."""
        with _interruptions_reported():
            return super().make_context(*words, **more)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        """Run a command."""
        with _interruptions_reported():
            return super().invoke(ctx)


@contextmanager
def _interruptions_reported() -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        error_console().print("interrupted")
        raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=_Interruptible,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command("evaluate")(evaluate.evaluate_command)
app.add_typer(knowledge.app, name="knowledge")
app.add_typer(train.app, name="train")
app.command("run")(run.run_command)
app.command("score")(score.score_command)
app.command("tune")(tune.tune_command)
app.command("configure")(configure.configure_command)
app.command("claims")(claims.claims_command)
app.command("headroom")(headroom.headroom_command)
app.command("look-ahead")(headroom.look_ahead_command)
app.command("periods")(headroom.periods_command)
app.command("gather")(gather.gather_command)
app.add_typer(script.app, name="script")
app.command("warm")(warm.warm_command)
app.command("draw")(draw.draw_command)
app.command("dataset")(dataset.dataset_command)
app.command("explain")(repeat.explain_command)
app.command("record")(repeat.record_command)
app.command("replay")(repeat.replay_command)
app.command("play")(play.play_command)
app.command("picture")(picture.picture_command)
app.command("video")(video.video_command)
app.command("report")(report.report_command)
app.command("export")(repeat.export_command)


def run_app() -> None:
    """Run the command line and exit with its code."""
    for name in THREAD_LIMITS:  # runs are parallel in processes, which inherit this limit
        os.environ.setdefault(name, "1")
    # --trust and --import may stand anywhere; in the command of a script they stay where they are
    words, files = (sys.argv[1:], []) if sys.argv[1:2] == ["script"] else _imports(sys.argv[1:])
    words = sorted(words, key=lambda word: word != TRUST and words[0] != "script")
    try:
        given = [*words, *(value for name, value in os.environ.items() if name.startswith("CLEAN_SWARM_"))]
        with permitting(permission_of(given, trusted=words[:1] == [TRUST])):
            if files:
                import_tasks(files)
            app(words)
    except ConfigurationError as error:
        print_error(str(error))
        sys.exit(BAD_INPUT)
    except OSError as error:
        if error.errno not in DISK_FULL:
            raise
        print_error(f"{error.filename or 'the disk'}: cannot be written ({error.strerror}); what was done before stays")
        sys.exit(FAILED)


def _imports(words: list[str]) -> tuple[list[str], list[str]]:
    """Return the words of a command without `--import FILE`, and the files."""
    rest, files, following = [], [], False
    for word in words:
        option, equals, file = word.partition("=")
        if following or (option == IMPORT and equals):
            files.append(word if following else file)
        elif word != IMPORT:
            rest.append(word)
        following = word == IMPORT and not following
    return rest, files


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"clean-swarm {version('clean-swarm')}")
        raise typer.Exit


@app.callback()
def _common(
    _: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
    __: Annotated[
        bool,
        typer.Option(TRUST, help="Run code and open databases that files name (docs/trust.md); stands anywhere."),
    ] = False,
    ___: Annotated[
        str | None,
        typer.Option(IMPORT, help="Read tasks from a Python file of your own; stands anywhere.", metavar="FILE.py"),
    ] = None,
) -> None:
    """Compare and learn the selection of self-organisation mechanisms by robots that clean a torus."""


@app.command("list")
def list_everything(configs: Configs = None) -> None:
    """List the experiments with their conditions, the families of scenarios, and the names of all else."""
    directories = tuple(configs or ())
    for name, path in files_of("experiments", directories).items():
        content = read_mapping(path)
        scenarios, held = content.get("scenarios", 30), ", ".join(_names(content.get("conditions")))
        typer.echo(f"{plain(name)}: {plain(str(content.get('description', '')))}")
        if "disturbances" in content:
            kinds = ", ".join(dict.fromkeys(_names(content["disturbances"], "kind")))
            typer.echo(f"  {plain(str(scenarios))} random scenarios; disturbances: {plain(kinds)}")
        else:
            starts = f"those of {content['starts']}" if "starts" in content else f"{scenarios} random"
            typer.echo(f"  {plain(str(starts))} start configurations; conditions: {plain(held)}")
    typer.echo("families of scenarios:")
    for name, path in files_of("families", directories).items():
        typer.echo(f"  {plain(name)}: {plain(str(read_mapping(path).get('description', '')))}")
    for kind in sorted(KINDS.keys() - {"experiments", "families"}):
        if names := files_of(kind, directories):
            typer.echo(f"{kind}: {plain(', '.join(names))}")
    typer.echo("tasks, whose names are those of missions and families, too:")
    for name, story in task_stories().items():
        typer.echo(f"  {name}: {story}")
    for what, (folder, pattern) in DECLARED.items():
        texts = [path.read_text(encoding="utf-8") for path in (SHIPPED.parent / folder).rglob("*.py")]
        typer.echo(f"{what}: {', '.join(sorted(name for text in texts for name in re.findall(pattern, text)))}")


def _names(held: object, key: str = "name") -> list[str]:
    """Return the names in a list of a document that was not checked."""
    return [str(part.get(key)) for part in held if isinstance(part, dict)] if isinstance(held, list) else []
