"""Walls of a mission file: where robots and items begin."""

import numpy as np
import pytest

from clean_swarm_env.config.free_places import free_ground, robots_that_fit, segments_of
from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import for_start, random_start
from clean_swarm_env.config.types import ConfigurationError
from tests.clean_swarm_env.courses import mission

ROOMS = load_mission("three-rooms")


def with_walls(*walls, **world):
    content = ROOMS.model_dump(mode="json")
    own = [*content["world"]["walls"], *walls]
    return with_changes(content, {"world": {"walls": own, **world}})


@pytest.mark.parametrize("world", [{}, {"ground": "torus"}])
@pytest.mark.parametrize("spots", [(), ((7.0, 3.0),)])
def test_robots_and_items_begin_where_robots_can_be(world, spots):
    pillar = {"corners": [[11.0, 5.0], [13.0, 5.0], [12.0, 7.0]], "closed": True}
    garbage = {"garbage": {"count": 200, "spots": spots, "spot_radius": 2.0}}
    config = MissionConfig.model_validate(with_changes(with_walls(pillar, **world), {"task": garbage}))
    start = random_start(config, 3, 0)
    free = free_ground(config.world, config.robots.radius)
    places = np.concatenate([np.array(start.robots)[:, :2], np.array(start.items)])
    assert free.has(places).all()
    assert min(map(free.clearance, places)) >= 0.25
    assert for_start(config, start) == config


def test_a_given_start_inside_a_wall_is_refused():
    start = random_start(ROOMS, 3, 0)
    _, y, turn = start.robots[0]
    for change in ({"robots": ((8.1, y, turn), *start.robots[1:])}, {"items": ((23.9, 1.0), *start.items[1:])}):
        with pytest.raises(ConfigurationError, match="expected a place that robots can reach among the walls"):
            for_start(ROOMS, start.model_copy(update=change))


def test_worlds_without_walls_ask_for_no_free_ground():
    free_ground.cache_clear()
    random_start(mission(), 1, 0)
    assert free_ground.cache_info().misses == 0
    assert robots_that_fit(mission().world, 0.25) == 277
    assert len(segments_of(mission().world)) == 0
