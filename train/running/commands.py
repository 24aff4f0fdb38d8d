"""The ends of commands and what they show meanwhile: exit codes, and the progress bar on the standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread
from time import strftime
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.table import Column
from rich.text import Text

from train.running.pulse import TELL_EVERY, listening

FINISHED = 0
FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
"""Code of a program that Ctrl-C ended."""


LOG, LOG_EVERY = "progress.log", 30.0
"""File in the results that gets a line of the progress, and how often [s]."""

SHARE_THAT_TELLS = 0.005
"""Share of all simulated seconds from which on they tell how long it takes: the first compile mechanisms of a user."""


class _TimeLeft(ProgressColumn):
    """The time that is left, estimated from the results of this command."""

    def render(self, task: Task) -> Text:
        return Text(time_left(task))


class _More(ProgressColumn):
    """The text behind the bar; on a narrow terminal its end and the bar give way, and no other column."""

    def render(self, task: Task) -> Text:
        return Text(task.fields["more"], no_wrap=True, overflow="ellipsis")


def time_left(task: Task) -> str:
    """Return the time left of a task in words.

    Most missions end before their time limit. So the simulated seconds that have run, of all that may have to, say how
    long it takes at most; the results say it more closely as soon as there are enough. The time until the first
    missions run is not counted, and the first of the seconds say nothing yet. Where no result has come for longer than
    the results say is left, the slow missions are the last ones: then as long again is said.
    """
    begun, most, ran, first, latest = (task.fields[name] for name in ("begun", "most", "ran", "first", "latest"))
    by_results = (task.completed - begun) / max((task.total or 0.0) - begun, 1.0)
    by_seconds = min(ran / most, 1.0) if most > 0.0 else 0.0
    if by_results <= 0.0 and by_seconds < SHARE_THAT_TELLS:
        return "time left: not known yet"
    share = min(max(by_results, by_seconds), 1.0)  # a training ends with a whole round, beyond its total
    waited = (task.elapsed or 0.0) - latest if by_results >= by_seconds and share < 1.0 else 0.0
    seconds = round(max(((task.elapsed or 0.0) - first) * (1.0 / share - 1.0), waited))
    words = f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d} left"
    return words if by_results >= by_seconds else f"at most {words}"


def _keep_log(task: Task, what: str, log: Path, ended: Event) -> None:
    while not ended.wait(LOG_EVERY):
        parts = (f"{task.completed:,.0f} of {task.total or 0:,.0f} {what}", time_left(task), task.fields["more"])
        with suppress(OSError), log.open("a", encoding="utf-8") as file:  # others say that the disk is full
            file.write(f"{', '.join(filter(None, (strftime('%H:%M:%S'), *parts)))}\n")


@contextmanager
def progress(
    what: str,
    total: int,
    done: int = 0,
    log: Path | None = None,
    counted: ProgressColumn | None = None,
    *,
    quiet: bool = False,
) -> Iterator[Callable[..., None]]:
    """Show a bar for `what`, with `counted`, a column that shows how much of `total` is done.

    A folder `log` gets a line now and then; without it the bar vanishes at the end. A `quiet` bar is not shown.

    The function returned takes the keyword arguments of rich's `Progress.update`, and `more`, a text behind the bar,
    and `most`, the simulated seconds that all missions of this command take at most [s].
    """
    shown = (TextColumn("{task.description}"), BarColumn(20), counted or MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    hidden = quiet or (log is None and not console.is_terminal)  # nothing is left of it
    with Progress(
        *shown, _TimeLeft(Column(no_wrap=True)), _More(), console=console, transient=log is None, disable=hidden
    ) as bar:
        known: dict[str, Any] = {"begun": done, "most": 0.0, "ran": 0.0, "first": 0.0, "latest": 0.0}
        number, ended = bar.add_task(what, total=total, completed=done, more="", **known), Event()
        task = bar.tasks[0]

        def hear(seconds: float) -> None:
            if not task.fields["ran"]:
                task.fields["first"] = max((task.elapsed or 0.0) - TELL_EVERY, 0.0)
            bar.update(number, ran=task.fields["ran"] + seconds)

        def update(**changed: Any) -> None:  # noqa: ANN401  (as rich has it)
            came: dict[str, Any] = {"latest": task.elapsed} if changed.keys() & {"advance", "completed"} else {}
            bar.update(number, **{**came, **changed})

        if log is not None:
            Thread(target=_keep_log, args=(task, what, log / LOG, ended), daemon=True).start()
        try:
            with listening(hear):
                yield update
        finally:
            ended.set()
