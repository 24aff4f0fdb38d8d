"""The contents of a store as values: expert options and learned entries, which can be merged."""

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from selector.knowledge import Knowledge, LearnedScore, LearnedScores, Option
from selector.store.errors import StoreError
from selector.store.exact_sums import NO_REWARDS, Moments

EXPERT = "expert"
"""Default source of expert knowledge."""


class Key(NamedTuple):
    """The key of a learned entry, which sums up the rewards of one goal, option and context from one source."""

    goal: str
    option: str
    context: str
    source: str


@dataclass(frozen=True)
class LearnedEntry:
    """The sums of rewards under a key."""

    moments: Moments
    updated: int
    """Time of the last update [us since 1970, UTC]."""

    def plus(self, other: "LearnedEntry") -> "LearnedEntry":
        """Return the entry with the rewards of both."""
        return LearnedEntry(self.moments + other.moments, max(self.updated, other.updated))

    def merged(self, other: "LearnedEntry") -> "LearnedEntry":
        """Return the later state of the entry of one source; StoreError unless its rewards begin with the other's."""
        fewer, more = sorted((self.moments, other.moments), key=lambda moments: moments.count)
        if not more.holds(fewer):
            raise StoreError(f"holds {more.count} rewards here that do not begin with the {fewer.count} there")
        return LearnedEntry(more, max(self.updated, other.updated))


@dataclass(frozen=True)
class Rated:
    """An option by an expert."""

    option: Option
    position: int
    """Place among the options of its goal; the first of equals is taken."""
    source: str
    updated: int
    """Time at which it was given [us since 1970, UTC]."""

    def merged(self, other: "Rated") -> "Rated":
        """Return the later of both; StoreError if the option means different things in them."""
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
        """Return the merged contents of both; neither the order matters nor what both hold already.

        Raises:
            StoreError: an option has different configurations or parameters in them, or a source other rewards.

        """
        expert = dict(self.expert)
        for (goal, name), rated in other.expert.items():
            try:
                expert[goal, name] = expert[goal, name].merged(rated) if (goal, name) in expert else rated
            except StoreError as error:
                raise StoreError(f"goals.{goal}.{error}; give one of them another name") from error
        learned = dict(self.learned)
        for key, entry in other.learned.items():
            try:
                learned[key] = learned[key].merged(entry) if key in learned else entry
            except StoreError as error:
                raise StoreError(f"{key.goal}: {key.option}: source {key.source!r} {error}") from error
        return StoredKnowledge(expert, learned)

    def only(self, other: "StoredKnowledge") -> "StoredKnowledge":
        """Return the part of the contents whose keys are those of `other`."""
        return StoredKnowledge(
            {key: self.expert[key] for key in other.expert}, {key: self.learned[key] for key in other.learned}
        )

    def totals(self) -> dict[tuple[str, str, str], Moments]:
        """Return the sums over all sources, by goal, option and context."""
        sums: dict[tuple[str, str, str], Moments] = {}
        for key, entry in self.learned.items():
            sums[key[:3]] = sums.get(key[:3], NO_REWARDS) + entry.moments
        return sums

    def scores(self, knowledge: Knowledge, context: str) -> LearnedScores:
        """Return what was learned in a context of the options of expert knowledge, over all sources.

        Raises:
            StoreError: an option has another configuration or other parameters here.

        """
        self.check_same(knowledge)
        sums = self.totals()
        found: LearnedScores = {}
        for goal in knowledge.goals:
            for option in knowledge.options(goal):
                if moments := sums.get((goal, option.name, context)):
                    score = LearnedScore(count=moments.count, mean=moments.mean, variance=moments.variance)
                    found.setdefault(goal, {})[option.name] = score
        return found

    def check_same(self, knowledge: Knowledge) -> None:
        """Raise StoreError if an option of expert knowledge has another configuration or other parameters here."""
        try:
            self.merged(stored(knowledge))
        except StoreError as error:
            raise StoreError(f"{knowledge.source}: {error}") from error

    def options_by_goal(self) -> dict[str, list[Rated]]:
        """Return the expert options of each goal in their order, goals in the order of their names."""
        table: dict[str, list[Rated]] = {}
        for (goal, _), rated in sorted(self.expert.items(), key=lambda item: (item[0][0], item[1].position, item[0])):
            table.setdefault(goal, []).append(rated)
        return table

    def knowledge(self, source: str) -> Knowledge:
        """Return the expert options as expert knowledge; `source` is named in its errors."""
        table = self.options_by_goal()
        return Knowledge({goal: tuple(rated.option for rated in options) for goal, options in table.items()}, source)


NO_KNOWLEDGE = StoredKnowledge()
"""What an empty store holds."""


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
    """Return the meaning of an option's name: its configuration, and its parameters as JSON.

    Raises:
        StoreError: JSON cannot hold the parameters.

    """
    try:
        parameters = json.dumps(option.parameters, sort_keys=True)
        same = json.loads(parameters) == option.parameters
    except (TypeError, ValueError):
        same = False
    if not same:
        raise StoreError(f"{option.name}.parameters: expected text, numbers, lists and mappings by text")
    return option.configuration, parameters


def microseconds() -> int:
    """Return the time now [us since 1970, UTC]."""
    return time.time_ns() // 1000
