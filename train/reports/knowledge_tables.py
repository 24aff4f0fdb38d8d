"""The tables of knowledge about options: of all goals of a store, of one goal in detail, and for one run."""

import math
from collections.abc import Iterable
from datetime import UTC

import numpy as np
from rich.table import Table

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.task import task_class
from selector.documents.plain import must_know
from selector.knowledge import ENOUGH, Knowledge
from selector.store import StoredKnowledge
from selector.store.contents import Entry
from selector.strategies.problem import Problem
from train.analysis.intervals import MeanError
from train.reports.text_table import EMPTY_CELL, Grid


def all_goals(contents: StoredKnowledge) -> Table:
    """Return a table with a row for each goal: options, contexts, updates, last update, sources."""
    table = _table("goal", options=True, contexts=True, updates=True, **{"last update": False, "sources": False})
    for goal in sorted({key.goal for key in contents.entries}):
        entries = [entry for entry in contents.entries.values() if entry.goal == goal]
        learned = [entry for entry in entries if entry.source]
        table.add_row(
            goal,
            str(len({entry.option for entry in entries})),
            str(len({entry.context for entry in learned})),
            str(sum(entry.count for entry in learned)),
            _time(learned),
            ", ".join(sorted({entry.source for entry in learned})) or EMPTY_CELL,
        )
    return table


def one_goal(contents: StoredKnowledge, goal: str) -> Table:
    """Return a row for each option, context and source of a goal: score, count, mean, standard deviation, update."""
    goals = sorted({key.goal for key in contents.entries})
    must_know("goal", goal, goals)
    columns = {"configuration": False, "score": True, "context": False, "updates": True, "mean": True, "std": True}
    table = _table("option", **columns, **{"last update": False, "source": False})
    rated = {name: expert for (of, name), expert in contents.expert.items() if of == goal}
    names = sorted(rated, key=lambda name: (rated[name].position, name))
    names += sorted({key.option for key in contents.learned if key.goal == goal} - set(rated))
    for name in names:
        first = [name, EMPTY_CELL, EMPTY_CELL]
        if name in rated:
            first[1:] = rated[name].configuration, f"{rated[name].score:g}"
        own = [entry for _, entry in sorted(contents.learned.items()) if (entry.goal, entry.option) == (goal, name)]
        for row in [_learned(entry) for entry in own] or [(EMPTY_CELL, "0", *[EMPTY_CELL] * 4)]:
            table.add_row(*first, *row)
            first = [""] * 3
    return table


def amount(contents: StoredKnowledge) -> str:
    """Return the numbers of expert options and updates in words."""
    updates = sum(entry.count for entry in contents.learned.values())
    return f"{counted(len(contents.expert), 'expert option')}, {counted(updates, 'update')}"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun."""
    return f"{number} {one if number == 1 else many or one + 's'}"


def learned_scores(knowledge: Knowledge, title: str, mission: MissionConfig) -> Grid:
    """Return a row for each option: score by the expert and learned, and which of them counts.

    Args:
        knowledge: the options, with what was learned of them.
        title: of the table.
        mission: whose cost follows from a score.

    """
    rows, best, limit = [], task_class(mission).best_score, mission.time_limit
    for goal in knowledge.learned:
        problem = Problem.of(knowledge, goal)
        for k, option in enumerate(knowledge.options(goal)):
            count, mean, variance = problem.rewards[:, k].tolist()
            score, cost = EMPTY_CELL, EMPTY_CELL
            if count:
                half = MeanError(math.sqrt(variance / (count - 1)), count - 1).half_width() if count > 1 else None
                score = _with_interval(mean, half, ".4f")
                spent = (best - mean) * limit
                cost = _with_interval(spent, None if half is None else half * limit, ".1f")
            counts = f"{problem.scores[k]:.4g} {'expert' if problem.scores[k] == option.score else 'learned'}"
            taken = "taken" if k == int(np.argmax(problem.scores)) else ""
            name = f"{goal} - {option.name}"
            rows.append((name, f"{option.score:g}", f"{count:.0f}", score, cost, counts, taken))
    heads = ("option", "expert", "rewards", "learned, 95 %", "cost s, 95 %", "counts", "by MaxScore")
    note = f"From {ENOUGH} rewards on their mean counts in place of the expert's score, before that the lower of both."
    return Grid(title, heads, rows, notes=(note,))


def _with_interval(mean: float, half: float | None, form: str) -> str:
    return f"{mean:{form}}" + ("" if half is None else f" [{mean - half:{form}}, {mean + half:{form}}]")


def _learned(entry: Entry) -> tuple[str, ...]:
    moments = entry.moments
    figures = (f"{moments.mean:.6g}", f"{math.sqrt(moments.variance):.6g}")
    return (entry.context or EMPTY_CELL, str(moments.count), *figures, _time([entry]), entry.source)


def _table(first: str, **columns: bool) -> Table:
    """Return an empty table; a column is true if it holds numbers."""
    table = Table(box=None, pad_edge=False)
    table.add_column(first, overflow="fold")
    for name, number in columns.items():
        table.add_column(name, justify="right" if number else "left", overflow="fold")
    return table


def _time(entries: Iterable[Entry]) -> str:
    """Return the time of the latest update, in UTC to the second."""
    latest = max((entry.updated for entry in entries), default=None)
    return EMPTY_CELL if latest is None else f"{latest.astimezone(UTC):%Y-%m-%d %H:%M:%S}"
