"""Walls of a mission file: where robots and items begin, and one line for each mistake."""

import numpy as np
import pytest
from pydantic import ValidationError

from clean_swarm_env.config.free_places import free_ground, robots_that_fit, segments_of
from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import for_start, random_start
from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import one_line
from tests.clean_swarm_env.courses import mission

ROOMS = load_mission("three-rooms")
FIRST_DOOR, SECOND_DOOR = {"corners": [[8.0, 5.0], [8.0, 7.0]]}, {"corners": [[16.0, 5.0], [16.0, 7.0]]}
BOX = [[3.0, 5.0], [5.0, 5.0], [5.0, 7.0], [3.0, 7.0]]


def with_walls(*walls, **world):
    content = ROOMS.model_dump(mode="json")
    own = [*content["world"]["walls"], *walls]
    return with_changes(content, {"world": {"walls": own, **world}})


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (with_walls(FIRST_DOOR), "world.walls: expected a door into every room, wider than a robot of radius 0.25 m"),
        (with_walls(FIRST_DOOR, SECOND_DOOR), "got none into the room about"),
        (with_walls({"corners": [[4.0, 5.0], [4.0, 7.0]]}), "task.stations.recycling: expected a place at least 0.5 m"),
        (with_walls({"corners": BOX, "closed": True}), "task.stations.recycling: expected a place that robots can"),
        (with_walls({"corners": BOX[:2], "closed": True}), "world.walls.4.corners: expected at least three corners"),
        (with_walls({"corners": [[3.0, 5.0], [35.0, 5.0]]}), "world.walls.4.corners.1: expected a point on 24 m x 12"),
        (with_walls({"corners": [[3.0, 5.0]] * 2}), "world.walls.4.corners: expected corners at least 0.001 m from"),
        (with_walls({"from": [3.0, 5.0]}), "world.walls.4.from: unknown key 'from' (known: closed, corners)"),
        (with_walls({"corners": [[3.0, float("nan")], [4.0, 5.0]]}), "world.walls.4.corners.0.1: expected a finite"),
        (
            with_walls(*[{"corners": [[3.0, 5.0], [4.0, 5.0]] * 3}] * 996),
            "world.walls: expected walls of at most 2000 corners together, got 5984",
        ),
        (with_walls(*[{"corners": [[3.0, 5.0], [4.0, 5.0]]}] * 10_000), "world.walls: expected at most 1000 items"),
        ({"robots": [{"model": "a", "count": 0}]}, "robots.groups.0.count: expected greater than or equal to 1"),
        ({"world": {"width": 0.4, "ground": "walled"}}, "world.walls: expected room for robots of radius 0.25 m, got"),
        (
            with_changes(with_walls(), {"robots": {"count": 700}}),
            "robots.count: expected at most 596 solid robots of radius 0.25 m on 24 m x 12 m, got 700",
        ),
        (
            with_changes(with_walls(), {"task": {"garbage": {"spots": [[8.1, 3.0]]}}}),
            "task.garbage.spots.0: expected a place that robots can reach among the walls, got [8.1, 3]",
        ),
        (
            with_changes(with_walls(), {"events": [{"at": 1.0, "do": "join", "places": [[8.1, 3.0, 0.0]]}]}),
            "events.0.places.0: expected a place that robots can reach among the walls, got [8.1, 3]",
        ),
    ],
)
def test_a_mistake_is_one_line(content, words):
    with pytest.raises(ValidationError) as caught:
        MissionConfig.model_validate(content)
    assert words in one_line(caught.value, "rooms.yaml")
    assert "\n" not in one_line(caught.value, "rooms.yaml")


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
