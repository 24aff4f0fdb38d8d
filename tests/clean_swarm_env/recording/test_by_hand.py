"""What a person does by hand: what it changes in the world, and the line that says why something cannot be done."""

import numpy as np
import pytest

from clean_swarm_env.tasks.cleaning.garbage import ABSENT, CARRIED, LYING
from clean_swarm_env.world.by_hand import by_hand, change_of
from tests.clean_swarm_env.courses import course_of, mission, ticked


@pytest.fixture
def worlds():
    config = mission(
        robots={"count": 3, "capacity": 4}, garbage={"count": 4, "capacity": 5}, delivery={"own_contents": True}
    )
    course = ticked(course_of(config, 3, 17), 10)
    return course.worlds


def made(worlds, **change):
    change_of({"tick": 10, **change}).make(worlds)


def free_place(worlds) -> tuple[float, float]:
    """A place on the grid of metres far from all robots."""
    places = [(x + 0.5, y + 0.5) for x in range(11) for y in range(11)]
    return max(places, key=lambda p: np.hypot(*(worlds.physics.positions[worlds.physics.present] - p).T).min())


def test_a_robot_is_put_elsewhere_and_goes_on_from_there(worlds):
    x, y = free_place(worlds)
    others = worlds.physics.positions[1:].copy()
    made(worlds, do="put_robot", robot=0, x=x + 11.0, y=y)
    assert worlds.physics.positions[0] == pytest.approx((x, y))
    np.testing.assert_array_equal(worlds.physics.positions[1:], others)
    worlds.tick()
    moved = worlds.physics.positions[0] - (x, y)
    assert np.hypot(*moved) <= 0.21
    assert worlds.minds.poses.own[0, 0, :2] == pytest.approx((x, y))


def test_robots_join_fail_and_go(worlds):
    x, y = free_place(worlds)
    made(worlds, do="add_robot", x=x, y=y, heading=1.0)
    assert worlds.team.working.tolist() == [True] * 4
    assert [*worlds.physics.positions[3], worlds.physics.headings[3]] == pytest.approx([x, y, 1.0])
    made(worlds, do="fail_robot", robot=1)
    made(worlds, do="remove_robot", robot=2)
    assert worlds.team.working.tolist() == [True, False, False, True]
    assert worlds.physics.present.tolist() == [True, True, False, True]
    made(worlds, do="remove_robot", robot=1)  # the body of one that has failed
    assert worlds.physics.present.tolist() == [True, False, False, True]
    worlds.tick()


def test_items_come_move_and_go_and_are_seen_where_they_lie(worlds):
    def seen(robot) -> bool:
        worlds.tick()
        return bool(worlds.network.readings[robot, 0])  # garbage_seen

    for item in range(4):
        if worlds.task.garbage.stage[0, item] == LYING:
            made(worlds, do="remove_item", item=item)
    arrived = int(worlds.task.garbage.arrived[0])
    assert not seen(0)
    x, y = worlds.physics.positions[0].tolist()
    made(worlds, do="add_item", x=x + 1.5, y=y)
    item = int(np.flatnonzero(worlds.task.garbage.stage[0] == LYING)[0])
    assert worlds.task.garbage.arrived[0] == arrived + 1
    assert seen(0)
    far = free_place(worlds)
    made(worlds, do="put_item", item=item, x=far[0], y=far[1])
    assert worlds.task.garbage.positions[0, item] == pytest.approx(far)
    assert not seen(0)
    made(worlds, do="remove_item", item=item)
    assert worlds.task.garbage.stage[0, item] == ABSENT
    assert worlds.task.garbage.arrived[0] == arrived


def test_messages_get_lost(worlds):
    made(worlds, do="set_loss", loss=1.0)
    worlds.tick()
    heard = worlds.minds.poses.row_table[0, -4:]  # ages of the last poses that robot 0 received of the others
    assert heard[1] > 0
    assert heard[2] > 0


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"do": "put_robot", "robot": 3, "x": 1.0, "y": 1.0}, "robot 3: expected a robot that is there"),
        ({"do": "put_robot", "robot": 9, "x": 1.0, "y": 1.0}, "robot 9: expected a robot that is there"),
        ({"do": "fail_robot", "robot": 3}, "robot 3: expected a robot that is there"),
        ({"do": "remove_item", "item": 4}, "item 4: expected an item that lies"),
        ({"do": "put_item", "item": 99, "x": 1.0, "y": 1.0}, "item 99: expected an item that lies"),
    ],
)
def test_what_is_not_there_cannot_be_changed(worlds, change, expected):
    with pytest.raises(ValueError, match=expected):
        made(worlds, **change)


def test_what_is_impossible_changes_nothing(worlds):
    (x, y), (free_x, free_y) = worlds.physics.positions[1].tolist(), free_place(worlds)
    room = int((worlds.task.garbage.stage[0] == ABSENT).sum())
    item, own = {"do": "add_item", "x": 1.0, "y": 1.0}, {"do": "add_robot", "x": free_x, "y": free_y}
    failing = [{"do": "fail_robot", "robot": robot} for robot in range(2)]
    for before, change, expected in (
        ([], {"do": "put_robot", "robot": 0, "x": x + 0.2, "y": y}, "robot 0: another robot is at the place"),
        ([], {"do": "add_robot", "x": x + 0.2, "y": y}, "another robot is at the place"),
        ([item] * room, item, "an item more: expected at most 5 lying or carried"),
        (failing, {"do": "fail_robot", "robot": 2}, "robot 2: expected another robot at work, got the last one"),
        ([], {"do": "remove_robot", "robot": 2}, "robot 2: expected another robot at work, got the last one"),
        ([], failing[0], "robot 0: expected a robot at work, got one that has failed"),
        ([own], own | {"y": free_y + 1.0}, "expected at most 4 robots"),
    ):
        for possible in before:
            made(worlds, **possible)
        state = worlds.get_state()
        with pytest.raises(ValueError, match=expected):
            made(worlds, **change)
        assert worlds.get_state() == state


def test_events_of_the_mission_pass_over_robots_that_a_person_took_away():
    events = ({"at": 3.0, "do": "fail", "robots": [0, 1]}, {"at": 4.0, "do": "remove", "robots": [2]})
    config = mission(robots={"count": 4}, events=events)
    course = course_of(config, 3, 17)
    for robot in (0, 2):
        made(course.worlds, do="remove_robot", robot=robot)
    ticked(course, 25)
    assert course.worlds.team.working.tolist() == [False, False, False, True]
    assert course.worlds.physics.present.tolist() == [False, True, False, True]


def test_a_carried_item_is_not_moved_by_hand(worlds):
    while not (worlds.task.garbage.stage[0] == CARRIED).any():
        worlds.tick()
    item = int(np.flatnonzero(worlds.task.garbage.stage[0] == CARRIED)[0])
    with pytest.raises(ValueError, match=f"item {item}: expected an item that lies"):
        made(worlds, do="put_item", item=item, x=1.0, y=1.0)


def test_a_function_that_does_not_say_what_it_changes_is_no_change():
    def vanish(task, robot: int): ...

    with pytest.raises(TypeError, match="vanish: expected a first parameter of the type Worlds or of a task, got task"):
        by_hand(vanish)
