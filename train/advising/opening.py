"""Missions opened: robots coordinate all goals that they could, by all options that the library has for them.

What the mission itself says stays: its own options with their scores, what robots hold, the documents of its groups.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, product, zip_longest
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.world.task import task_class
from selector.configurations.library import library_of
from selector.documents.errors import DocumentError
from selector.documents.find import files_of
from selector.documents.parameters import Content
from selector.documents.reading import as_yaml
from selector.knowledge import Knowledge, Option, library_options, load_knowledge
from selector.strategies.problem import Problem

FACTORS = (0.7, 1.4)
"""What a number of an option is multiplied by in its variants."""
VARIED = (1e-6, 1e6)
"""Least and largest number that is varied: beyond them stand those that switch something off."""
MOST_VARIANTS = 12


@dataclass(frozen=True)
class OpenedMission:
    """A family whose robots coordinate all goals that they could."""

    family: FamilyConfig
    known: Knowledge
    """The options of each goal: the mission's own, then those of the library."""
    experts: Mapping[str, str]
    """Goal -> the option of the highest score."""
    elsewhere: Mapping[str, float]
    """Option -> its highest score in any knowledge: what is tried first where there is no time for all."""

    @property
    def goals(self) -> tuple[str, ...]:
        """The goals that are coordinated."""
        return self.known.goals

    def names(self, goal: str) -> list[str]:
        """Return the names of the options of a goal."""
        return [option.name for option in self.known.options(goal)]

    @property
    def combinations(self) -> int:
        """Number of ways to hold an option of each goal."""
        return int(np.prod([len(self.names(goal)) for goal in self.goals]))

    def with_knowledge(self, file: Path) -> FamilyConfig:
        """Return the family with the options in a file."""
        changes = {"knowledge": str(file), "store": "", "learned": {}}
        return self.family.model_copy(update={"mission": self.family.mission.model_copy(update=changes)})


def open_mission(family: FamilyConfig, directories: tuple[Path, ...]) -> OpenedMission:
    """Return a family opened; DocumentError if its mission has a mistake."""
    own, kind = knowledge_of(family.mission, directories), task_class(family.mission)
    mission = kind.opened(family.mission)
    table: dict[str, tuple[Option, ...]] = {}
    for goal in kind.goals(mission, directories):
        mine, found = own.table.get(goal, ()), list[Option]()
        least = min((0.0, *(option.score for option in mine)))
        for option in (*mine, *library_options(goal, directories)):
            if not any(option.same(other) for other in found):
                found.append(option if option in mine or not mine else option.model_copy(update={"score": least}))
        if not found:
            raise DocumentError(f"{goal}: expected an option in the mission's knowledge or the library, got none")
        table[goal] = tuple(found)
    learned = {goal: scores for goal, scores in own.learned.items() if goal in table}
    known = Knowledge(table, own.source, learned)
    experts = {goal: one.options[int(one.scores.argmax())] for goal in table for one in [Problem.of(known, goal)]}
    changed = family.model_copy(update={"mission": mission})
    return OpenedMission(changed, known, experts, _scores_elsewhere(tuple(table), directories))


def _scores_elsewhere(goals: Sequence[str], directories: tuple[Path, ...]) -> dict[str, float]:
    """Return option -> its highest score for some goals in all knowledge that can be read."""
    found: dict[str, float] = {}
    for name in files_of("knowledge", directories):
        with suppress(DocumentError):  # of a file that nobody asked for
            table = load_knowledge(name, directories).table
            for option in chain.from_iterable(table.get(goal, ()) for goal in goals):
                found[option.name] = max(option.score, found.get(option.name, option.score))
    return found


def variants_of(held: Mapping[str, Option], directories: tuple[Path, ...]) -> dict[str, list[Option]]:
    """Return goal -> variants of the option that serves it, each with another value of one number.

    Values that the library refuses are left out.
    """
    library = library_of(directories)
    tried = []
    for goal, option in held.items():
        numbers = {
            name: value
            for name, value in {**library.parameters(option.configuration), **option.parameters}.items()
            if isinstance(value, int | float) and not isinstance(value, bool) and VARIED[0] <= abs(value) <= VARIED[1]
        }
        own, taken = [], {one.name for one in library_options(goal, directories)}
        for (name, value), factor in product(numbers.items(), FACTORS):
            changed = round(value * factor) if isinstance(value, int) else float(f"{value * factor:.2g}")
            called = f"{option.name}-{name.replace('_', '')}{changed:g}"
            variant = Option(
                name=called,
                configuration=option.configuration,
                score=option.score,
                parameters={**option.parameters, name: changed},
            )
            try:
                library.configuration(variant.configuration, variant.parameters)
            except ValueError:
                continue
            if changed != value and called not in taken:
                taken.add(called)
                own.append((goal, variant))
        tried.append(own)
    chosen = [one for one in chain(*zip_longest(*tried)) if one is not None][:MOST_VARIANTS]
    return {goal: [variant for own, variant in chosen if own == goal] for goal in held}


def document_of(table: Mapping[str, Sequence[Option]], directories: tuple[Path, ...], **more: object) -> str:
    """Return the knowledge file of options, those of the library by name; `more`: further keys."""
    goals: dict[str, list[Content]] = {}
    for goal, options in table.items():
        library = {option.name for option in library_options(goal, directories)}
        short = {"name", "score"}
        goals[goal] = [one.model_dump(mode="json", include=short if one.name in library else None) for one in options]
    return as_yaml({**more, "goals": goals})
