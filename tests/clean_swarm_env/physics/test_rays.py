"""Rays: the term and the sensor read what a scalar reference says, on every ground, alone and in a batch."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.tasks.cleaning.garbage import LYING
from selforg.components import Lidar
from tests.clean_swarm_env.courses import begun, mission, moved

WALLS = ([[2.0, 3.0], [7.0, 3.5], [7.0, 8.0]], [[9.9, 0.4], [9.9, 5.0]], [[1.0, 10.0], [4.0, 10.5]])
GROUNDS = {
    "torus": {},
    "torus with walls": {"walls": [{"corners": corners} for corners in WALLS]},
    "walled": {"ground": "walled", "walls": [{"corners": corners} for corners in WALLS]},
    "small torus": {"width": 5.0, "height": 4.0},
    "crowd": {"width": 20.0, "height": 20.0},
}
SETTINGS = {"name": "lidar", "rays": 12, "farthest": 4.5, "things": 0.2}


def mission_on(name, **further):
    robots = {"count": 60 if name == "crowd" else 8, "capacity": 63 if name == "crowd" else 9}
    stations = {"recycling": [1.5, 2.0], "dump": [3.5, 1.5]}
    return mission(world=GROUNDS[name], robots=robots, stations=stations, garbage={"count": 5}, **further)


def batch_on(name, worlds=2, terms=(SETTINGS,), **further):
    return Batch(mission_on(name, **further), worlds, observation=ObservationConfig(terms=terms))


def to_disc(x, y, angle, place, radius):
    """Return how far it is along a ray to a disc, infinity past it."""
    dx, dy = place[0] - x, place[1] - y
    if math.hypot(dx, dy) <= radius:
        return 0.0
    along, beside = dx * math.cos(angle) + dy * math.sin(angle), dy * math.cos(angle) - dx * math.sin(angle)
    return along - math.sqrt(radius**2 - beside**2) if along > 0.0 and abs(beside) <= radius else math.inf


def to_wall(x, y, angle, wall):
    """Return how far it is along a ray to a segment, infinity past it."""
    way = np.array([math.cos(angle), math.sin(angle)])
    start, end = np.array(wall[:2]), np.array(wall[2:])
    try:
        length, share = np.linalg.solve(np.array([way, start - end]).T, start - (x, y))
    except np.linalg.LinAlgError:
        return math.inf
    return length if length >= 0.0 and 0.0 <= share <= 1.0 else math.inf


def expected(worlds, row, angles, farthest, things):
    """Return the lengths of the rays of a row, one after the other."""
    world, physics, site = row // worlds.robots, worlds.physics, worlds.task
    closed = worlds.mission.world.ground == "torus"
    images = [(i, j) for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2)] if closed else [(0, 0)]
    discs = [(physics.positions[k], 0.25, k == row) for k in worlds.rows_of(world) if physics.present[k]]
    lying = site.garbage.positions[world][site.garbage.stage[world] == LYING]
    if things:
        discs += [(place, things, False) for place in (*lying, *site.stations[world])]
    around = [[0, 0, 11, 0], [11, 0, 11, 11], [11, 11, 0, 11], [0, 11, 0, 0]] if not closed else []
    inner = [segment for wall in worlds.mission.world.walls for segment in wall.segments.tolist()]
    (x, y), lengths = physics.positions[row], []
    for angle in physics.headings[row] + np.array(angles):
        found = [farthest]
        for i, j in images:
            shift = np.array([i, j]) * worlds.extent
            found += [to_disc(x, y, angle, p + shift, r) for p, r, own in discs if not (own and (i, j) == (0, 0))]
            found += [to_wall(x, y, angle, np.array(wall) + np.tile(shift, 2)) for wall in inner + around]
        lengths.append(min(found))
    return lengths


@pytest.mark.parametrize("name", GROUNDS)
@pytest.mark.parametrize("things", [0.0, 0.2])
def test_rays_go_as_far_as_a_scalar_reference_says(name, things):
    batch = begun(batch_on(name, terms=({**SETTINGS, "things": things},)), [3, 4])
    seen, worlds, angles = batch.observations, batch.worlds, 2 * np.pi * np.arange(12) / 12
    for _ in range(2):
        for row in range(0, worlds.rows, 7):
            if worlds.physics.present[row]:
                assert_allclose(seen[row], np.array(expected(worlds, row, angles, 4.5, things)) / 4.5, atol=1e-6)
        seen = batch.step(np.zeros(batch.rows, np.int64)).observations
    assert (seen[worlds.physics.present] < 1.0).mean() > 0.02
    assert not seen[~worlds.physics.present].any()


@pytest.mark.parametrize("name", ["torus with walls", "walled", "crowd"])
def test_rays_are_the_same_alone_in_a_batch_and_in_any_order_of_rows(name):
    config, several = mission_on(name), batch_on(name, 3)
    together = several.reset([1, 2, 3]).copy()
    robots = several.worlds.robots
    assert_array_equal(batch_on(name, 1).reset([2]), together[robots : 2 * robots])
    start = random_start(config, 2, 0)
    order = np.random.default_rng(1).permutation(len(start.robots))
    seen = batch_on(name, 1).reset([5], [start]).copy()
    assert_array_equal(batch_on(name, 1).reset([5], [moved(start, order)])[: len(order)], seen[order])


@pytest.mark.parametrize("name", ["torus with walls", "crowd"])
def test_the_sensor_reads_the_nearest_of_the_rays_in_its_sector(name):
    batch = begun(batch_on(name), [3, 4])
    worlds, rows = batch.worlds, np.arange(0, batch.worlds.rows, 5)
    lidar = Lidar(worlds.minds.surroundings, towards=0.5, width=1.0, rays=5, farthest=3.0, things=0.0)
    angles = 0.5 + 1.0 * np.linspace(-0.5, 0.5, 5)
    nearest = [min(expected(worlds, row, angles, 3.0, 0.0)) for row in rows]
    assert_allclose(lidar.read(rows), nearest, atol=1e-9)
    one = Lidar(worlds.minds.surroundings, towards=-2.0, farthest=3.0)
    assert_allclose(one.read(rows), [expected(worlds, row, [-2.0], 3.0, 0.1)[0] for row in rows], atol=1e-9)


@pytest.mark.parametrize("task", ["FormationControl", "ReachGoal"])
def test_rays_meet_the_things_of_other_tasks_with_their_sizes(task):
    batch = begun(Batch(task, 2, observation=ObservationConfig(terms=({"name": "lidar", "farthest": 9.0},))), [1, 2])
    worlds = batch.worlds
    for row in (0, worlds.rows - 1):
        world, (x, y), heading = row // worlds.robots, worlds.physics.positions[row], worlds.physics.headings[row]
        discs = [(p, 0.25) for k, p in enumerate(worlds.physics.positions) if k != row and k // worlds.robots == world]
        for thing in worlds.task.around:
            sizes = np.maximum(np.broadcast_to(thing.goal_radius, thing.count), 0.1)
            discs += list(zip(thing.places[world], sizes, strict=True))
        for k in range(16):
            images = [np.array([i, j]) * worlds.extent for i in (-1, 0, 1) for j in (-1, 0, 1)]
            met = [to_disc(x, y, heading + k * np.pi / 8, p + shift, r) for p, r in discs for shift in images]
            assert batch.observations[row, k] == pytest.approx(min(9.0, *met) / 9.0, abs=1e-6)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"rays": 0}, "terms: lidar: rays: expected a whole number from 1 to 360, got 0"),
        ({"rays": 2.5}, "terms: lidar: rays: expected a whole number from 1 to 360, got 2.5"),
        ({"rays": 1e9}, "got 1e"),
        ({"farthest": 0.0}, "expected farthest above 0 and things from 0 to 100 m, got 0 and 0.1"),
        ({"things": -1.0}, "got 4 and -1"),
    ],
)
def test_impossible_rays_are_one_line(settings, message):
    with pytest.raises(ValueError, match="terms: lidar: ") as error:
        Batch(mission(), observation=ObservationConfig(terms=({"name": "lidar", **settings},)))
    assert message in str(error.value)
    assert "\n" not in str(error.value)
