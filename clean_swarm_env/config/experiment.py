"""Typed configuration of an experiment: a mission, the conditions to compare on it, and where it starts."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig, OptionScores, StartConfiguration
from clean_swarm_env.config.starts import for_start, run_seed
from clean_swarm_env.config.types import Scenarios
from selector.documents.errors import check_unique
from selector.documents.fields import Closed, Label, Name, Number
from selector.documents.plain import must_know
from selector.documents.trust import BASELINE, FILED_KINDS, FOREIGN_ENDINGS, check_trust
from selector.strategies.registry import BY_SCORE, spec_from_text


def _checked(given: str) -> str:
    """Return the text of a strategy; a mistake in it is an error of one line."""
    kind, _, name = given.partition(":")
    if kind not in (*FILED_KINDS, BASELINE):
        spec_from_text(given)
    elif kind == "velocity" or Path(name).suffix in FOREIGN_ENDINGS:
        check_trust(name, f"load {name}, a model of another library")
    return given


class ConditionConfig(Closed):
    """One condition: the scores and the strategy of missions of an experiment."""

    name: Name
    """Name of the condition in all results."""
    scores: OptionScores = Field(default={})
    """Goal -> option -> score, in place of that of the expert knowledge; options that are not named keep theirs. A
    mechanism is forced by `strategy: "fixed:OPTION"`."""
    strategy: Annotated[str, AfterValidator(_checked)] = BY_SCORE
    """What decides in every decision period, as `--strategy` takes it: for the goal that it was made for, else for
    AvoidCollision or the first one; options of the highest score serve the others."""
    measured: Label | None = None
    """Name under which a file of start configurations holds the figures measured for this condition."""


class PublishedFigures(Closed):
    """Figures published for the scenarios of an experiment, printed beside ours."""

    source: str
    """Source of the figures."""
    figures: dict[str, dict[str, tuple[Number, ...]]]
    """Condition -> metric -> one figure per scenario, in the order of the start configurations."""


class GivenStarts(Closed):
    """A mission, and the start configurations of its scenarios."""

    name: Name
    """Name of the experiment."""
    description: str = ""
    """What the experiment shows, in one sentence."""
    mission: MissionConfig = Field(default_factory=MissionConfig)
    """The mission."""
    starts: tuple[StartConfiguration, ...] = ()
    """The start configurations; random ones if empty."""

    @property
    def variants(self) -> Mapping[str, Self]:
        """The mission as it is, without a name; see `FamilyConfig`."""
        return {"": self}

    @property
    def largest(self) -> MissionConfig:
        """The mission with the most robots and items."""
        most = max(self.starts, key=lambda start: len(start.robots) + len(start.items))
        return for_start(self.mission, most)

    def scenario_named(self, seed: int, name: str) -> Scenario:
        """Return the scenario that begins as the start of a name; DocumentError if there is none."""
        found = {start.id: start for start in self.starts}
        must_know("scenario", name, found)
        return Scenario(name, run_seed(seed, name), for_start(self.mission, found[name]), found[name])

    def bound(self, name: str) -> MissionConfig:
        """Return the mission of a scenario; DocumentError if there is no such scenario."""
        return self.scenario_named(0, name).mission


class ExperimentConfig(GivenStarts):
    """A mission, the conditions to compare on it and their start configurations."""

    conditions: Annotated[tuple[ConditionConfig, ...], Field(min_length=1)]
    """The conditions; each one runs on every start configuration."""
    scenarios: Scenarios = 30
    """Number of random start configurations when there are no given ones."""
    reference: PublishedFigures | None = None
    """Figures to print beside ours."""

    @model_validator(mode="after")
    def _unique_names(self) -> Self:
        check_unique("conditions", [condition.name for condition in self.conditions])
        check_unique("starts", [start.id for start in self.starts])
        return self
