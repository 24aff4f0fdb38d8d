"""Observations against a naive account of each robot, and their bounds in crowds and deserts."""

from math import atan2, cos, hypot, sin

import numpy as np
import pytest

from clean_swarm_env.garbage import LYING, NOTHING
from clean_swarm_env.observation import NEIGHBOUR_RANGE, TERMS, Observer
from tests.env.courses import OPTIONS, mission, worlds_at_start


def _offset(worlds, place, other):
    half = worlds.extent / 2
    return (np.asarray(other) - place + half) % worlds.extent - half


def _way(worlds, row, other, scale):
    """Distance by `scale` and the direction in the robot's frame."""
    x, y = _offset(worlds, worlds.physics.positions[row], other)
    angle = atan2(y, x) - worlds.physics.headings[row]
    return [min(hypot(x, y) / scale, 1.0), cos(angle), sin(angle)]


def _nearest(worlds, row, others, within):
    near = [(hypot(*_offset(worlds, worlds.physics.positions[row], o)), k) for k, o in enumerate(others)]
    near = [pair for pair in sorted(near) if pair[0] <= within]
    return len(near), (near[0][1] if near else None)


def _expected(worlds, row):
    world, config, garbage = row // worlds.robots, worlds.mission, worlds.garbage
    diagonal = hypot(config.world.width, config.world.height) / 2
    items = garbage.positions[world][garbage.stage[world] == LYING]
    _, item = _nearest(worlds, row, items, 2.0)
    seen = [0.0, 1.0, 0.0, 0.0] if item is None else [1.0, *_way(worlds, row, items[item], 2.0)]
    cargo = [float(garbage.cargo[row] != NOTHING), float(garbage.recycled[row])]
    stations = _way(worlds, row, config.stations.recycling, diagonal) + _way(
        worlds, row, config.stations.dump, diagonal
    )
    others = np.delete(worlds.physics.positions[worlds.rows_of(world)], row % worlds.robots, axis=0)
    count, other = _nearest(worlds, row, others, NEIGHBOUR_RANGE)
    near = [0.0, 1.0, 0.0, 0.0]
    if other is not None:
        near = [count / (worlds.robots - 1), *_way(worlds, row, others[other], NEIGHBOUR_RANGE)]
    column = worlds.network.model.sensor_index["rep_len"]
    length = min(worlds.network.readings[row, column] / 1.5, 1.0)
    drive = [worlds.drive.speed[row], worlds.drive.turn_rate[row] / 2.0]
    progress = [garbage.done[world] / config.garbage.count, 1.0 - worlds.ticks[world] * 0.2 / config.time_limit]
    held = [float(worlds.coordinator.held[row] == k) for k in range(3)]
    return [*seen, *cargo, *stations, *near, length, *drive, *progress, *held]


@pytest.mark.parametrize("name", ["table1", "reference"])
def test_every_term_is_what_its_name_says(name):
    worlds = worlds_at_start(mission(name), [1, 2])
    worlds.hold(np.arange(10) % 3)
    observer = Observer(worlds)
    seen = np.zeros((10, observer.width), np.float32)
    for tick in range(600):
        worlds.tick()
        if tick % 20 == 0:
            observer.observe(seen)
            for row in range(10):
                np.testing.assert_allclose(seen[row], _expected(worlds, row), atol=1e-6, err_msg=f"{tick} {row}")
    assert observer.names == (*TERMS, *(f"holds_{option}" for option in OPTIONS))
    assert observer.width == len(TERMS) + 3


@pytest.mark.parametrize(
    "changes",
    [
        {"robots": {"count": 60}},
        {"robots": {"count": 1}},
        {"robots": {"count": 1}, "garbage": {"count": 0}},
        {"robots": {"pose_diffusion": 0.0, "pose_goal_radius": 0.0}},
        {"world": {"width": 3.0, "height": 40.0}, "stations": {"recycling": [0.0, 0.0], "dump": [3.0, 40.0]}},
    ],
    ids=["crowd", "alone", "nothing to do", "no reach", "narrow"],
)
def test_observations_stay_within_their_bounds(changes):
    worlds = worlds_at_start(mission(**changes), [1])
    observer = Observer(worlds)
    seen = np.full((worlds.rows, observer.width), np.nan, np.float32)
    for _ in range(200):
        worlds.tick()
        observer.observe(seen)
        assert (np.abs(seen) <= 1.0).all()


def test_looking_changes_nothing():
    worlds = worlds_at_start(mission(), [1])
    observer, seen = Observer(worlds), np.zeros((5, 24), np.float32)
    before = worlds.network.readings.copy(), worlds.physics.positions.copy()
    observer.observe(seen)
    again = seen.copy()
    observer.observe(again)
    assert np.array_equal(seen, again)
    assert np.array_equal(before[0], worlds.network.readings)
    assert np.array_equal(before[1], worlds.physics.positions)
