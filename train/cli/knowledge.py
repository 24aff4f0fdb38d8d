"""`clean-swarm learn knowledge`: list, show, import, export, merge and reset knowledge stores.

The commands import the store inside their functions: SQLAlchemy takes long to load, and help has to be quick.
"""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.writing import write_whole
from train.cli.listing import check_named
from train.cli.options import (
    SITUATIONS,
    Configs,
    GivenOptions,
    Situations,
    asking,
    situations_in,
    wide_console,
)

app = typer.Typer(no_args_is_help=True, help="Keep expert knowledge and learned rewards in a database.")

StoreOption = Annotated[
    str | None,
    typer.Option(
        help="URL of the store, sqlite:///PATH or postgresql://USER@HOST/DATABASE, or the path of a file; the "
        "environment's CLEAN_SWARM_STORE, else a file in your data directory, unless given.",
        metavar="URL",
    ),
]
GoalOption = Annotated[str | None, typer.Option(help="Only this goal.")]


@app.command("list")
def list_goals(store: StoreOption = None) -> None:
    """List the goals of a store: options, contexts, updates, sources."""
    from train.memory import opened
    from train.reports import knowledge_tables

    with closing(opened(store, create=False)) as kept:
        _print(knowledge_tables.all_goals(kept.contents()), f"{kept.name}:")


@app.command("show")
def show_goal(goal: Annotated[str, typer.Argument(help="A goal of the store.")], store: StoreOption = None) -> None:
    """Show what is known of a goal: per option, context and source its count, mean and standard deviation."""
    from train.memory import opened
    from train.reports import knowledge_tables

    with closing(opened(store, create=False)) as kept:
        _print(knowledge_tables.one_goal(kept.contents(), goal), f"{goal}:")


@app.command("import")
def import_file(
    given: Annotated[
        str, typer.Argument(help="YAML or JSON file: expert knowledge or an exported store.", metavar="FILE|NAME")
    ],
    store: StoreOption = None,
    source: Annotated[str, typer.Option(help="Whom expert knowledge comes from.")] = "expert",
    configs: Configs = None,
) -> None:
    """Add a file, or the expert knowledge of a name, to a store; the store is made if there is none."""
    from train.memory import amount, contents_named, opened

    contents = contents_named(given, source, configs or ())
    with closing(opened(store, create=True)) as kept:
        kept.absorb(contents)
        typer.echo(f"{kept.name}: took in {amount(contents)}")


@app.command("export")
def export_file(
    output: Annotated[Path, typer.Argument(help="File to write, YAML or JSON by its ending; - prints YAML.")],
    store: StoreOption = None,
    context: Annotated[
        str | None,
        typer.Option(help="Write expert knowledge with the scores learned in this context."),
    ] = None,
) -> None:
    """Write all that a store holds to a file, or expert knowledge for a mission to name; one that exists is refused."""
    from selector.store import document
    from train.memory import amount, opened

    if str(output) != "-" and output.suffix not in (".yaml", ".yml", ".json"):
        raise ConfigurationError(f"{output}: expected a name that ends in .yaml or .json")
    with closing(opened(store, create=False)) as kept:
        contents = kept.contents()
    if context is None:
        text = document.document_text(contents, as_json=output.suffix == ".json")
    elif output.suffix == ".json":
        raise ConfigurationError(f"{output}: expected a name that ends in .yaml with --context")
    else:
        text = document.knowledge_text(contents, context, kept.name)
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    _check_new(output)
    write_whole(output, text.encode())
    typer.echo(f"{amount(contents)} in {output}")


@app.command("from-policy")
@asking("goal", "configs", "force", scenarios=16, seed=1)
def write_opinions(
    decider: Annotated[
        str, typer.Argument(help="policy:NAME, or another decider as --strategy takes it.", metavar="POLICY")
    ],
    output: Annotated[Path, typer.Argument(help="Knowledge file to write, NAME.yaml; one that exists is refused.")],
    family: Annotated[str, typer.Option(help="Family on whose training missions it decides, by name or path.")],
    situations: Situations = SITUATIONS,
    *,
    given: GivenOptions,
) -> None:
    """Write what a policy thinks of the options in each situation as expert knowledge, which MaxScore can use."""
    names = situations_in(situations)
    if output.suffix not in (".yaml", ".yml"):
        raise ConfigurationError(f"{output}: expected a name that ends in .yaml")
    _check_new(output)
    check_named(given.directories, [decider], families=family)
    from selector.documents.reading import as_yaml  # these import SciPy and Numba
    from selector.knowledge import knowledge_content
    from train.evaluation.opinions import knowledge_of_decider

    known, count = knowledge_of_decider(given.request(family, strategies=(decider,)), names)
    about = f"What {decider} thinks on {given.values['scenarios']} training missions of {family}, {count} decisions."
    write_whole(output, as_yaml({"description": about, **knowledge_content(known)}).encode())
    typer.echo(f"{count} decisions in {output}")


@app.command("merge")
def merge_stores(
    others: Annotated[list[str], typer.Argument(help="URLs or paths of the stores to add.", metavar="OTHER...")],
    store: StoreOption = None,
) -> None:
    """Add all that other stores hold to a store, exactly; what it holds already counts once."""
    from train.memory import amount, opened

    sources = [opened(other, create=False) for other in others]  # a missing one is an error before any is added
    with closing(opened(store, create=True)) as kept:
        for source in sources:
            contents = source.contents()
            kept.absorb(contents)
            typer.echo(f"{kept.name}: took in {amount(contents)} of {source.name}")
            source.close()


@app.command("reset")
def reset_store(
    store: StoreOption = None,
    goal: GoalOption = None,
    option: Annotated[str | None, typer.Option(help="Only this option.")] = None,
    context: Annotated[str | None, typer.Option(help="Only this context; '' is the one without a key.")] = None,
    source: Annotated[str | None, typer.Option(help="Only what comes from this source.")] = None,
    expert: Annotated[bool, typer.Option("--expert", help="Forget the expert's options as well.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False,
) -> None:
    """Forget what was learned, all of it or what the options choose."""
    given = {"goal": goal, "option": option, "context": context, "source": source}
    chosen = {what: value for what, value in given.items() if value is not None}
    if expert and context is not None:
        raise ConfigurationError("--expert: expert options have no context; leave out --context")
    from train.memory import counted, opened

    with closing(opened(store, create=False)) as kept:
        what = ", ".join(f"{name} {value!r}" for name, value in chosen.items()) or "everything"
        if not yes:
            typer.confirm(f"{kept.name}: forget {what}?", abort=True, err=True)
        entries, options = kept.reset(expert=expert, **chosen)
        typer.echo(f"{kept.name}: forgot {counted(entries, 'entry', 'entries')}, {counted(options, 'expert option')}")


def _check_new(output: Path) -> None:
    if output.exists():
        raise ConfigurationError(f"{output}: cannot be written (File exists)")


def _print(table: Table, title: str) -> None:
    console = wide_console()
    console.print(title)
    console.print(table)
