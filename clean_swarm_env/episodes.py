"""The episodes of a learning border: a mission from random starts, or the scenarios of a family."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from clean_swarm_env.config import MissionConfig, StartConfiguration
from clean_swarm_env.config_files import load_family, load_mission
from clean_swarm_env.families import FamilyConfig, Split
from clean_swarm_env.starts import random_start, run_seed

Episode = tuple[MissionConfig, StartConfiguration, int]
"""A mission, where it starts and the seed of all that follows."""
Episodes = Callable[[int, int], Episode]
"""From the seed of a world and the number of an episode to the episode."""


def episodes_of(
    mission: MissionConfig | str,
    family: FamilyConfig | str | None = None,
    split: Split = "train",
    knowledge: str | None = None,
    directories: tuple[Path, ...] = (),
) -> Episodes:
    """Return the episodes of a mission, or of a family if there is one; see `Batch` for the arguments."""
    if family is None:
        given = load_mission(mission, directories) if isinstance(mission, str) else mission
        return _of_mission(_with_knowledge(given, knowledge))
    drawn = load_family(family, directories) if isinstance(family, str) else family
    return _of_family(drawn.model_copy(update={"mission": _with_knowledge(drawn.mission, knowledge)}), split)


def _of_mission(mission: MissionConfig) -> Episodes:
    def episode(seed: int, number: int) -> Episode:
        return mission, random_start(mission, seed, number), run_seed(seed, f"episode {number}")

    return episode


def _of_family(family: FamilyConfig, split: Split) -> Episodes:
    def episode(seed: int, number: int) -> Episode:
        scenario = family.scenario(seed, number, split)
        return scenario.mission, scenario.start, scenario.seed

    return episode


def _with_knowledge(mission: MissionConfig, knowledge: str | None) -> MissionConfig:
    return mission if knowledge is None else mission.model_copy(update={"knowledge": knowledge})
