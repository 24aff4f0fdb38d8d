"""The tables of knowledge about options: of all goals of a store, of one goal in detail, and for one run."""

import math
from collections.abc import Iterable
from datetime import UTC, datetime

import numpy as np
from rich.table import Table

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.task import task_class
from selector.knowledge import ENOUGH, Knowledge
from selector.store import Key, StoredKnowledge, StoreError
from selector.store.stored_knowledge import LearnedEntry
from selector.strategies.problem import Problem
from selforg.registry import unknown
from train.analysis.intervals import MeanError
from train.reports.text_table import EMPTY_CELL, Grid


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


def learned_scores(knowledge: Knowledge, title: str, mission: MissionConfig) -> Grid:
    """Return a row for each option: score by the expert and learned, and which of them counts.

    Args:
        knowledge: the options, with what was learned of them.
        title: of the table.
        mission: whose cost follows from a score.

    """
    rows = []
    for goal in knowledge.learned:
        problem = Problem.of(knowledge, goal)
        for k, option in enumerate(knowledge.options(goal)):
            count, mean, variance = problem.rewards[:, k].tolist()
            spread = None if count < 2 else MeanError(int(count), math.sqrt(variance / (count - 1)), count - 1)
            half = None if spread is None else spread.half_width()
            score = EMPTY_CELL if not count else _with_interval(mean, half, ".4f")
            cost, limit = EMPTY_CELL, mission.time_limit
            if count:
                spent = task_class(mission).best_score - mean
                cost = _with_interval(spent * limit, None if half is None else half * limit, ".1f")
            counts = f"{problem.scores[k]:.4g} {'expert' if problem.scores[k] == option.score else 'learned'}"
            taken = "taken" if k == int(np.argmax(problem.scores)) else ""
            name = f"{goal} - {option.name}"
            rows.append((name, f"{option.score:g}", f"{count:.0f}", score, cost, counts, taken))
    heads = ("option", "expert", "rewards", "learned, 95 %", "cost s, 95 %", "counts", "by MaxScore")
    note = f"From {ENOUGH} rewards on their mean counts in place of the expert's score, before that the lower of both."
    return Grid(title, heads, rows, notes=(note,))


def _with_interval(mean: float, half: float | None, form: str) -> str:
    return f"{mean:{form}}" + ("" if half is None else f" [{mean - half:{form}}, {mean + half:{form}}]")


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
