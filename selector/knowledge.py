"""Expert knowledge: the options that can serve each goal, with scores by an expert."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, Label, Name, Number, checked_name
from selector.documents.find import find_file
from selector.documents.reading import read_mapping
from selforg.arrays import Floats
from selforg.registry import unknown


class Option(Closed):
    """One way to serve a goal: a configuration, and values for its parameters."""

    configuration: Label
    """Key of the configuration in the library."""
    score: Number
    """How well the option serves the goal, by the expert [-]; the option of the highest score is taken."""
    parameters: dict[Label, Any] = Field(default_factory=dict)
    """Values that override the parameters of the configuration."""
    name: Label = ""
    """Name, unique among the options of a goal; the key of the configuration unless given."""

    @model_validator(mode="before")
    @classmethod
    def _named_by_configuration(cls, given: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
        if isinstance(given, Mapping) and "name" not in given and "configuration" in given:
            return {**given, "name": given["configuration"]}
        return given


class _KnowledgeFile(Closed):
    """The content of a knowledge file."""

    description: str = ""
    """What the knowledge is for."""
    goals: dict[Name, Annotated[tuple[Option, ...], Field(min_length=1)]]
    """Options by goal."""

    @model_validator(mode="after")
    def _unique_names(self) -> Self:
        for goal, options in self.goals.items():
            names = [checked_name(option.name, f"goals.{goal}: name") for option in options]
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"goals.{goal}: option {name!r} is given twice")
        return self


@dataclass(frozen=True)
class Knowledge:
    """The options of each goal, in the order of the file.

    Attributes:
        table: options by goal, each goal with at least one.
        source: the file that the knowledge was read from, for error messages.

    """

    table: Mapping[str, tuple[Option, ...]]
    source: str = "knowledge"

    @property
    def goals(self) -> tuple[str, ...]:
        """Names of the goals that the knowledge covers."""
        return tuple(self.table)

    def options(self, goal: str) -> tuple[Option, ...]:
        """Return the options of a goal, O of them."""
        if goal not in self.table:
            raise DocumentError(f"{self.source}: {unknown('goal', goal, self.goals)}")
        return self.table[goal]

    def scores(self, goal: str) -> Floats:
        """Return the scores (O,) of the options of a goal."""
        return np.array([option.score for option in self.options(goal)], dtype=np.float64)

    def with_scores(self, scores: Mapping[str, Mapping[str, float]]) -> "Knowledge":
        """Return the knowledge with some scores replaced: goal -> option name -> score.

        Raises:
            DocumentError: a goal or an option is unknown, or a score is not a finite number.

        """
        table = dict(self.table)
        for goal, changes in scores.items():
            names = [option.name for option in self.options(goal)]
            for name, score in changes.items():
                if name not in names:
                    raise DocumentError(f"{self.source}: goals.{goal}: {unknown('option', name, names)}")
                if not np.isfinite(score):
                    raise DocumentError(f"{self.source}: goals.{goal}.{name}: expected a finite score, got {score}")
            table[goal] = tuple(
                option.model_copy(update={"score": float(changes.get(option.name, option.score))})
                for option in table[goal]
            )
        return replace(self, table=table)


def knowledge_from(content: object, source: str = "knowledge") -> Knowledge:
    """Return the knowledge in a mapping that has the form of a knowledge file."""
    return Knowledge(validated(_KnowledgeFile, content, source).goals, source)


def load_knowledge(name: str, directories: Sequence[Path] = ()) -> Knowledge:
    """Return the knowledge of a name, from the first directory that holds `knowledge/NAME.yaml`, or of a path.

    Raises:
        DocumentError: there is no such file, or it has a mistake.

    """
    path = find_file("knowledge", name, directories)
    return knowledge_from(read_mapping(path), shown(path))
