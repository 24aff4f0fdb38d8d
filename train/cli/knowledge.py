"""`clean-swarm knowledge`: look at a knowledge store, fill it, copy it, bring two together, forget."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from clean_swarm_env.config.errors import ConfigurationError

if TYPE_CHECKING:
    from selector.store import KnowledgeStore, StoredKnowledge

TABLE_WIDTH = 140
"""Least width of the printed tables [characters]."""

app = typer.Typer(no_args_is_help=True, help="Keep expert knowledge and what was learned in a database.")

Store = Annotated[
    str | None,
    typer.Option(
        help="URL of the store, sqlite:///PATH or postgresql://USER@HOST/DATABASE, or the path of a file; the "
        "environment's CLEAN_SWARM_STORE, else a file in your data directory, unless given.",
        metavar="URL",
    ),
]
Goal = Annotated[str | None, typer.Option(help="Only this goal.")]


@app.command("list")
def list_goals(store: Store = None) -> None:
    """List the goals of a store: options, contexts, updates, sources."""
    from train.reports import knowledge_tables

    with _opened(store, create=False) as opened:
        _print(knowledge_tables.all_goals(opened.contents()), f"{opened.name}:")


@app.command()
def show(goal: Annotated[str, typer.Argument(help="A goal of the store.")], store: Store = None) -> None:
    """Show what is known of a goal: per option, context and source its count, mean and standard deviation."""
    from train.reports import knowledge_tables

    with _opened(store, create=False) as opened:
        _print(knowledge_tables.one_goal(opened.contents(), goal), f"{goal}:")


@app.command("import")
def import_file(
    given: Annotated[
        str, typer.Argument(help="YAML or JSON file: expert knowledge or an exported store.", metavar="FILE|NAME")
    ],
    store: Store = None,
    source: Annotated[str, typer.Option(help="Whom expert knowledge comes from.")] = "expert",
    configs: Annotated[
        list[Path] | None, typer.Option(help="Directory with your own knowledge/NAME.yaml; can be repeated.")
    ] = None,
) -> None:
    """Add a file, or the expert knowledge of a name, to a store; the store is made if there is none."""
    contents = _contents(given, source, configs or [])
    with _opened(store, create=True) as opened:
        opened.absorb(contents)
        typer.echo(f"{opened.name}: took in {_amount(contents)}")


@app.command("export")
def export_file(
    output: Annotated[Path, typer.Argument(help="File to write, YAML or JSON by its ending; - prints YAML.")],
    store: Store = None,
) -> None:
    """Write all that a store holds to a file; one that exists is refused."""
    from selector.store import document

    if str(output) != "-" and output.suffix not in (".yaml", ".yml", ".json"):
        raise ConfigurationError(f"{output}: expected a name that ends in .yaml or .json")
    with _opened(store, create=False) as opened:
        contents = opened.contents()
    text = document.as_text(contents, as_json=output.suffix == ".json")
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    try:
        with output.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error
    typer.echo(f"{_amount(contents)} in {output}")


@app.command()
def merge(
    others: Annotated[list[str], typer.Argument(help="URLs or paths of the stores to add.", metavar="OTHER...")],
    store: Store = None,
) -> None:
    """Add all that other stores hold to a store, exactly; updates that it holds already are refused."""
    from selector.store import KnowledgeStore

    sources = [KnowledgeStore(other, create=False) for other in others]  # all of them exist before any is added
    with _opened(store, create=True) as opened:
        for source in sources:
            typer.echo(f"{opened.name}: took in {_amount(opened.merge(source))} of {source.name}")
            source.close()


@app.command()
def reset(
    store: Store = None,
    goal: Goal = None,
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
    with _opened(store, create=False) as opened:
        what = ", ".join(f"{name} {value!r}" for name, value in chosen.items()) or "everything"
        if not yes:
            typer.confirm(f"{opened.name}: forget {what}?", abort=True, err=True)
        entries, options = opened.reset(expert=expert, **chosen)
        typer.echo(f"{opened.name}: forgot {_counted(entries, 'entry', 'entries')}, {_options(options)}")


def _contents(given: str, source: str, configs: list[Path]) -> "StoredKnowledge":
    from selector.knowledge import load_knowledge
    from selector.store import document
    from selector.store.stored_knowledge import stored

    path = Path(given)
    if path.is_file():
        return document.read(path, source)
    if path.suffix or path.name != given:
        raise ConfigurationError(f"{given}: no such file")
    return stored(load_knowledge(given, configs), source)


@contextmanager
def _opened(url: str | None, *, create: bool) -> "Iterator[KnowledgeStore]":
    from train.knowledge_store import opened

    store = opened(url, create=create)
    try:
        yield store
    finally:
        store.close()


def _amount(contents: "StoredKnowledge") -> str:
    updates = sum(entry.moments.count for entry in contents.learned.values())
    return f"{_options(len(contents.expert))}, {_counted(updates, 'update', 'updates')}"


def _options(number: int) -> str:
    return _counted(number, "expert option", "expert options")


def _counted(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"


def _print(table: Table, title: str) -> None:
    console = Console(width=max(Console().width, TABLE_WIDTH), highlight=False, markup=False)
    console.print(title)
    console.print(table)
