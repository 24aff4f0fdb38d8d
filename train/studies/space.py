"""The space of a study: which values of options vary, and the expert knowledge that follows from values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution, IntDistribution

from clean_swarm_env.config.tasks import with_changes
from selector.configurations.library import library_of
from selector.documents.errors import DocumentError, validated, within
from selector.documents.parameters import Content
from selector.knowledge import Knowledge, Option, knowledge_from
from train.studies.config import Choices, Range, StudyConfig

Varied: TypeAlias = bool | int | float | str
NULL_OPTION = "Off"
"""Name of the option that does nothing for its goal."""
DIGITS = 6
"""Significant digits of a proposed number."""


@dataclass(frozen=True)
class Dimension:
    """One value that varies."""

    path: tuple[str, ...]
    """Goal, option and keys below it."""
    values: Range | Choices

    def at(self, share: float) -> Varied:
        """Return the value at a share of the way from the first to the last one, from 0 to 1."""
        if isinstance(self.values, Choices):
            return self.values.choices[min(int(share * len(self.values.choices)), len(self.values.choices) - 1)]
        low, high = self.values.low, self.values.high
        if self.values.log:
            return self.plain(math.exp(math.log(low) + share * (math.log(high) - math.log(low))))
        return self.plain(low + share * (high - low))

    @property
    def distribution(self) -> BaseDistribution:
        """The same as optuna describes it."""
        given = self.values
        if isinstance(given, Choices):
            return CategoricalDistribution(given.choices)
        if given.whole:
            return IntDistribution(int(given.low), int(given.high), log=given.log)
        return FloatDistribution(given.low, given.high, log=given.log)

    def plain(self, value: Varied) -> Varied:
        """Return a proposed value as it stands in a document."""
        if isinstance(self.values, Choices) or isinstance(value, str):
            return value
        near = min(max(float(f"{value:.{DIGITS}g}"), self.values.low), self.values.high)
        return round(near) if self.values.whole else near


class StudySpace:
    """The values that vary, and the options in which they stand.

    Args:
        study: the study.
        knowledge: the expert knowledge that the study changes.
        directories: the user's own directories of configurations.

    Attributes:
        names: name of each dimension, the path without what all paths have in common.
        dimensions: the dimensions.

    Raises:
        DocumentError: a goal, an option or a bound does not fit the knowledge and the library.

    """

    def __init__(self, study: StudyConfig, knowledge: Knowledge, directories: tuple[Path, ...] = ()) -> None:
        self._knowledge, self._library = knowledge, library_of(directories)
        self._constants: dict[str, dict[str, Content]] = {}
        self.dimensions: list[Dimension] = []
        for goal, options in study.space.items():
            own = {option.name: option.model_dump() for option in knowledge.options(goal)}
            self._constants[goal] = {}
            for name, given in options.items():
                constants, found = _split(given, (goal, name))
                base = own.get(name, {"name": name, "score": 0.0})
                self._constants[goal][name] = with_changes(base, constants)
                self.dimensions += found
        if not self.dimensions:
            raise DocumentError("space: expected at least one range or choice")
        self._check(study)
        common = 0 if len(study.space) > 1 else 1 if len(next(iter(study.space.values()))) > 1 else 2
        self.names = tuple(".".join(one.path[common:]) for one in self.dimensions)

    @property
    def goals(self) -> tuple[str, ...]:
        """The goals whose options vary."""
        return tuple(self._constants)

    @property
    def distributions(self) -> dict[str, BaseDistribution]:
        """The dimensions as optuna describes them, by name."""
        return {name: one.distribution for name, one in zip(self.names, self.dimensions, strict=True)}

    def goals_with(self, values: Sequence[Varied]) -> dict[str, list[Content]]:
        """Return the options of all goals, those of the space with `values` in the order of the dimensions."""
        varied = self._constants
        for dimension, value in zip(self.dimensions, values, strict=True):
            varied = with_changes(varied, nested(dimension.path, value))
        return self._all_goals({goal: list(options.values()) for goal, options in varied.items()})

    def unchanged(self) -> dict[str, list[Content]]:
        """Return the options of all goals, those of the space with none of its ranges and choices applied."""
        return self._all_goals({goal: list(options.values()) for goal, options in self._constants.items()})

    def null(self) -> dict[str, list[Content]] | None:
        """Return the options of all goals, of the space's goals only `NULL_OPTION`; None where a goal lacks it."""
        off = {
            goal: [option.model_dump() for option in self._knowledge.options(goal) if option.name == NULL_OPTION]
            for goal in self.goals
        }
        return self._all_goals(off) if all(off.values()) else None

    def mistake(self, goals: Mapping[str, Sequence[Content]]) -> str:
        """Return why the library cannot build these options; empty if it can."""
        try:
            self._library.check(knowledge_from({"goals": {goal: goals[goal] for goal in self.goals}}, "space"))
        except DocumentError as error:
            return str(error)
        return ""

    def served(self, goals: Mapping[str, Sequence[Content]]) -> dict[str, Content]:
        """Return for each goal of the space the option of the highest score, the first of equals."""
        return {goal: max(goals[goal], key=lambda option: float(option["score"])) for goal in self.goals}

    def _all_goals(self, varied: Mapping[str, list[Content]]) -> dict[str, list[Content]]:
        return {
            goal: [_named_apart(content, self._knowledge.options(goal)) for content in varied.get(goal, ())]
            or [option.model_dump() for option in self._knowledge.options(goal)]
            for goal in self._knowledge.goals
        }

    def _check(self, study: StudyConfig) -> None:
        """Raise DocumentError for an option that never serves, and for a bound that the library refuses."""
        for goal, options in self._constants.items():
            scored = {one.path[1] for one in self.dimensions if one.path[0] == goal and one.path[2:] == ("score",)}
            if len(options) > 1 and not scored:
                raise DocumentError(f"space.{goal}: expected a range of a score, by which one of the options serves")
            for name, content in options.items():
                validated(Option, content, f"space.{goal}.{name}")
        where, middle = "space", [dimension.at(0.5) for dimension in self.dimensions]
        for k, dimension in enumerate(self.dimensions):
            for share in (0.0, 1.0):
                value = dimension.at(share)
                with within(f"{where}.{'.'.join(dimension.path)}: {value}"):
                    if why := self.mistake(self.goals_with([*middle[:k], value, *middle[k + 1 :]])):
                        raise DocumentError(why)


def _named_apart(content: Content, known: Sequence[Option]) -> Content:
    """Return an option, under another name where its own name stands for other numbers in the knowledge."""
    given = content.get("configuration"), content.get("parameters")
    varied = any(one.name == content["name"] and (one.configuration, one.parameters) != given for one in known)
    return {**content, "name": f"{content['name']}-varied"} if varied else content


def _split(given: Content, path: tuple[str, ...]) -> tuple[Content, list[Dimension]]:
    """Return the constants of a mapping, and its ranges and choices."""
    constants: Content = {}
    dimensions: list[Dimension] = []
    for key, value in given.items():
        here = (*path, key)
        where = f"space.{'.'.join(here)}"
        if _is(value, "low"):
            dimensions.append(Dimension(here, validated(Range, value, where)))
        elif _is(value, "choices"):
            dimensions.append(Dimension(here, validated(Choices, value, where)))
        elif isinstance(value, dict):
            constants[key], below = _split(value, here)
            dimensions += below
        else:
            constants[key] = value
    return constants, dimensions


def _is(value: object, mark: str) -> bool:
    return isinstance(value, dict) and mark in value


def nested(path: Sequence[str], value: object) -> Content:
    """Return a mapping that holds only `value` at `path`."""
    return {path[0]: nested(path[1:], value) if len(path) > 1 else value}
