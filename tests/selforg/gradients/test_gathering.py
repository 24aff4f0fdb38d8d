"""What rows see, against the definition: distance <= reach + view distance, looked up in all gradients."""

import numpy as np
import pytest

from selforg.components.sources import GoalSource
from selforg.gradients.queries import ATTRACTIVE, Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.columns import PAIR_DISTANCE, PAIR_DX, PAIR_SLOT
from selforg.gradients.store.gathering import IN_CACHE
from selforg.space import Torus
from tests.selforg.gradients.objects import neighbours
from tests.selforg.worlds import make_world, scatter

SETTINGS = BufferSettings(aggregation_distance=0.0, aggregation={"DEFAULT": "max"})


def distances(world, origin, positions):
    offsets = world.space.offsets(origin, positions)
    return np.sqrt((offsets**2).sum(axis=-1))


def assert_sees_what_is_near(world, positions, reach, view):
    seen = Queries(world.buffer).gather(0.0, None, Filter(view_distance=view, moving=False))
    for row in range(world.poses.rows):
        mine = seen.pairs[seen.start[row] : seen.start[row + 1]]
        expected = distances(world, world.poses.positions[row], positions)
        np.testing.assert_allclose(np.sort(mine[:, PAIR_DISTANCE]), np.sort(expected[expected <= reach + view]))
        assert len(set(mine[:, PAIR_SLOT])) == len(mine)


@pytest.mark.parametrize("space", ["torus", "plane", "volume"])
@pytest.mark.parametrize("view", [0.0, 0.7, 3.0, np.inf])
def test_a_row_sees_exactly_what_is_within_reach_plus_view(space, view):
    world = make_world(space, rows=4, settings=SETTINGS)
    reach = world.rng.choice([0.1, 0.6, 1.0, 2.5, 30.0, 5000.0, np.inf], 300)
    positions = scatter(world, 300, diffusion=reach, size=30.0 if space != "torus" else 7.0)
    assert_sees_what_is_near(world, positions, reach, view)


@pytest.mark.parametrize("view", [0.7, np.inf])
def test_many_gradients_are_looked_at_in_portions_and_asked_for_ahead(view):
    world = make_world(rows=3, settings=SETTINGS)
    assert_sees_what_is_near(world, scatter(world, 2 * IN_CACHE, diffusion=0.4, size=7.0), 0.4, view)


def test_offsets_point_to_the_gradient_the_short_way():
    world = make_world(Torus(10.0, 10.0), rows=1, settings=SETTINGS)
    world.poses.update(np.array([[9.5, 0.5]]), None, 1.0)
    world.buffer.store_static(0, "f", [[0.5, 9.5]], 1.0)
    pair = Queries(world.buffer).gather(1.0).pairs[0]
    np.testing.assert_allclose(pair[PAIR_DX : PAIR_DX + 3], [1.0, -1.0, 0.0])


@pytest.mark.parametrize("rows", [5, 33, 200])
def test_crowds_in_cells_see_the_same_as_small_teams(rows):
    world = make_world(Torus(20.0, 30.0), rows=rows, size=20.0)
    seen = Queries(world.buffer).gather(0.0, None, Filter(view_distance=1.0))
    for row in range(rows):
        expected = distances(world, world.poses.positions[row], world.poses.positions)
        expected = np.delete(expected, row)
        mine = seen.pairs[seen.start[row] : seen.start[row + 1], PAIR_DISTANCE]
        np.testing.assert_allclose(np.sort(mine), np.sort(expected[expected <= 2.5]))


def test_teams_do_not_see_each_other():
    world = make_world(rows=4, teams=[0, 1, 0, 1], settings=SETTINGS)
    scatter(world, 20, team=1, diffusion=100.0)
    queries = Queries(world.buffer)
    assert len(queries.gradients(0, 0.0)) == len(neighbours(world.buffer, 0.0)) <= 1
    assert len(queries.gradients(1, 0.0)) >= 20


def test_channels_and_signs_filter():
    world = make_world(rows=1, settings=SETTINGS)
    scatter(world, 3, channel="a", diffusion=50.0, attraction=1)
    scatter(world, 4, channel="b", diffusion=50.0, attraction=-1)
    queries = Queries(world.buffer)
    assert len(queries.gradients(0, 0.0, Filter(("a",)))) == 3
    assert len(queries.gradients(0, 0.0, signs=ATTRACTIVE)) == 3
    assert len(queries.gradients(0, 0.0)) == 7
    assert queries.gradients(0, 0.0, Filter(("never heard of",))) == []


def test_a_row_without_a_pose_sees_nothing_unless_it_asks_for_everything():
    world = make_world(rows=2, settings=SETTINGS)
    scatter(world, 3, diffusion=50.0)
    world.poses.forget([1])
    queries = Queries(world.buffer)
    assert queries.gradients(1, 0.0) == []
    assert len(queries.gradients(1, 0.0, Filter(view_distance=np.inf, moving=False))) == 3
    target = GoalSource(world.buffer)
    target.ask(0.0, np.arange(2))
    assert not target.present[1]


def test_neighbours_leave_with_their_pose():
    world = make_world(rows=3, size=1.0)
    assert len(neighbours(world.buffer, 0.0)) == 2
    world.poses.forget([2])
    assert len(neighbours(world.buffer, 0.0)) == 1
