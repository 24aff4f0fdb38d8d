"""Files of start configurations of cleaning, with the figures measured on them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.types import Point
from clean_swarm_env.tasks.cleaning.settings import settings_of
from selector.documents.errors import impossible, shown, validated
from selector.documents.fields import Closed, Positive
from selector.documents.reading import read_json


class StartsCase(StartConfiguration, extra="ignore"):
    """One case of a file of start configurations."""

    measured: dict[str, dict[str, float | None]] = Field(default={})
    """Name of a condition -> figure -> value, as measured on this case by another implementation."""


class StartsFile(Closed, extra="ignore"):
    """A file of start configurations with its torus and stations; further keys are ignored, for the files of others."""

    torus_m: tuple[Positive, Positive]
    """Lengths of the torus along x and y [m]."""
    recycling: Point
    """Position of the recycling station [m]."""
    dump: Point
    """Position of the dump station [m]."""
    cases: Annotated[tuple[StartsCase, ...], Field(min_length=1)]
    """The start configurations, each with the figures measured on it."""

    @model_validator(mode="after")
    def _unique_ids(self) -> Self:
        ids = [case.id for case in self.cases]
        for twice in (one for one in ids if ids.count(one) > 1):
            raise impossible("cases", "unique ids", f"{twice!r} twice")
        return self

    @property
    def starts(self) -> tuple[StartConfiguration, ...]:
        """The start configurations alone."""
        return tuple(StartConfiguration(id=c.id, robots=c.robots, items=c.items) for c in self.cases)

    @property
    def measured(self) -> Mapping[str, Mapping[str, Mapping[str, float | None]]]:
        """Scenario -> name of a condition -> figure -> value."""
        return {case.id: case.measured for case in self.cases}

    def world_of(self, mission: MissionConfig) -> MissionConfig:
        """Return `mission` on the torus and with the stations of this file."""
        width, height = self.torus_m
        world = mission.world.model_copy(update={"width": width, "height": height})
        task = settings_of(mission)
        stations = task.stations.model_copy(update={"recycling": self.recycling, "dump": self.dump})
        parts = {"world": world.model_dump(), "task": task.model_copy(update={"stations": stations}).model_dump()}
        return validated(
            MissionConfig, {**mission.model_dump(), **parts}, "the mission on the torus of this file", own=True
        )


def load_starts(path: Path) -> StartsFile:
    """Read a JSON file of start configurations; a file that cannot be used raises ConfigurationError."""
    return validated(StartsFile, read_json(path), shown(path))
