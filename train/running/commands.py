"""The ends of commands and what they show meanwhile: exit codes, and the progress bar on the standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

FINISHED = 0
FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
"""Code of a program that Ctrl-C ended."""


@contextmanager
def progress(what: str, counted: ProgressColumn, total: int, done: int = 0) -> Iterator[Callable[..., None]]:
    """Show a bar for `what`, with a column that shows how much is done.

    The function returned takes the keyword arguments of rich's `Progress.update`, and `more`, a text behind the bar.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), counted, TimeElapsedColumn(), TextColumn("left"))
    left, more = TimeRemainingColumn(elapsed_when_finished=False), TextColumn("{task.fields[more]}")
    with Progress(*columns, left, more, console=Console(stderr=True)) as bar:
        yield partial(bar.update, bar.add_task(what, total=total, completed=done, more=""))
