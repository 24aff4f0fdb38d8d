"""Teams that change: robots taken away leave nothing, distant robots are not affected, and cargo is not lost."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, LYING, NOTHING
from selforg.gradients.queries import Filter, Queries
from tests.clean_swarm_env.courses import (
    begun,
    course,
    difference,
    long_course,
    mission,
    ticked,
    worlds_at_start,
)
from tests.clean_swarm_env.physics.substeps import count, substep

CHANGING = {
    "events": [
        {"at": 8.0, "do": "fail", "robots": [1]},
        {"at": 12.0, "do": "join", "robots": 2, "places": [[5.5, 9.0, 0.0]]},
        {"at": 20.0, "do": "remove", "robots": [0, 5]},
        {"at": 25.0, "do": "land", "items": 3},
        {"at": 30.0, "do": "move_stations", "recycling": [1.0, 1.0], "dump": [6.0, 1.0]},
        {"at": 35.0, "do": "respawn", "rate": 20.0},
        {"at": 50.0, "do": "respawn", "rate": 0.0},
    ]
}


def _far_apart(robots):
    """A start of robots on a large torus: three that meet in one corner, the others far away, nothing to carry."""
    return StartConfiguration(id="apart", robots=robots, items=())


def _without_last(steps):
    rows = {"samples", "events", "stage"}
    cut = []
    for step in steps:
        part = {name: value if name in rows else value[..., :-1, :] if value.ndim > 1 else value[:-1]
                for name, value in step.items() if name != "values"}  # fmt: skip
        cut.append(part | {"values": step["values"][:-1]})
    return cut


@pytest.mark.parametrize("way", ["remove", "fail"])
@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
@pytest.mark.parametrize("tick", [0, 33])
def test_a_robot_out_of_reach_that_goes_changes_nothing_for_the_others(way, contacts, tick):
    cluster = ((10.0, 10.0, 0.9), (10.5, 10.0, 2.1), (10.25, 10.44, -1.6), (10.75, 10.44, -2.9))
    robots = (*cluster, (40.0, 40.0, 0.3))
    config = mission(world={"width": 60.0, "height": 60.0, "contacts": contacts}, garbage={"count": 0})
    courses = []
    for goes in (False, True):
        worlds = begun(worlds_at_start(config, [3], 0), 0, _far_apart(robots), 3)
        steps = course(worlds, 0, tick)
        if goes:
            getattr(worlds.team, way)(np.array([4]))
        courses.append(_without_last(steps + course(worlds, 0, 100 - tick)))
    assert worlds.collisions.samples[0, 0] > 0  # they did meet
    # how many pheromones a world holds decides in which order those near a robot are summed: the last bit may differ
    assert difference(*courses, within=1e-12) == ""


@pytest.mark.parametrize("name", ["table1", "reference"])
def test_rows_that_are_absent_change_nothing(name):
    plain = course(worlds_at_start(mission(name), [5]), 0, 300)
    roomy = course(worlds_at_start(mission(name, robots={"capacity": 9}), [5]), 0, 300)
    for name in (
        "positions", "headings", "cargo", "samples", "events", "stage", "readings", "executing",
    ):  # fmt: skip
        rows = slice(None) if name in {"samples", "events", "stage"} else slice(5)
        assert all(a[name].tobytes() == b[name][rows].tobytes() for a, b in zip(plain, roomy, strict=True)), name


def _poses_seen(worlds, row):
    everything = Filter(static=False, view_distance=np.inf)
    return len(Queries(worlds.minds.buffers["gradients"]).gradients(row, worlds.now, everything))


def test_a_robot_taken_away_is_nowhere():
    worlds = worlds_at_start(mission(), [1])
    course(worlds, 0, 3)
    place = worlds.physics.positions[2].copy()
    worlds.team.remove(np.array([2]))
    worlds.tick()
    assert [_poses_seen(worlds, row) for row in (0, 1, 3, 4)] == [3] * 4
    for _ in range(20):
        worlds.physics.positions[:2] = np.add(place, [[0.0, 0.01], [0.1, 3.0]])  # drive through where it was
        count(worlds.collisions, worlds.physics.positions, worlds.physics.present)
        assert not worlds.collisions.in_contact[2]
        worlds.tick()
    assert (worlds.physics.positions[2] == place).all()
    assert not worlds.network.executing[2].any()
    assert worlds.team.working.tolist() == [True, True, False, True, True]


@pytest.mark.parametrize(("pose", "seen"), [("seen", 4), ("unseen", 3)])
def test_a_failed_robot_is_an_obstacle(pose, seen):
    config = mission(robots={"count": 5, "failed_pose": pose}, garbage={"count": 0})
    worlds = worlds_at_start(config, [1])
    worlds.team.fail(np.array([2]))
    worlds.tick()
    assert [_poses_seen(worlds, row) for row in (0, 1, 3, 4)] == [seen] * 4
    ticked(worlds, 100)
    assert worlds.physics.present.all()
    assert not worlds.network.executing[2].any()
    worlds.physics.positions[0] = worlds.physics.positions[2] + [0.45, 0.0]
    count(worlds.collisions, worlds.physics.positions, worlds.physics.present)
    assert worlds.collisions.in_contact[2]


def test_robots_cannot_drive_through_a_failed_one_but_through_where_one_was_taken_away():
    start = StartConfiguration(id="two", robots=((3.0, 5.0, 0.0), (6.0, 5.0, 0.0)), items=())
    gaps = {}
    for way in ("fail", "remove"):
        worlds = begun(worlds_at_start(mission(robots={"count": 2}, garbage={"count": 0}), [1]), 0, start, 1)
        getattr(worlds.team, way)(np.array([1]))
        for _ in range(60):
            substep(worlds.physics, np.array([1.0, 0.0]), np.zeros(2))
        gaps[way] = worlds.physics.positions[1, 0] - worlds.physics.positions[0, 0]
    assert gaps["fail"] == pytest.approx(0.5, abs=0.05)
    assert gaps["remove"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("way", ["remove", "fail"])
@pytest.mark.parametrize("recycled", [0, 1])
def test_cargo_lies_where_its_robot_is_lost_and_is_picked_up_as_it_was(way, recycled):
    worlds = worlds_at_start(mission(), [1])
    while not (worlds.task.garbage.cargo != NOTHING).any() or worlds.task.garbage.recycled.max() < recycled:
        worlds.tick()
    row = int(np.flatnonzero((worlds.task.garbage.cargo != NOTHING) & (worlds.task.garbage.recycled == recycled))[0])
    item, place = int(worlds.task.garbage.cargo[row]), worlds.physics.positions[row].copy()
    lying = worlds.minds.buffers["items"].count(0, "garbage")
    getattr(worlds.team, way)(np.array([row]))
    assert worlds.task.garbage.stage[0, item] == LYING
    assert (worlds.task.garbage.positions[0, item] == place).all()
    assert worlds.minds.buffers["items"].count(0, "garbage") == lying + 1
    assert (worlds.task.garbage.cargo[row], worlds.task.garbage.recycled[row]) == (NOTHING, 0)
    for _ in range(3000):
        worlds.tick()
        if worlds.task.garbage.stage[0, item] == CARRIED:
            break
    assert worlds.task.garbage.stage[0, item] == CARRIED
    carrier = int(np.flatnonzero(worlds.task.garbage.cargo == item)[0])
    assert worlds.task.garbage.recycled[carrier] == recycled


@long_course
def test_a_robot_that_joins_works_like_the_others():
    config = mission(robots={"count": 1}, events=[{"at": 5.0, "do": "join", "places": [[1.0, 2.0, 0.5]]}])
    worlds = worlds_at_start(config, [3])
    for _ in range(25):
        worlds.tick()
        assert not worlds.physics.present[1]
    worlds.tick()
    assert worlds.team.working.all()
    assert np.hypot(*(worlds.physics.positions[1] - [1.0, 2.0])) <= 0.2 + 1e-9
    dumped = 0
    for _ in range(800):
        before = worlds.task.garbage.cargo[1]
        worlds.tick()
        dumped += before != NOTHING and worlds.task.garbage.cargo[1] == NOTHING
    assert 0 < dumped < 10


def test_a_robot_joins_and_goes_only_where_and_when_there_is_room():
    worlds = worlds_at_start(mission(robots={"count": 2, "capacity": 3}, garbage={"count": 0}), [3])
    (x, y), team, free = worlds.physics.positions[0], worlds.team, (1.0, -1.0)
    for make, message in (
        (lambda: team.add(0, (x + 0.3, y, 0.0)), "another robot is at the place"),
        (lambda: [team.add(0, (x + away, y, 0.0)) for away in free], "at most 3 robots over the mission"),
        (lambda: team.fail(np.array([3])), "unknown robot at work '3' \\(known: 0, 1, 2\\)"),
        (lambda: [team.fail(np.array([1])), team.remove(np.array([1]))], "unknown robot at work '1'"),
    ):
        with pytest.raises(ValueError, match=message):
            make()
    assert team.working.tolist() == [True, False, True]


def test_robots_join_at_random_places_without_touching_anybody():
    config = mission(robots={"count": 1}, events=[{"at": 0.0, "do": "join", "robots": 30}])
    worlds = worlds_at_start(config, [3, 4])
    worlds.agendas.apply_due()
    for world in range(2):
        places = worlds.physics.positions[worlds.rows_of(world)]
        offsets = np.abs(places[:, None] - places[None])
        distances = np.hypot(*np.minimum(offsets, worlds.extent - offsets).T) + 9.0 * np.eye(31)
        assert distances.min() > 0.5
    assert not np.allclose(worlds.physics.positions[:31], worlds.physics.positions[31:])


def test_garbage_comes_about_spots_wherever_these_move():
    garbage = {"count": 6, "respawn": 120.0, "capacity": 300, "spots": [[3.0, 3.0]], "spot_radius": 0.5}
    events = [
        {"at": 20.0, "do": "move_spots", "spots": [[8.0, 3.0], [8.0, 8.0]]},
        {"at": 40.0, "do": "move_spots", "spots": []},
        {"at": 45.0, "do": "land", "items": 30},
        {"at": 50.0, "do": "move_spots", "spots": [[3.0, 8.0]]},
        {"at": 50.0, "do": "land", "items": 9},
    ]
    worlds = worlds_at_start(mission(garbage=garbage, events=events), [2], 1)
    worlds.drive(np.zeros((worlds.rows, 2)))  # robots stand where they are
    came = []
    for _ in range(300):
        worlds.tick()
        came.append(int(worlds.task.garbage.arrived[0]))
    places = worlds.task.garbage.positions[0, : came[-1]]

    def near(first, last, *spots):
        own = places[first:last]
        assert len(own) > 5
        return np.hypot(*(own[:, None] - np.array(spots)).transpose(2, 0, 1)).min(axis=1).max() <= 0.5

    lying = worlds.task.garbage.stage[0, : came[-1]] == LYING
    assert lying.sum() > 0.9 * len(lying)
    assert near(0, came[99], (3.0, 3.0))
    assert near(came[100], came[199], (8.0, 3.0), (8.0, 8.0))
    assert np.ptp(places[came[201] : came[248]], axis=0).min() > 6.0
    assert near(came[249] + 1, came[-1], (3.0, 8.0))
