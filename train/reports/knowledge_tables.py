"""The tables of `clean-swarm knowledge`: all goals of a store, and one goal in detail."""

import math
from collections.abc import Iterable
from datetime import UTC, datetime

from rich.table import Table

from selector.store import Key, StoredKnowledge, StoreError
from selector.store.stored_knowledge import LearnedEntry
from selforg.registry import unknown
from train.reports.text_table import EMPTY_CELL


def all_goals(contents: StoredKnowledge) -> Table:
    """Return a table with a row for each goal: options, contexts, updates, last update, sources."""
    table = _table("goal", options=True, contexts=True, updates=True, **{"last update": False, "sources": False})
    for goal in _goals(contents):
        learned = {key: entry for key, entry in contents.learned.items() if key.goal == goal}
        rated = {name for (of, name) in contents.expert if of == goal}
        table.add_row(
            goal,
            str(len(rated | {key.option for key in learned})),
            str(len({key.context for key in learned})),
            str(sum(entry.moments.count for entry in learned.values())),
            _time(entry.updated for entry in learned.values()),
            ", ".join(sorted({key.source for key in learned})) or EMPTY_CELL,
        )
    return table


def one_goal(contents: StoredKnowledge, goal: str) -> Table:
    """Return a row for each option, context and source of a goal: score, count, mean, standard deviation, update."""
    goals = _goals(contents)
    if goal not in goals:
        raise StoreError(unknown("goal", goal, goals))
    columns = {"configuration": False, "score": True, "context": False, "updates": True, "mean": True, "std": True}
    table = _table("option", **columns, **{"last update": False, "source": False})
    rated = {name: found for (of, name), found in contents.expert.items() if of == goal}
    learned = {key: entry for key, entry in contents.learned.items() if key.goal == goal}
    names = sorted(rated, key=lambda name: (rated[name].position, name))
    names += sorted({key.option for key in learned} - set(rated))
    for name in names:
        option = rated[name].option if name in rated else None
        first = (name, option.configuration if option else EMPTY_CELL, f"{option.score:g}" if option else EMPTY_CELL)
        own = sorted((key, entry) for key, entry in learned.items() if key.option == name)
        for row in [_learned(key, entry) for key, entry in own] or [(EMPTY_CELL, "0", *[EMPTY_CELL] * 4)]:
            table.add_row(*first, *row)
            first = ("", "", "")
    return table


def _learned(key: Key, entry: LearnedEntry) -> tuple[str, ...]:
    moments = entry.moments
    figures = (f"{moments.mean:.6g}", f"{math.sqrt(moments.variance):.6g}")
    return (key.context or EMPTY_CELL, str(moments.count), *figures, _time([entry.updated]), key.source)


def _goals(contents: StoredKnowledge) -> list[str]:
    return sorted({goal for goal, _ in contents.expert} | {key.goal for key in contents.learned})


def _table(first: str, **columns: bool) -> Table:
    """Return an empty table; a column is true if it holds numbers."""
    table = Table(box=None, pad_edge=False)
    table.add_column(first, overflow="fold")
    for name, number in columns.items():
        table.add_column(name, justify="right" if number else "left", overflow="fold")
    return table


def _time(updates: Iterable[int]) -> str:
    """Return the latest time, in UTC to the second."""
    latest = max(updates, default=None)
    return EMPTY_CELL if latest is None else f"{datetime.fromtimestamp(latest // 10**6, UTC):%Y-%m-%d %H:%M:%S}"
