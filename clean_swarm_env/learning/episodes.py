"""Sources of episodes for worlds: a mission from random starts, or scenarios of a family.

Every episode is a `Scenario`. An episode of a series follows from a seed and its number.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypedDict

import numpy as np
from pydantic import Field

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split
from clean_swarm_env.config.known import knowing
from clean_swarm_env.config.load import load_named
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.given import (
    GivenFamily,
    GivenMission,
    Named,
    checked,
    directories_from,
    family_from,
    mission_from,
    whole_number,
)
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.reward import GivenReward
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.fields import Closed, Flag
from selector.documents.trust import reading_files
from selforg.plugins import import_named

Size = tuple[float, float]
"""Width and height of a torus [m]."""
EpisodeSource = Callable[[int], Scenario | None]
"""Function from the number of a world to its next scenario, None if there is none left."""
Following = tuple[int, int, int]
"""Seed and number of the next episode of a series, and the step to the number after it."""


@dataclass(frozen=True)
class Episodes:
    """The episodes of a mission: random starts; or of a family: scenarios of a split, those on the torus of `size`."""

    source: MissionConfig | FamilyConfig
    split: Split = "train"
    size: Size | None = None

    @property
    def fewest(self) -> int:
        """The least number of robots at the start of an episode."""
        return self.source.robots[0] if isinstance(self.source, FamilyConfig) else self.source.robots.count

    @property
    def tori(self) -> tuple[Size | None, ...]:
        """The tori of a family; one that needs no name for a mission."""
        return self.source.tori if isinstance(self.source, FamilyConfig) else (None,)

    def check_size(self) -> None:
        """Raise ValueError unless `size` is a torus of the family, or the family has one torus only."""
        if self.size not in self.tori and (self.size or len(self.tori) > 1):
            known = ", ".join(f"{own}" for own in self.tori)
            raise ValueError(f"size: expected one of those of family {self.source.name!r}, {known}, got {self.size}")

    def draw(self, seed: int, number: int) -> Scenario:
        """Return an episode, on whatever torus."""
        if isinstance(self.source, FamilyConfig):
            return self.source.scenario(seed, number, self.split)
        start = random_start(self.source, seed, number)
        return Scenario(start.id, run_seed(seed, f"episode {number}"), self.source, start)

    def following(self, place: Following) -> tuple[Scenario, Following]:
        """Return the first episode of a series from a place on, and the place after it."""
        seed, number, step = place
        drawn = isinstance(self.source, FamilyConfig) and self.size and (self.source.sizes or self.source.alternatives)
        while True:
            scenario = self.draw(seed, number)
            number += step
            world = scenario.mission.world
            if not drawn or (world.width, world.height) == self.size:
                return scenario, (seed, number, step)


class Series:
    """The source of W worlds whose episodes follow from seeds.

    >>> series = Series(episodes_of("table1"), worlds=2)
    >>> series.reset(0, 5)
    >>> series.reset(1, 6)
    >>> [series(0).id, series(0).id, series(1).id]
    ['1', '2', '1']
    >>> series.share(5)
    >>> [series(0).id, series(0).id, series(1).id]
    ['1', '3', '2']

    """

    def __init__(self, episodes: Episodes, worlds: int) -> None:
        self._episodes = episodes
        self._places: list[Following | None] = [None] * worlds

    def __call__(self, world: int) -> Scenario:
        """Return the next episode of a world."""
        place = self._places[world]
        assert place is not None
        scenario, self._places[world] = self._episodes.following(place)
        return scenario

    def reset(self, world: int, seed: int | None) -> None:
        """Give a world the episodes 0, 1, ... of a seed.

        Without a seed (None) it continues its episodes, or begins those of a seed drawn from the system.
        """
        if seed is not None or self._places[world] is None:
            known = np.random.SeedSequence().entropy if seed is None else seed
            self._places[world] = (int(known), 0, 1)  # type: ignore[arg-type]

    def part_of(self, world: int) -> Following | None:
        """Return the place of the next episode of a world; None before its first."""
        return self._places[world]

    def put_part(self, world: int, place: Following | None, later: float) -> None:
        """Let a world continue with the episode at a place, at any time of the clock."""
        self._places[world] = place

    def share(self, seed: int, first: int = 0, of: int | None = None) -> None:
        """Distribute the episodes of one seed from the next reset on: world w does the episodes w, w + W, ...

        Where the worlds are a part of more, `first` is the number of the first one, and `of` the number of all.
        """
        worlds = len(self._places)
        whole_number(seed, "seed")
        self._places = [(seed, first + world, of or worlds) for world in range(worlds)]


class PictureConfig(Closed):
    """How an environment draws its worlds, in pictures and in a window."""

    side: Annotated[int, Field(strict=True, ge=200, le=4000)] = 700
    """Longer side of the world [pixels]."""
    numbers: Flag = True
    """Whether robots have their numbers, where there is room."""


class EnvSettings(TypedDict, total=False):
    """Settings of worlds, their episodes, and what is seen and done, as keyword arguments of batches and borders."""

    family: GivenFamily | None
    """A family of scenarios (its name in `configs/families`, its path, its keys) in place of the mission: its scenarios
    are the episodes."""
    split: Split
    """Split of the family, "train" unless given."""
    size: Size | None
    """Torus of a family that draws from several: its scenarios on that torus."""
    knowledge: Named | None
    """Name or path of the expert knowledge, in place of that of the mission."""
    time_limit: float | None
    """Time after which an episode is truncated, in place of that of the mission [s]: 3,000 s of "table1" are long for a
    learner that does nothing yet."""
    directories: Named | Iterable[Named]
    """The user's configurations, knowledge and robots, searched before the shipped ones."""
    imports: Iterable[Named]
    """Plug-ins, modules or `path/to/file.py`: what they register, missions may then name (docs/own_plugins.md)."""
    trust: bool
    """Whether the files of the mission or the family may ask for code and databases; or not (docs/own_plugins.md)."""
    source: EpisodeSource | None
    """Function from a world to its next scenario, in place of episodes that follow from seeds. All scenarios have the
    frame of the mission or the family (`frames`). A world without a next scenario stays as it is until `reset`, and
    counts no more."""
    reward: GivenReward | None
    """Weights of the reward's terms, a function of a batch that returns the rewards (R,) of a period, or its
    `module:function`."""
    record: RecordSettings | None
    """Where every mission is recorded; none is unless given."""
    explained: bool
    """Whether the robots' networks note why each behaviour runs or does not; recorded minds always do."""
    observation: ObservationConfig | Mapping[str, Any] | None
    """Terms of the observation; the default ones, and those of the mission, unless given."""
    action: ActionConfig | Mapping[str, Any] | None
    """What an action is: an option unless given."""
    picture: PictureConfig | Mapping[str, Any] | None
    """Size of pictures and windows, and whether robots have numbers in them."""


def episodes_of(mission: GivenMission | None = None, settings: EnvSettings | None = None) -> Episodes:
    """Return the episodes of a mission, "table1" unless given, or of the family that the settings name.

    A name may also be that of a family or of an experiment: `load_named`.
    """
    chosen = settings or {}
    import_named(chosen.get("imports", ()))
    if chosen.get("trust"):
        with reading_files(trust=True):
            return episodes_of(mission, {**chosen, "trust": False})
    family, directories = chosen.get("family"), directories_from(chosen.get("directories"))
    if family is not None and mission is not None:
        raise ValueError("family: expected a mission or a family, got both")
    source: Any = family if family is not None else "table1" if mission is None else mission
    if family is None and isinstance(source, str | os.PathLike):
        source = load_named(os.fspath(source), directories)
    if family is not None or isinstance(source, FamilyConfig):
        drawn, size = family_from(source, directories), chosen.get("size")
        known = drawn.model_copy(update={"mission": _changed(drawn.mission, chosen, directories)})
        return Episodes(known, chosen.get("split", "train"), None if size is None else (size[0], size[1]))
    for name in ("split", "size"):
        if chosen.get(name) is not None:
            raise ValueError(f"{name}: expected with a family only, got {chosen.get(name)!r}")
    return Episodes(_changed(mission_from(source, directories), chosen, directories))


def _changed(mission: MissionConfig, chosen: EnvSettings, directories: tuple[Path, ...]) -> MissionConfig:
    """Return the mission with the knowledge and the time limit that were chosen in place of its own."""
    knowledge, limit = chosen.get("knowledge"), chosen.get("time_limit")
    if knowledge is None and limit is None:
        return mission
    known = knowing(mission, None if knowledge is None else os.fspath(knowledge), directories)
    return checked(known.model_copy(update={"time_limit": mission.time_limit if limit is None else limit}), "mission")
