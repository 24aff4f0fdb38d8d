"""What a store holds, as values: expert options and learned entries, and how two of them make one."""

import json
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from selector.knowledge import Knowledge, Option
from selector.store.errors import StoreError
from selector.store.exact_sums import Moments

NAME_LIMIT = 120
"""Most characters of a goal, an option, a context or a source: four of them fit into an index of PostgreSQL."""
TIME_LIMIT = 253_402_300_800 * 10**6
"""End of the year 9999, the last that a date can name [us since 1970]."""
EXPERT = "expert"
"""Source of expert knowledge unless another is named."""


class Key(NamedTuple):
    """Whose rewards an entry sums up: one goal, option and context, learned from one source."""

    goal: str
    option: str
    context: str
    source: str


@dataclass(frozen=True)
class LearnedEntry:
    """What was learned under a key."""

    moments: Moments
    updated: int
    """Time of the last update [us since 1970, UTC]."""

    def merged(self, other: "LearnedEntry") -> "LearnedEntry":
        """Return both entries as one."""
        return LearnedEntry(self.moments + other.moments, max(self.updated, other.updated))


@dataclass(frozen=True)
class Rated:
    """An option as an expert gave it."""

    option: Option
    position: int
    """Place among the options of its goal; the first of equals is taken."""
    source: str
    updated: int
    """When it was given [us since 1970, UTC]."""

    def merged(self, other: "Rated") -> "Rated":
        """Return the later of both; they name the same thing, or StoreError is raised."""
        mine, others = (definition(rated.option) for rated in (self, other))
        if mine != others:
            raise StoreError(f"{self.option.name}: means {' '.join(mine)} here and {' '.join(others)} there")
        later = max(self, other, key=lambda rated: (rated.updated, rated.option.score, rated.source))
        return Rated(later.option, min(self.position, other.position), later.source, later.updated)


@dataclass(frozen=True)
class StoredKnowledge:
    """Expert options by goal and name, and learned entries by key."""

    expert: Mapping[tuple[str, str], Rated] = field(default_factory=dict)
    learned: Mapping[Key, LearnedEntry] = field(default_factory=dict)

    def merged(self, other: "StoredKnowledge") -> "StoredKnowledge":
        """Return what a store holds that took in both, in any order.

        Raises:
            StoreError: an option that means another configuration, or other parameters, in each of them.

        """
        expert = dict(self.expert)
        for (goal, name), rated in other.expert.items():
            try:
                expert[goal, name] = expert[goal, name].merged(rated) if (goal, name) in expert else rated
            except StoreError as error:
                raise StoreError(f"goals.{goal}.{error}; give one of them another name") from error
        learned = dict(self.learned)
        for key, entry in other.learned.items():
            learned[key] = learned[key].merged(entry) if key in learned else entry
        return StoredKnowledge(expert, learned)

    def knowledge(self, source: str) -> Knowledge:
        """Return the expert options as expert knowledge; `source` stands in its error messages."""
        table: dict[str, list[Option]] = {}
        for (goal, _), rated in sorted(self.expert.items(), key=lambda item: (item[0][0], item[1].position, item[0])):
            table.setdefault(goal, []).append(rated.option)
        return Knowledge({goal: tuple(options) for goal, options in table.items()}, source)


def stored(knowledge: Knowledge, source: str = EXPERT, updated: int | None = None) -> StoredKnowledge:
    """Return expert knowledge as the contents of a store."""
    now = microseconds() if updated is None else updated
    return StoredKnowledge(
        {
            (goal, option.name): Rated(option, position, source, now)
            for goal in knowledge.goals
            for position, option in enumerate(knowledge.options(goal))
        }
    )


def definition(option: Option) -> tuple[str, str]:
    """Return what an option's name stands for: its configuration and its parameters as JSON.

    Raises:
        StoreError: parameters that JSON cannot hold.

    """
    try:
        parameters = json.dumps(option.parameters, sort_keys=True)
        same = json.loads(parameters) == option.parameters
    except (TypeError, ValueError):
        same = False
    if not same:
        raise StoreError(f"{option.name}.parameters: expected text, numbers, lists and mappings by text")
    return option.configuration, parameters


def check(contents: StoredKnowledge) -> None:
    """Raise StoreError for what no store takes: unreadable names, impossible entries and times, odd parameters."""
    times = [rated.updated for rated in contents.expert.values()] + [e.updated for e in contents.learned.values()]
    for updated in times:
        if not 0 <= updated < TIME_LIMIT:
            raise StoreError(f"updated: expected a time from 1970 to 9999 [us], got {updated}")
    check_names("goal", (goal for goal, _ in contents.expert))
    for rated in contents.expert.values():
        check_names("option", [rated.option.name])
        check_names("source", [rated.source])
        definition(rated.option)
    for key, entry in contents.learned.items():
        for what, name in key._asdict().items():
            check_names(what, [name])
        if why := entry.moments.impossible():
            raise StoreError(f"{', '.join(key)}: {why}")


def check_names(what: str, names: Iterable[str]) -> None:
    """Raise StoreError for a name that no store takes; only a context may be empty."""
    for name in names:
        if not name.isprintable() or len(name) > NAME_LIMIT or (not name and what != "context"):
            raise StoreError(f"{what}: expected up to {NAME_LIMIT} printable characters, got {name!r}")


def microseconds() -> int:
    """Return the time now [us since 1970, UTC]."""
    return time.time_ns() // 1000
