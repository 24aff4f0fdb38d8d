"""Expert knowledge: the options that can serve each goal, with scores by an expert and what was learned of them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from selector.documents.errors import DocumentError, check_unique, shown, validated
from selector.documents.fields import JOINT, Closed, DocumentName, Label, Name, NonNegative, Number, checked_name
from selector.documents.find import all_files, files_of, find_file
from selector.documents.plain import must_know, plain, short
from selector.documents.reading import read_mapping
from selforg.arrays import Floats
from selforg.registry import unknown

ENOUGH = 5
"""Rewards from which their mean takes the place of the expert's score."""


class Definition(Closed):
    """What the name of an option stands for: a configuration, and values for its parameters."""

    configuration: Label
    """Key of the configuration in the library."""
    parameters: dict[Label, Any] = Field(default_factory=dict)
    """Values that override the parameters of the configuration."""

    @property
    def meaning(self) -> str:
        """Both in a line."""
        return plain(f"{self.configuration} {dict(sorted(self.parameters.items()))}".lstrip())

    def same(self, other: "Definition") -> bool:
        """Return whether two options are one thing, whatever their scores."""
        return (self.configuration, self.parameters) == (other.configuration, other.parameters)


Definitions = Mapping[str, Mapping[str, Definition]]
"""Goal -> option -> what its name stands for."""


def check_same(where: str, trained: Definitions, here: Definitions) -> None:
    """Raise DocumentError, which begins with `where`, for a name that stands for another option `here`."""
    for goal, options in trained.items():
        for name, one in options.items():
            other = here.get(goal, {}).get(name, one)
            if not one.same(other):
                raise DocumentError(f"{where}: {goal}: option {name!r}: expected {one.meaning}, got {other.meaning}")


class Option(Definition):
    """One way to serve a goal."""

    score: Number
    """How well the option serves the goal, by the expert [-]; the option of the highest score is taken."""
    name: Label = ""
    """Name, unique among the options of a goal; the key of the configuration unless given."""

    @model_validator(mode="before")
    @classmethod
    def _named_by_configuration(cls, given: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
        if isinstance(given, Mapping) and "name" not in given and "configuration" in given:
            return {**given, "name": given["configuration"]}
        return given


class _ListedOption(Option):
    """An option in a knowledge file: one of the library by its name, or one of the file's own by its configuration."""

    configuration: Label = ""
    """Key of the configuration; empty for an option of the library."""

    def defined(self, library: Mapping[str, Option], where: str) -> Option:
        """Return the option with what it stands for; DocumentError if the library has none, or another of its name."""
        known = library.get(self.name)
        if known is None and self.configuration:
            return Option(**self.model_dump())
        if known is None:
            own = "one of your own needs a configuration"
            raise DocumentError(f"{where}: {unknown('option', self.name, tuple(library))}; {own}")
        if (self.configuration or self.parameters) and not self.same(known):
            expected = f"expected {known.meaning}, as in the library, got {self.meaning}"
            how = f"take that by {{name: {self.name}}}, or give yours another name"
            raise DocumentError(f"{where}: option {self.name!r}: {expected}; {how}")
        return known.model_copy(update={"score": self.score})


class LearnedScore(Closed):
    """The rewards that one option brought."""

    count: Annotated[int, Field(strict=True, ge=1)]
    """Number of rewards."""
    mean: Number
    """Their mean [-]."""
    variance: NonNegative
    """Their mean squared deviation from the mean."""


LearnedScores = dict[Name, dict[Name, LearnedScore]]
"""Goal -> option -> what was learned of it."""


class _KnowledgeFile(Closed):
    """The content of a knowledge file."""

    description: str = ""
    """What the knowledge is for."""
    robot: DocumentName | Literal[""] = ""
    """Document of robots that coordinate these goals, which missions with this knowledge take; their own unless
    given."""
    goals: dict[Name, Annotated[tuple[_ListedOption, ...], Field(min_length=1)]]
    """Options by goal."""
    learned: LearnedScores = Field(default={})
    """Rewards of options, as `clean-swarm knowledge export --context` writes them."""

    @model_validator(mode="after")
    def _unique_names(self) -> Self:
        for goal, options in self.goals.items():
            check_unique(f"goals.{goal}", [checked_name(option.name, f"goals.{goal}: name") for option in options])
        return self


@dataclass(frozen=True)
class Knowledge:
    """The options of each goal, in the order of the file.

    Attributes:
        table: options by goal, each goal with at least one.
        source: the file that the knowledge was read from, for error messages.
        learned: rewards of some options.
        robot: document of the robots that coordinate the goals; empty: that of the mission.

    """

    table: Mapping[str, tuple[Option, ...]]
    source: str = "knowledge"
    learned: LearnedScores = field(default_factory=dict)
    robot: str = ""

    @property
    def goals(self) -> tuple[str, ...]:
        """Names of the goals that the knowledge covers."""
        return tuple(self.table)

    def options(self, goal: str) -> tuple[Option, ...]:
        """Return the options of a goal, O of them."""
        must_know("goal", goal, self.goals, self.source)
        return self.table[goal]

    def scores(self, goal: str) -> Floats:
        """Return the expert's scores (O,) of the options of a goal."""
        return np.array([option.score for option in self.options(goal)], dtype=np.float64)

    def rewards(self, goal: str) -> Floats:
        """Return count, mean and variance of the rewards (3, O) of the options of a goal; 0 where none is known."""
        known = self.learned.get(goal, {})
        found = (known.get(option.name) for option in self.options(goal))
        return np.array([(one.count, one.mean, one.variance) if one else (0.0, 0.0, 0.0) for one in found]).T

    def with_learned(self, learned: LearnedScores) -> "Knowledge":
        """Return the knowledge with `learned` in place of its own learned rewards of the same options.

        Raises:
            DocumentError: a goal or an option is unknown.

        """
        for goal, scores in learned.items():
            self._check_options(goal, scores)
        merged = {goal: self.learned.get(goal, {}) | scores for goal, scores in learned.items()}
        return replace(self, learned=self.learned | merged)

    def with_scores(self, scores: Mapping[str, Mapping[str, float]]) -> "Knowledge":
        """Return the knowledge with some scores replaced: goal -> option name -> score.

        What was learned of these options is dropped, so that the given scores count.

        Raises:
            DocumentError: a goal or an option is unknown, or a score is not a finite number.

        """
        table, learned = dict(self.table), dict(self.learned)
        for goal, changes in scores.items():
            self._check_options(goal, changes)
            for name, score in changes.items():
                if not np.isfinite(score):
                    raise DocumentError(f"{self.source}: goals.{goal}.{name}: expected a finite score, got {score}")
            table[goal] = tuple(
                option.model_copy(update={"score": float(changes.get(option.name, option.score))})
                for option in table[goal]
            )
            learned[goal] = {name: one for name, one in learned.get(goal, {}).items() if name not in changes}
        return replace(self, table=table, learned=learned)

    def _check_options(self, goal: str, given: Iterable[str]) -> None:
        names = [option.name for option in self.options(goal)]
        for name in given:
            must_know_option(goal, name, names, f"{self.source}: goals.{goal}")


def learned_from(content: object, where: str) -> LearnedScores:
    """Return what was learned of options from plain data; errors begin with `where`."""
    if not (isinstance(content, Mapping) and all(isinstance(scores, Mapping) for scores in content.values())):
        raise DocumentError(f"{where}: expected a mapping of options by goal, got {short(content)}")
    return {
        goal: {name: validated(LearnedScore, one, f"{where}.{goal}.{name}") for name, one in scores.items()}
        for goal, scores in content.items()
    }


def believed(scores: Floats, rewards: Floats) -> Floats:
    """Return the scores (O,) that count: the mean reward where `ENOUGH` are known, else the expert's (O,).

    Of fewer rewards and the expert the lower one counts: few can show that a claim is too high, not make a claim
    (docs/decisions/0060-learned-scores.md).

    Args:
        scores: (O,) by the expert.
        rewards: (3, O) count, mean and variance of the rewards known.

    """
    count, mean = rewards[:2]
    return np.where(count >= ENOUGH, mean, np.where(count > 0, np.minimum(mean, scores), scores))


def library_options(goal: str, directories: Sequence[Path] = ()) -> tuple[Option, ...]:
    """Return the options that the library has for a goal, with scores of 0: those of all files `options/GOAL.yaml`.

    A name stands for one option (docs/decisions/0224-one-name-one-option.md).

    Raises:
        DocumentError: a file has a mistake, or another option under a name of an earlier file.

    """
    found: dict[str, Option] = {}
    for path in all_files("options", goal, directories):
        own = {option.name: option for option in options_in(path)}
        check_same(shown(path), {goal: found}, {goal: own})
        found |= own
    return tuple(found.values())


def options_in(path: Path) -> tuple[Option, ...]:
    """Return the options of one file of the library, with scores of 0; DocumentError if it has a mistake."""
    where, content = shown(path), read_mapping(path)
    read = {checked_name(name, where): validated(Definition, one, f"{where}: {name}") for name, one in content.items()}
    return tuple(Option(name=name, score=0.0, **one.model_dump()) for name, one in read.items())


def knowledge_from(content: object, source: str = "knowledge", directories: Sequence[Path] = ()) -> Knowledge:
    """Return the knowledge in a mapping that has the form of a knowledge file.

    Its options are those of the library, which `directories` add to, and its own.
    """
    file, table = validated(_KnowledgeFile, content, source), {}
    for goal, options in file.goals.items():
        library = {option.name: option for option in library_options(goal, directories)}
        table[goal] = tuple(option.defined(library, f"{source}: goals.{goal}") for option in options)
    return Knowledge(table, source, robot=file.robot).with_learned(file.learned)


def must_know_option(goal: str, name: str, known: Collection[str], where: str) -> None:
    """Raise DocumentError for an option that is not among those `known`; names the knowledge that has it for the goal.

    Names of several goals, and of their options, are joined by `+`.
    """
    if name in known:
        return
    goals, wanted = goal.split(JOINT), set(name.split(JOINT))
    holding = [
        other
        for other, table in ((other, load_knowledge(other).table) for other in files_of("knowledge"))
        if wanted <= {option.name for each in goals for option in table.get(each, ())}
    ]
    found = f"; it is in the knowledge {', '.join(holding)} (--knowledge)" if holding else ""
    must_know("option", name, known, where, found)


def load_knowledge(name: str, directories: Sequence[Path] = ()) -> Knowledge:
    """Return the knowledge of a name, from the first directory that holds `knowledge/NAME.yaml`, or of a path.

    Raises:
        DocumentError: there is no such file, or it has a mistake.

    """
    path = find_file("knowledge", name, directories)
    return knowledge_from(read_mapping(path), shown(path), directories)
