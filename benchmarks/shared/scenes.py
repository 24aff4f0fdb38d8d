"""Missions of the benchmarks: the default one with any number of robots at the default density, in many worlds."""

from math import sqrt
from typing import Any

import numpy as np

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch, mission_begun
from clean_swarm_env.tasks.cleaning.settings import settings_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.coordinator import CoordinatorModel
from selector.knowledge import load_knowledge

SEED = 1


def mission_of(robots: int, items_per_robot: float = 2.0) -> MissionConfig:
    """Return the mission `table1` for `robots` robots, area, items and stations in proportion."""
    mission = load_mission("table1")
    scale = sqrt(robots / mission.robots.count)
    width, height = mission.world.width * scale, mission.world.height * scale
    stations = settings_of(mission).stations
    changes = {
        "world": {"width": width, "height": height},
        "robots": {"count": robots},
        "task": {
            "garbage": {"count": round(items_per_robot * robots)},
            "stations": {
                "recycling": [x * scale for x in stations.recycling],
                "dump": [x * scale for x in stations.dump],
            },
        },
    }
    return MissionConfig.model_validate(with_changes(mission.model_dump(), changes))


def worlds_at_start(mission: MissionConfig, worlds: int) -> Worlds:
    """Return worlds at random starts, robots holding the option of the highest score."""
    knowledge = load_knowledge(mission.knowledge)
    made = Worlds(mission, CoordinatorModel(AVOIDANCE, knowledge, Library()), worlds)
    for world in range(worlds):
        made.reset(world, random_start(mission, SEED, world), run_seed(SEED, str(world)))
    made.hold(np.full(made.rows, best_option(mission)))
    return made


def mission_holding(
    option: str, mission: MissionConfig, start: StartConfiguration, seed: int, **settings: Any
) -> Batch:
    """Return one world at the start of one mission, robots holding an avoidance; settings are those of `Batch`."""
    batch = mission_begun(mission, start, seed, **settings)
    batch.worlds.hold(np.full(batch.rows, batch.options[AVOIDANCE].index(option)))
    return batch


def best_option(mission: MissionConfig) -> int:
    """Return the option of the highest score."""
    return int(np.argmax(load_knowledge(mission.knowledge).scores(AVOIDANCE)))
