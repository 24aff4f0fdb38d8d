"""The configuration of an observation: its terms and their settings.

Every component lies within [-1, 1] and is multiplied by the weight of its term. Directions are unit vectors in the
robot's own frame (`_ahead`, `_left`). Distances are divided by the longest way on the torus, or by the range within
which the thing is seen. A distance is 1 where nothing is seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Self

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, model_validator

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import Count
from clean_swarm_env.learning.observation import own_terms as own_terms
from clean_swarm_env.learning.observation import ray_terms as ray_terms
from clean_swarm_env.learning.observation import team_terms as team_terms
from clean_swarm_env.learning.observation import thing_terms as thing_terms
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.world.task import task_class
from selector.documents.errors import check_unique, validated
from selector.documents.fields import Closed, Name, Number, Positive
from selector.documents.imported import NameOrImport, registered
from selector.documents.plain import must_fit, must_know


def usual_terms(mission: MissionConfig) -> tuple[str, ...]:
    """Return the terms of an observation in a mission unless others are chosen: those of its task, then its own."""
    return (*task_class(mission).terms, *mission.terms)


class TermConfig(Closed):
    """A term of the observation; further keys are settings of its own."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Number] = Field(init=False)

    name: Annotated[NameOrImport, AfterValidator(lambda name: registered(name, TERMS))]
    """Name of a registered term, or `module:class` of one that is registered when that is imported."""
    weight: Number = 1.0
    """Factor on the components of the term [-]."""


def _by_name(given: object) -> object:
    """Read a bare name as the term of that name with weight 1."""
    return {"name": given} if isinstance(given, str) else given


class ObservationConfig(Closed):
    """What a selector sees of each robot: terms in their order, and the settings that terms share."""

    terms: Annotated[tuple[Annotated[TermConfig, BeforeValidator(_by_name)], ...], Field(min_length=1)] | None = None
    """The terms; a bare name is the term of that name with weight 1. Unless given they are those of the task and the
    mission."""
    remembers: tuple[Name, ...] = ()
    """Terms of which each robot sees, too, the largest value so far in its mission: the components `most_...`, 0 at
    first, behind all others."""
    neighbour_ranges: Annotated[tuple[Positive, ...], Field(min_length=1)] = (1.0, 1.5, 2.5)
    """Centre distances within which robots are counted [m], growing; within the last one robots are neighbours."""
    station_range: Positive = 2.0
    """Distance to a station within which a robot is near it [m]."""
    full_crowd: Count = 6
    """Number of robots in range that counts as 1."""
    patience: Positive = 60.0
    """Time without progress that counts as 1 [s]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        terms = self.terms or ()
        check_unique("terms", [term.name for term in terms])
        for name in self.remembers if self.terms is not None else ():
            must_know("term", name, [term.name for term in terms], "remembers")
        ranges = self.neighbour_ranges
        if any(near >= far for near, far in pairwise(ranges)):
            raise ValueError(f"neighbour_ranges: expected growing distances, got {list(ranges)}")
        for term in terms:
            settings, given = TERMS.find(term.name).settings(), term.__pydantic_extra__
            own = {name: optional for name, optional in settings.items() if name not in type(self).model_fields}
            for name in given:
                must_know("setting", name, own, f"terms: {term.name}")
            for name, optional in own.items():
                if not optional and name not in given:
                    raise ValueError(f"terms: {term.name}: missing setting {name!r}")
        return self

    def of(self, usual: Sequence[str], *, driven: bool = False) -> Self:
        """Return the observation with the `usual` terms, unless others were chosen.

        Robots that are `driven` by vectors hold no options, and see none.
        """
        if self.terms is not None:
            names = [term.name for term in self.terms if driven]
            must_fit("holds" not in names, "observation: terms: 'holds'", "options as actions", "mode 'velocity'")
            return self
        seen = [name for name in usual if not (driven and name == "holds")]
        given = {name: getattr(self, name) for name in self.model_fields_set}
        return validated(type(self), {**given, "terms": seen}, "observation", own=True)

    def build(self, observed: Observed) -> tuple[Term, ...]:
        """Return the terms, made for `observed`."""
        return tuple(self._built(term, observed) for term in self.terms or ())

    def _built(self, term: TermConfig, observed: Observed) -> Term:
        kind = TERMS.find(term.name)
        shared = {name: getattr(self, name) for name in kind.settings() if name in type(self).model_fields}
        return kind(observed, **shared, **term.__pydantic_extra__)
