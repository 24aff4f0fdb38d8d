"""The robot model is that of the reference experiment, and its sensors read the right values."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import NetworkConfig
from clean_swarm_env.tasks.cleaning.cargo import read_sensors
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, LYING, NOTHING, Garbage
from clean_swarm_env.tasks.cleaning.robot import OWN_SENSORS, robot_network
from selector.documents.errors import DocumentError
from selforg.compiler.records import Packed
from selforg.walls.segments import no_walls
from tests.clean_swarm_env.courses import avoidance
from tests.clean_swarm_env.world.records import floor_record, minds_record

EXTENT = np.array([11.0, 11.0])
STATIONS = np.array([[2.75, 5.5], [8.25, 5.5]])

BEHAVIOURS = {
    "Patrol": ({"garbage_found"}, {"patrolled": 1, "garbage_seen": 1}, 0.8),
    "MoveToGarbage": ({"garbage_seen", "garbage_at", "carrying"}, {"garbage_at": 1}, 0.8),
    "PickGarbage": ({"garbage_at", "carrying"}, {"carrying": 1, "garbage_at": -1}, 0.8),
    "MoveToRecycling": (
        {"carrying", "recycled", "dist_recycling", "at_recycling"}, {"dist_recycling": -1, "at_recycling": 1}, 0.05,
    ),
    "Recycle": ({"carrying", "recycled", "at_recycling"}, {"recycled": 1}, 0.8),
    "MoveToDump": ({"carrying", "recycled", "dist_dump", "at_dump"}, {"dist_dump": -1, "at_dump": 1}, 0.05),
    "Dump": ({"carrying", "recycled", "at_dump"}, {"carrying": -1, "recycled": -1, "garbage_found": -1}, 0.8),
}  # fmt: skip


def _read(robot, items, stage, cargo=NOTHING, recycled=0):
    garbage = Garbage(1, len(items), 1)
    garbage.positions[0], garbage.stage[0] = np.reshape(items, (-1, 2)), stage
    garbage.cargo[0], garbage.recycled[0] = cargo, recycled
    distances = {"sight": 2.0, "at_item": 0.55, "at_station": 0.5, "pick_distance": 0.6}
    floor = floor_record(garbage, np.array([robot], float), EXTENT, stations=STATIONS[None], **distances)
    minds = minds_record(1)
    minds.readings[:] = 9.0
    read_sensors(0.0, np.arange(1), Packed(floor).handle, Packed(minds).handle, no_walls().handle)
    return dict(zip((sensor.name for sensor in OWN_SENSORS), minds.readings[0].tolist(), strict=True))


def test_behaviours_have_the_preconditions_effects_and_thresholds_of_the_reference():
    model = robot_network(NetworkConfig(), [avoidance()]).model
    assert [behaviour.name for behaviour in model.behaviours] == [*BEHAVIOURS, "AvoidCollision"]
    for behaviour in model.behaviours[:-1]:
        sensors, effects, ready = BEHAVIOURS[behaviour.name]
        assert {condition.sensor for condition in behaviour.preconditions} == sensors
        assert {effect.sensor: effect.change for effect in behaviour.effects} == effects
        assert behaviour.ready_threshold == ready
        assert (behaviour.priority, behaviour.interruptable, behaviour.cost) == (0, True, 1.0)
    assert len(model.behaviours[-1].alternatives) == 3
    assert [goal.name for goal in model.goals] == ["PatrolEnvironment", "GarbageCleaned", "AvoidCollision"]
    assert all(goal.permanent for goal in model.goals)


def test_settings_reach_the_network():
    config = NetworkConfig(activation_threshold=5.0, threshold_decay=0.7, activation_decay=0.6, max_parallel=2)
    settings = robot_network(config, [avoidance()]).model.settings
    assert (settings.activation_threshold, settings.threshold_decay) == (5.0, 0.7)
    assert (settings.activation_decay, settings.max_parallel) == (0.6, 2)


@pytest.mark.parametrize(
    ("x", "seen", "at"), [(0.54, 1, 1), (0.56, 1, 0), (1.99, 1, 0), (2.01, 0, 0)], ids=["at", "near", "seen", "out"]
)
def test_an_item_is_seen_and_reached_by_distance_also_across_the_seam(x, seen, at):
    for item in ([5.0 + x, 9.0], [5.0 - x, 9.0]):
        for shift in (0.0, 5.5):
            robot, there = (np.array([[5.0 + shift, 9.0], [item[0] + shift, 9.0]]) % EXTENT).tolist()
            readings = _read(robot, [there], [LYING])
            assert (readings["garbage_seen"], readings["garbage_at"]) == (seen, at)
            assert readings["garbage_found"] == seen
            assert readings["carrying"] == readings["recycled"] == 0.0


def test_a_carried_item_is_found_and_no_longer_seen():
    readings = _read([5.0, 9.0], [[5.0, 9.0]], [CARRIED], cargo=0, recycled=1)
    assert (readings["garbage_seen"], readings["garbage_at"], readings["garbage_found"]) == (0.0, 0.0, 1.0)
    assert (readings["carrying"], readings["recycled"]) == (1.0, 1.0)


def test_stations_by_distance():
    readings = _read([2.75, 5.9], [], [])
    assert readings["dist_recycling"] == pytest.approx(0.4)
    assert readings["dist_dump"] == pytest.approx(np.hypot(5.5, 0.4))
    assert (readings["at_recycling"], readings["at_dump"]) == (1.0, 0.0)
    assert _read([2.75, 6.01], [], [])["at_recycling"] == 0.0
    assert _read([8.25, 5.1], [], [])["at_dump"] == 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("sensors: {weather: fact}", r"own\.yaml: networks: sensors\.weather: expected a sensor .* something feeds"),
        ("behaviours: {Dance: {effects: []}}", r"own\.yaml: networks: behaviours\.Dance: expected a network, .*act"),
        ("behaviours: {Dump: null}", r"own\.yaml: expected the behaviours .*; Dump is missing"),
    ],
)
def test_what_does_not_fit_into_a_document_is_one_line(change, message, tmp_path):
    path = tmp_path / "robots" / "own.yaml"
    path.parent.mkdir()
    path.write_text(f"base: cleaning\nnetworks: {{robot: {{{change}}}}}\n")
    with pytest.raises(DocumentError, match=message) as caught:
        robot_network(NetworkConfig(robot="own"), [avoidance()], [tmp_path])
    assert "\n" not in str(caught.value)
