"""One line for each mistake in a mission: walls, zones, phases, events, consequences, messages and models of robots."""

import pytest
from pydantic import ValidationError

from clean_swarm_env.config.load import with_changes
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import one_line
from tests.clean_swarm_env.config.test_walls import with_walls

FIRST_DOOR, SECOND_DOOR = {"corners": [[8.0, 5.0], [8.0, 7.0]]}, {"corners": [[16.0, 5.0], [16.0, 7.0]]}
BOX = [[3.0, 5.0], [5.0, 5.0], [5.0, 7.0], [3.0, 7.0]]
WALLS = [
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
]


def zone(**changes):
    left = {"name": "left", "area": [[0.0, 0.0], [5.0, 11.0]], "loss": 0.5}
    return {"world": {"zones": [{**left, **changes}]}}


ZONES = [
    (
        zone(area=[[5.0, 0.0], [4.0, 1.0]]),
        "world.zones.0.area: expected a lower left and an upper right corner on",
    ),
    (zone(area=[[5.0, 0.0], [14.0, 1.0]]), "world.zones.0.area: expected a lower left and an upper right corner"),
    (zone(loss=1.5), "world.zones.0.loss: expected less than or equal to 1"),
    (zone(loss=0.0), "world.zones.0.loss: expected a loss above 0, or a speed below 1, got a zone that does nothing"),
    (zone(speed=0.0), "world.zones.0.speed: expected greater than or equal to 0.01"),
    (zone(sped=0.5), "world.zones.0.sped: unknown key 'sped'"),
]


def event(**settings):
    return {"events": [{"at": 3.0, **settings}]}


def one_for_another(way: str, joining: int):
    """Return events by which one of five robots fails or is removed, and others join."""
    return {"events": [{"at": 1.0, "do": way, "robots": [0]}, {"at": 2.0, "do": "join", "robots": joining}]}


EVENTS = [
    (event(every=0.01, do="respawn", rate=1.0), "events: expected at most 100000 times that they happen together, got"),
    (
        {"events": [{"at": 0.0, "every": 1.0, "do": "respawn", "rate": 1.0}] * 40},
        "events: expected at most 100000 times that they happen together, got 120000",
    ),
    (event(every=-1.0, do="respawn", rate=1.0), "every: expected greater than or equal to 0"),
    (event(every=9.0, do="join"), "every: unknown key 'every'"),
    (event(every=9.0, do="land", items=2), "every: unknown key 'every'"),
    (event(do="fail", robots=[5]), "events.0.robots: expected robots at work then (0, 1, 2, 3, 4), got 5"),
    (event(do="remove", robots=[*range(5)]), "events.0.robots: expected a robot that stays at work, got none"),
    (event(do="join", robots=900), "events.0.robots: expected at most 277 solid robots"),
    (
        one_for_another("fail", 273),
        "events.1.robots: expected at most 277 solid robots on 11 m x 11 m, got 278 of them",
    ),
    (one_for_another("remove", 274), "got 278 of them"),
    (event(do="join", places=[[0, 0, 0], [1, 1, 1]]), "expected at most 1, one for each robot, got 2"),
    (event(do="dance"), "'join', 'remove', 'fail'"),
    (event(do="move_spots", spots=[[1.0, 1.0], [2.0, 12.0]]), "events.0.spots.1: expected a point on the torus"),
    (event(do="move_stations", recycling=[1.0, 1.0], dump=[12.0, 1.0]), "events.0.dump: expected a point on"),
]
MODELS = [
    ({"robots": []}, "robots.groups: expected at least one group of robots, got none"),
    (
        {"robots": [{"model": "a", "count": 0}]},
        "robots.groups.0.count: expected greater than or equal to 1, got 0",
    ),
    (
        {"robots": [{"model": "a"}, {"model": "a"}]},
        "robots.groups: expected unique names, got 'a' twice",
    ),
    (
        {"robots": {"max_speed": 2.0, "groups": [{"model": "a"}]}},
        "robots.max_speed: expected it in each group, where there are groups, got 2.0",
    ),
    ({"robots": [{"model": "a", "size": 3}]}, "robots.groups.0.size: unknown key 'size'"),
    ({"robots": [{"model": "a"}, {"model": "b", "radius": 3.0}]}, "robots.count: expected at most"),
    (
        {"robots": [{"model": "a"}], **event(do="join", model="b")},
        "events.0.model: expected a model of the robots (a), got b",
    ),
]
OTHERS = [
    ({"delivery": {"delay": 0.3}}, "whole multiple of the control period 0.2 s, got 0.3"),
    *(
        ({"task": {"consequences": wrong}}, "consequences")
        for wrong in ({"stop": -1.0}, {"stop": 1e9}, {"bounce": 1.0})
    ),
]


def test_a_robot_that_is_removed_leaves_its_room_and_a_failed_one_does_not():
    assert MissionConfig.model_validate(one_for_another("remove", 273)).rows == 278


@pytest.mark.parametrize(("content", "words"), [*WALLS, *ZONES, *EVENTS, *MODELS, *OTHERS])
def test_a_mistake_is_one_line(content, words):
    with pytest.raises(ValidationError) as caught:
        MissionConfig.model_validate(content)
    assert words in one_line(caught.value, "mine.yaml")
    assert "\n" not in one_line(caught.value, "mine.yaml")
