"""Document model of a study: what is varied, what counts, how it is searched and how candidates race."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.types import Scenarios
from selector.documents.errors import impossible
from selector.documents.fields import LARGEST_NUMBER, Closed, DocumentName, Flag, Label, Name, Number
from train.learning.racing import RaceConfig
from train.running.run_folder import versions

WholeNumber = Annotated[int, Field(strict=True, ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
Method = Literal["random", "TPE", "CMA-ES"]
STUDY_PACKAGES = ("optuna", "cmaes")
"""The packages of the extra `tune`, which everything else here needs."""
RANDOM: Method = "random"


class Range(Closed):
    """A number between two bounds."""

    low: Number
    """Least value."""
    high: Number
    """Largest value."""
    log: Flag = False
    """Whether equal ratios, not equal differences, are equally likely."""
    whole: Flag = False
    """Whether only whole numbers are meant."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        least = 1.0 if self.whole else 0.0
        if self.low >= self.high:
            raise impossible("high", f"more than low, {self.low:g}", f"{self.high:g}")
        if self.log and (self.low < least or self.low == 0.0):
            raise impossible("low", "at least 1" if self.whole else "more than 0 with log", f"{self.low:g}")
        if self.whole and not (self.low.is_integer() and self.high.is_integer()):
            raise impossible("low", "whole bounds", f"{self.low:g} and {self.high:g}")
        return self


class Choices(Closed):
    """One of several values."""

    choices: Annotated[tuple[Flag | WholeNumber | Number | Label, ...], Field(min_length=2, max_length=1000)]
    """The values."""


class LastConfig(Closed):
    """The last race, on fresh training scenarios, and the statement of the costs on further ones."""

    finalists: Annotated[int, Field(strict=True, ge=1, le=100)] = 5
    """Most candidates that stay in the races, and take part in the last one."""
    scenarios: Scenarios = 100
    """Scenarios of the last race at most, and as many further ones of the statement."""


class StudyConfig(Closed):
    """One study."""

    name: Name
    """Name of the study and of its result."""
    description: str = ""
    """What is looked for, in one sentence."""
    family: DocumentName
    """Family of which the training scenarios are used; its name, or the path of its YAML file."""
    knowledge: DocumentName | None = None
    """Expert knowledge with the options, in place of the family's own."""
    space: Annotated[dict[Name, Annotated[dict[Name, dict[Label, Any]], Field(min_length=1)]], Field(min_length=1)]
    """Goal -> option -> what replaces or adds to its keys. A mapping with `low` and `high` is a range, one with
    `choices` a choice, and anything else a constant. Of several options of a goal that of the highest score serves."""
    method: Method = "TPE"
    """Method by which candidates of a low mean cost are proposed; random search runs beside it."""
    trials: Annotated[int, Field(strict=True, ge=2, le=100_000)] = 60
    """Number of candidates of each method."""
    batch: Annotated[int, Field(strict=True, ge=2, le=1000)] = 6
    """Candidates that are proposed at once, whatever the number of workers is; a method learns from each batch."""
    race: RaceConfig = RaceConfig()
    """The race of each batch."""
    last: LastConfig = LastConfig()
    """The last race and the statement."""

    @property
    def methods(self) -> tuple[Method, ...]:
        """The method, and random search beside it."""
        return (self.method,) if self.method == RANDOM else (self.method, RANDOM)


def study_versions() -> dict[str, str]:
    """Return the versions of all packages that a study depends on; DocumentError for a missing one."""
    return versions(STUDY_PACKAGES, "studies need", "tune")
