"""Sources of episodes for worlds: a mission from random starts, or scenarios of a family.

Every episode is a `Scenario`. An episode of a series follows from a seed and its number.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import count
from typing import TypedDict

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.learning.given import (
    GivenFamily,
    GivenMission,
    Named,
    directories_from,
    family_from,
    mission_from,
    whole_number,
)

Size = tuple[float, float]
"""Width and height of a torus [m]."""
EpisodeSource = Callable[[int], Scenario | None]
"""Function from the number of a world to its next scenario, None if there is none left."""
Episodes = Callable[[int, int, int], Iterator[Scenario]]
"""Function from a seed, a first number and a step to the episodes of these numbers, without end."""


class Series:
    """The source of W worlds whose episodes follow from seeds.

    >>> series = Series(episodes_of("table1"), worlds=2)
    >>> series.begin([5, 6])
    >>> [series(0).id, series(0).id, series(1).id]
    ['1', '2', '1']
    >>> series.share(5)
    >>> [series(0).id, series(0).id, series(1).id]
    ['1', '3', '2']

    """

    def __init__(self, episodes: Episodes, worlds: int) -> None:
        self._episodes = episodes
        self._running: list[Iterator[Scenario] | None] = [None] * worlds

    def __call__(self, world: int) -> Scenario:
        """Return the next episode of a world."""
        running = self._running[world]
        assert running is not None
        return next(running)

    def begin(self, seeds: Sequence[int | None]) -> None:
        """Give each world (W,) the episodes 0, 1, ... of its seed.

        A world without a seed (None) continues its episodes, or begins those of a seed drawn from the system.
        """
        for world, seed in enumerate(seeds):
            if seed is not None or self._running[world] is None:
                known = np.random.SeedSequence().entropy if seed is None else seed
                self._running[world] = self._episodes(int(known), 0, 1)  # type: ignore[arg-type]

    def share(self, seed: int) -> None:
        """Distribute the episodes of one seed: world w of W gets the episodes w, w + W, ..."""
        worlds = len(self._running)
        whole_number(seed, "seed")
        self._running = [self._episodes(seed, world, worlds) for world in range(worlds)]


class EpisodeSettings(TypedDict, total=False):
    """The choice of episodes; without settings the mission from random starts."""

    family: GivenFamily | None
    """A family of scenarios (its name in `configs/families`, its path, its keys) in place of the mission: its scenarios
    are the episodes."""
    split: Split
    """Split of the family, "train" unless given."""
    size: Size | None
    """Torus of a family that draws from several: its scenarios on that torus."""
    knowledge: Named | None
    """Name or path of the expert knowledge, in place of that of the mission."""
    directories: Named | Iterable[Named]
    """The user's configurations, knowledge and robots, searched before the shipped ones."""


def episodes_of(mission: GivenMission | None = None, settings: EpisodeSettings | None = None) -> Episodes:
    """Return the episodes of a mission, "table1" unless given, or of the family that the settings name."""
    chosen = settings or {}
    family, directories = chosen.get("family"), directories_from(chosen.get("directories"))
    size, knowledge = chosen.get("size"), chosen.get("knowledge")
    if family is None:
        for name in ("split", "size"):
            if chosen.get(name) is not None:
                raise ValueError(f"{name}: expected with a family only, got {chosen.get(name)!r}")
        return _of_mission(
            _with_knowledge(mission_from("table1" if mission is None else mission, directories), knowledge)
        )
    if mission is not None:
        raise ValueError("family: expected a mission or a family, got both")
    drawn = family_from(family, directories)
    size = None if size is None else (size[0], size[1])
    _check_size(drawn, size)
    known = drawn.model_copy(update={"mission": _with_knowledge(drawn.mission, knowledge)})
    return _of_family(known, chosen.get("split", "train"), size)


def _of_mission(mission: MissionConfig) -> Episodes:
    def episodes(seed: int, first: int, step: int) -> Iterator[Scenario]:
        return map(partial(episode, seed), count(first, step))

    def episode(seed: int, number: int) -> Scenario:
        start = random_start(mission, seed, number)
        return Scenario(start.id, run_seed(seed, f"episode {number}"), mission, start)

    return episodes


def _of_family(family: FamilyConfig, split: Split, size: Size | None) -> Episodes:
    def episodes(seed: int, first: int, step: int) -> Iterator[Scenario]:
        drawn = map(partial(episode, seed), count(first, step))
        return drawn if size is None or not family.sizes else filter(fits, drawn)

    def episode(seed: int, number: int) -> Scenario:
        return family.scenario(seed, number, split)

    def fits(scenario: Scenario) -> bool:
        world = scenario.mission.world
        return (world.width, world.height) == size

    return episodes


def _check_size(family: FamilyConfig, size: Size | None) -> None:
    """Raise ValueError unless `size` is a torus of the family, or the family has one torus only."""
    sizes = family.tori
    if size not in sizes and (size is not None or len(sizes) > 1):
        known = ", ".join(f"{own}" for own in sizes)
        raise ValueError(f"size: expected one of those of family {family.name!r}, {known}, got {size}")


def _with_knowledge(mission: MissionConfig, knowledge: Named | None) -> MissionConfig:
    return mission if knowledge is None else mission.model_copy(update={"knowledge": os.fspath(knowledge)})
