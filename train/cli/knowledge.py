"""`clean-swarm knowledge`: show, import and export the knowledge store, and forget a run."""

from pathlib import Path
from typing import Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.writing import check_output, write_whole
from train.cli.options import wide_console

app = typer.Typer(no_args_is_help=True, help="Keep expert knowledge and learned rewards in a file.")

StoreOption = Annotated[
    str | None,
    typer.Option(
        help="File of the store; CLEAN_SWARM_STORE of the environment or a file in your data directory unless given.",
        metavar="FILE",
    ),
]


@app.command("show")
def show_store(
    goal: Annotated[str | None, typer.Argument(help="A goal of the store; all of them unless given.")] = None,
    store: StoreOption = None,
) -> None:
    """Show the goals of a store, or of one goal the count, mean and spread of the rewards of each option."""
    from train.memory import opened
    from train.reports import knowledge_tables

    kept = opened(store, create=False)
    contents = kept.contents()
    table = knowledge_tables.all_goals(contents) if goal is None else knowledge_tables.one_goal(contents, goal)
    wide_console().print(f"{kept.name if goal is None else goal}:", table, sep="\n")


@app.command("import")
def import_file(
    given: Annotated[Path, typer.Argument(help="YAML or JSON file: expert knowledge or an exported store.")],
    store: StoreOption = None,
) -> None:
    """Add a file to a store, which is made if there is none."""
    from selector.store import contents
    from train.memory import opened
    from train.reports.knowledge_tables import amount

    added = contents.read(given)
    kept = opened(store, create=True)
    kept.absorb(added)
    typer.echo(f"{kept.name}: took in {amount(added)}")


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
    from selector.store import contents as documents
    from train.memory import opened
    from train.reports.knowledge_tables import amount

    if str(output) != "-":
        check_output(output, (".yaml", ".yml", ".json"), new=True)
    kept = opened(store, create=False)
    contents = kept.contents()
    if context is None:
        text = documents.document_text(contents, as_json=output.suffix == ".json")
    elif output.suffix == ".json":
        raise ConfigurationError(f"{output}: expected a name that ends in .yaml with --context")
    else:
        text = documents.knowledge_text(contents, context, kept.name)
    if str(output) == "-":
        typer.echo(text, nl=False)
        return
    write_whole(output, text.encode())
    typer.echo(f"{amount(contents)} in {output}")


@app.command("reset")
def reset_store(
    source: Annotated[str, typer.Option(help="The run whose rewards are forgotten; `show GOAL` lists them.")],
    store: StoreOption = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False,
) -> None:
    """Forget what one run learned."""
    from train.memory import opened
    from train.reports.knowledge_tables import counted

    kept = opened(store, create=False)
    if not yes:
        typer.confirm(f"{kept.name}: forget source {source!r}?", abort=True, err=True)
    typer.echo(f"{kept.name}: forgot {counted(kept.forget(source), 'entry', 'entries')}")
