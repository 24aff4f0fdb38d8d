"""Typed configuration of an experiment: a mission, the conditions to compare on it, and where it starts."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.types import Scenarios
from selector.coordination.selection import BY_SCORE
from selector.documents.errors import impossible
from selector.documents.fields import Closed, Label, Name, Number
from selector.documents.trust import BASELINE, FILED_KINDS, FOREIGN_ENDINGS, check_trust
from selector.strategies.registry import StrategySpec, spec_from_text

ConditionScores = dict[str, dict[str, Number]]


def _strategy_of(given: object) -> object:
    """Return the strategy that a text describes; a text that names another kind of decider stays a text."""
    if not isinstance(given, str):
        return given
    kind, _, name = given.partition(":")
    if given == BASELINE:
        return given
    if kind not in FILED_KINDS:
        return spec_from_text(given)
    if kind == "velocity" or Path(name).suffix in FOREIGN_ENDINGS:
        check_trust(name, f"load {name}, a model of another library")
    return given


class ConditionConfig(Closed):
    """One condition: the scores and the strategy of missions of an experiment."""

    name: Name
    """Name of the condition in all results."""
    scores: ConditionScores = Field(default={})
    """Goal -> option -> score, in place of those of the expert knowledge (so a mechanism can be forced)."""
    strategy: Annotated[StrategySpec | str, BeforeValidator(_strategy_of)] = BY_SCORE
    """Strategy that decides in every decision period, by its name and parameters or as `--strategy` takes it; a machine
    or a policy decides for its own goal, and options of the highest score serve the others."""
    measured: Label | None = None
    """Name under which a file of start configurations holds the figures measured for this condition."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.scores and (own := self.deciders[1]):
            raise impossible("scores", f"none beside {own}", "some")
        return self

    @property
    def deciders(self) -> tuple[StrategySpec, str]:
        """The strategy that decides for all goals, and the machine or policy that decides for its own goal, or ""."""
        return (BY_SCORE, self.strategy) if isinstance(self.strategy, str) else (self.strategy, "")


class PublishedFigures(Closed):
    """Figures published for the scenarios of an experiment, printed beside ours."""

    source: str
    """Source of the figures."""
    figures: dict[str, dict[str, tuple[Number, ...]]]
    """Condition -> metric -> one figure per scenario, in the order of the start configurations."""


class ExperimentConfig(Closed):
    """A mission, the conditions to compare on it and their start configurations."""

    name: Name
    """Name of the experiment."""
    description: str = ""
    """What the experiment shows, in one sentence."""
    mission: MissionConfig = Field(default_factory=MissionConfig)
    """The mission."""
    conditions: Annotated[tuple[ConditionConfig, ...], Field(min_length=1)]
    """The conditions; each one runs on every start configuration."""
    starts: tuple[StartConfiguration, ...] = ()
    """The start configurations; random ones if empty."""
    scenarios: Scenarios = 30
    """Number of random start configurations when there are no given ones."""
    reference: PublishedFigures | None = None
    """Figures to print beside ours."""

    @model_validator(mode="after")
    def _unique_names(self) -> Self:
        for key, names in (
            ("conditions", [c.name for c in self.conditions]),
            ("starts", [s.id for s in self.starts]),
        ):
            for name in names:
                if names.count(name) > 1:
                    raise impossible(key, "unique names", f"{name!r} twice")
        return self
