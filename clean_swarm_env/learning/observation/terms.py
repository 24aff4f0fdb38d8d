"""The terms that an observation can be made of, and the choice of them.

A term is a named group of components; every component lies within [-1, 1] and is multiplied by the weight of its term.
Directions are unit vectors in the robot's own frame (`_ahead`, `_left`); distances are divided by the longest way on
the torus, or by the range within which the thing is seen, and are 1 where nothing is seen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from clean_swarm_env.config.types import Count
from selector.documents.fields import Closed, Name, Number, Positive
from selforg.registry import unknown

PHASES = ("patrol", "approach", "to_recycling", "to_dump")
"""What a robot is about, in the order of their numbers: no item in sight, an item in sight, cargo, recycled cargo."""
PATROL, APPROACH, TO_RECYCLING, TO_DUMP = range(4)

TERMS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "garbage": (
        "The nearest item: whether one lies within sight, and the way to it by the range of sight.",
        ("garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left"),
    ),
    "cargo": ("Whether the robot carries something, and whether that has been recycled.", ("carrying", "recycled")),
    "phase": (
        "One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump.",
        tuple(f"phase_{phase}" for phase in PHASES),
    ),
    "situation": (
        "One flag: without or with cargo, far from both stations or within `station_range` of one.",
        ("free_far", "free_near", "carrying_far", "carrying_near"),
    ),
    "recycling": (
        "The way to the recycling station, by half the torus' diagonal.",
        ("recycling_distance", "recycling_ahead", "recycling_left"),
    ),
    "dump": ("The way to the dump, by half the torus' diagonal.", ("dump_distance", "dump_ahead", "dump_left")),
    "nearness": (
        "How near the stations are: 1 at a station, 0 from `station_range` on.",
        ("recycling_near", "dump_near"),
    ),
    "target": (
        "The way to the station that the cargo has to go to, by half the torus' diagonal.",
        ("target_distance", "target_ahead", "target_left"),
    ),
    "neighbour": (
        "The share of the other robots within the largest neighbour range, and the way to the nearest by that range.",
        ("neighbours", "neighbour_distance", "neighbour_ahead", "neighbour_left"),
    ),
    "encounter": (
        "The nearest neighbour: its heading in the robot's frame, how fast it comes closer by twice the largest speed, "
        "whether it carries something.",
        ("neighbour_heading_ahead", "neighbour_heading_left", "neighbour_closing", "neighbour_carries"),
    ),
    "crowd": ("Robots within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team.", ()),
    "carriers": ("Robots with cargo within the largest neighbour range, by `full_crowd`.", ("carriers",)),
    "avoidance": (
        "Length of the avoidance vector by the reach of a pose, and whether the robot avoids others just now.",
        ("avoidance_length", "avoiding"),
    ),
    "movement": ("Speed and turn rate of the drive, by the largest ones.", ("speed", "turn_rate")),
    "mission": (
        "Share of the items dumped of those that arrived, and of the time limit that is left.",
        ("garbage_done", "time_left"),
    ),
    "idle": ("Time since the robot last picked, recycled or dumped something, by `patience`.", ("idle",)),
    "density": ("Share of the torus within 1 m of the robots, if they were far apart.", ("density",)),
    "holds": ("One flag for each option of each coordinated goal: is it held?", ()),
}
"""Name -> what the term says and its components; those of `crowd` and `holds` depend on ranges and options."""


class TermConfig(Closed):
    """A term of the observation."""

    name: Name
    """One of the terms of `observation_terms.TERMS`."""
    weight: Number = 1.0
    """Factor on the components of the term [-]."""

    @model_validator(mode="after")
    def _known(self) -> Self:
        if self.name not in TERMS:
            raise ValueError(unknown("term", self.name, tuple(TERMS)))
        return self


def _by_name(given: object) -> object:
    """Read a bare name as the term of that name with weight 1."""
    return {"name": given} if isinstance(given, str) else given


class ObservationConfig(Closed):
    """What a selector sees of each robot: terms in their order, and the ranges that they use."""

    terms: Annotated[tuple[Annotated[TermConfig, BeforeValidator(_by_name)], ...], Field(min_length=1)] = tuple(
        TermConfig(name=name) for name in TERMS
    )
    """The terms; a bare name stands for weight 1."""
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
        names = [term.name for term in self.terms]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"terms: {name!r} is given twice")
        ranges = self.neighbour_ranges
        if any(near >= far for near, far in pairwise(ranges)):
            raise ValueError(f"neighbour_ranges: expected growing distances, got {list(ranges)}")
        return self


def components(term: str, ranges: Sequence[float], options: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """Return the names of the components of a term; `options` by coordinated goal."""
    if term == "crowd":
        return tuple(f"crowd_{distance:g}m" for distance in ranges)
    if term == "holds":
        return tuple(holds(goal, option, options) for goal, names in options.items() for option in names)
    return TERMS[term][1]


def holds(goal: str, option: str, options: Mapping[str, Sequence[str]]) -> str:
    """Return the name of the flag for an option; the goal is part of it where several goals are coordinated."""
    return f"holds_{option}" if len(options) == 1 else f"holds_{goal}_{option}"
