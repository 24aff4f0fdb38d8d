"""Replays the cases of selection.json: the choice of an option by the expert's scores."""

from typing import Any

import numpy as np

from selector.documents.errors import DocumentError
from selector.knowledge import knowledge_from
from selector.strategies.problem import Problem
from selector.strategies.registry import create
from tests.golden.case import Case, SetAside, difference


def replay(case: Case) -> str | None:
    """Return how the choice differs from the original, None if it agrees."""
    try:
        chosen = choose(case.inputs["expert_knowledge"], case.inputs["so_goal"])
    except DocumentError as error:
        if "error" in case.expected:
            return None
        if has_boolean_scores(case.inputs["expert_knowledge"]):
            raise SetAside("B6") from error
        return f"refused: {error}"
    return difference(case.expected, chosen)


def has_boolean_scores(table: dict[str, list[Any]]) -> bool:
    """Return whether an option has a truth value as its score, which we refuse and the original takes for a number."""
    options = [entry for entries in table.values() for entry in entries if is_option(entry)]
    return any(isinstance(score, bool) for _, score, _ in options)


def is_option(entry: Any) -> bool:
    """Return whether an entry has the original's form: configuration, score, parameters."""
    return isinstance(entry, list) and len(entry) == 3


def choose(table: dict[str, list[Any]], goal: str) -> dict[str, Any]:
    """Return configuration key and parameters of the option that max-score takes for a goal."""
    # Two options of one configuration need names of their own here, so each gets its position.
    goals = {goal: [_option(entry, index) for index, entry in enumerate(entries)] for goal, entries in table.items()}
    knowledge = knowledge_from({"goals": goals})
    strategy = create("MaxScore", Problem.of(knowledge, goal), np.zeros(1, dtype=np.uint64))
    option = knowledge.options(goal)[int(strategy.select(np.zeros((1, 0)))[0])]
    return {"config_key": option.configuration, "params": option.parameters}


def _option(entry: Any, index: int) -> Any:
    if not is_option(entry):
        return entry
    configuration, score, parameters = entry
    return {"name": f"option {index}", "configuration": configuration, "score": score, "parameters": parameters}
