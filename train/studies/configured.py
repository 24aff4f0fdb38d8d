"""The study behind `clean-swarm study configure`: one option, all its numbers and flags."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.tasks import with_changes
from selector.configurations.library import library_of
from selector.documents.errors import DocumentError, validated
from selector.documents.parameters import Content
from selector.knowledge import Knowledge, Option, load_knowledge
from train.studies.config import StudyConfig
from train.studies.space import DIGITS, Varied, nested


def configured_study(
    option: str, family: str, knowledge: str | None, changes: Mapping[str, Any], directories: tuple[Path, ...] = ()
) -> StudyConfig:
    """Return the study of an option for a family, with the default space and `changes`.

    Raises:
        DocumentError: the family, the knowledge or the option does not exist, or `changes` do not fit.

    """
    config = load_family(family, directories)
    known = load_knowledge(knowledge, directories) if knowledge else knowledge_of(config.mission, directories)
    content = {
        "name": f"{option}-{config.name}",
        "description": f"{option}, configured for {config.name}.",
        "family": family,
        "knowledge": knowledge,
        "space": default_space(known, option, directories),
        **changes,
    }
    return validated(StudyConfig, content, "configure")


def default_space(knowledge: Knowledge, option: str, directories: tuple[Path, ...] = ()) -> dict[str, Any]:
    """Return a space of every number and flag of an option; numbers from a quarter to four times their value.

    Numbers of at most a millionth stay as they are: they stand for zero. A bound that the library refuses comes nearer.

    Raises:
        DocumentError: no goal has this option, or nothing of it can vary.

    """
    found = [(goal, one) for goal in knowledge.goals for one in knowledge.options(goal) if one.name == option]
    if not found:
        known = sorted({one.name for goal in knowledge.goals for one in knowledge.options(goal)})
        raise DocumentError(f"{knowledge.source}: no goal has the option {option!r} (known: {', '.join(known)})")
    goal, given = found[0]
    library = library_of(directories)
    content = given.model_dump(exclude={"name", "configuration", "score"})
    content["parameters"] = {**library.parameters(given.configuration), **given.parameters}

    def fits(path: tuple[str, ...], value: Varied) -> bool:
        changed = with_changes(given.model_dump(), nested(path, value))
        try:
            library.of_option(validated(Option, changed, option))
        except DocumentError:
            return False
        return True

    ranges: Content = {}
    for path, value in _leaves(content, ()):
        if isinstance(value, bool):
            ranges = with_changes(ranges, nested(path, {"choices": [False, True]}))
            continue
        whole = isinstance(value, int)
        bounds = []
        for factor in (0.25, 4.0):
            tried = (value * factor ** (1.0 / 2**k) for k in range(3))
            bounds.append(next((x for x in (float(round(t)) if whole else t for t in tried) if fits(path, x)), value))
        if bounds[0] < bounds[1]:
            low, high = (float(f"{bound:.{DIGITS}g}") for bound in bounds)
            leaf = {"low": low, "high": high, "log": not whole, "whole": whole}
            ranges = with_changes(ranges, nested(path, leaf))
    if not ranges:
        raise DocumentError(f"{option}: expected an option with numbers or flags, got none that can vary")
    return {goal: {option: ranges}}


def _leaves(content: Content, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], bool | int | float]]:
    """Yield the path and the value of every flag and every number above a millionth."""
    for key, value in content.items():
        if isinstance(value, dict):
            yield from _leaves(value, (*path, key))
        elif isinstance(value, bool) or (isinstance(value, int | float) and value > 1e-6):
            yield (*path, key), value
