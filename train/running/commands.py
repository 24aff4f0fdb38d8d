"""The ends of commands and what they show meanwhile: exit codes, and the progress bar on the standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from threading import Event, Thread
from time import strftime

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.text import Text

FINISHED = 0
FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
"""Code of a program that Ctrl-C ended."""


LOG, LOG_EVERY = "progress.log", 30.0
"""File in the results that gets a line of the progress, and how often [s]."""


class _TimeLeft(ProgressColumn):
    """The time that is left, estimated from the results of this command."""

    def render(self, task: Task) -> Text:
        return Text(time_left(task))


def time_left(task: Task) -> str:
    """Return the time left of a task in words."""
    done, elapsed = task.completed - task.fields["begun"], task.elapsed or 0.0
    if done <= 0.0 or task.total is None:
        return "time left: from the first result on"
    seconds = round(elapsed / done * (task.total - task.completed))
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d} left"


def _keep_log(task: Task, what: str, log: Path, ended: Event) -> None:
    while not ended.wait(LOG_EVERY):
        done = f"{task.completed:,.0f} of {task.total or 0:,.0f} {what}"
        line = ", ".join(filter(None, (strftime("%H:%M:%S"), done, time_left(task), task.fields["more"])))
        with log.open("a", encoding="utf-8") as file:
            file.write(f"{line}\n")


@contextmanager
def progress(
    what: str, counted: ProgressColumn, total: int, done: int = 0, log: Path | None = None
) -> Iterator[Callable[..., None]]:
    """Show a bar for `what`, with a column that shows how much is done; a folder `log` gets a line now and then.

    The function returned takes the keyword arguments of rich's `Progress.update`, and `more`, a text behind the bar.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), counted, TimeElapsedColumn(), _TimeLeft())
    with Progress(*columns, TextColumn("{task.fields[more]}"), console=Console(stderr=True)) as bar:
        number, ended = bar.add_task(what, total=total, completed=done, more="", begun=done), Event()
        if log is not None:
            Thread(target=_keep_log, args=(bar.tasks[0], what, log / LOG, ended), daemon=True).start()
        try:
            yield partial(bar.update, number)
        finally:
            ended.set()
