"""Walls that block messages and pheromones: when they are delivered and when they are read; all bits are repeatable."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.world.worlds import Worlds
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c
from tests.clean_swarm_env.courses import avoidance, begun, mission, ticked

WALL = {"ground": "walled", "walls": [{"corners": [[5.0, 0.0], [5.0, 9.0]]}]}
PLACES = ((1.0, 1.0, 0.0), (2.0, 1.0, 0.0), (7.0, 1.0, 0.0), (8.0, 1.0, 0.0))
SAME_SIDE = np.equal.outer([0, 0, 1, 1], [0, 0, 1, 1])
EVERYTHING = Filter(view_distance=20.0)


def placed(*blocked, ticks=2, places=PLACES, world=WALL, **changes):
    """Two robots on either side of a wall that ends below the upper edge, after some ticks."""
    config = mission(world={**world, "walls_block": blocked}, robots={"count": 4}, garbage={"count": 1}, **changes)
    return ticked(
        begun(Worlds(config, avoidance(), 1), 0, StartConfiguration(id="s", robots=places, items=[[10.0, 10.0]]), 1),
        ticks,
    )


def heard(worlds):
    return worlds.minds.poses.row_table[:, c.ROW_HEARD : c.ROW_HEARD + 4] >= 0


def test_walls_stop_poses_between_robots_on_either_side_and_no_others():
    assert (heard(placed("messages", ticks=1)) | np.eye(4, dtype=bool)).tolist() == SAME_SIDE.tolist()


def test_beyond_the_end_of_the_wall_robots_hear_each_other():
    above = tuple((x, 10.0, angle) for x, _, angle in PLACES)
    assert (heard(placed("messages", ticks=1, places=above)) | np.eye(4, dtype=bool)).all()


def test_a_late_pose_is_stopped_by_a_wall_from_where_it_was_sent():
    late = placed("messages", ticks=3, delivery={"delay": 0.2, "pose_memory": 2.0})
    assert (heard(late) | np.eye(4, dtype=bool)).tolist() == SAME_SIDE.tolist()


def test_walls_that_block_nothing_leave_robots_one_content():
    assert placed().minds.poses.row_table.shape[1] == c.ROW_COLUMNS
    assert placed("pheromones").minds.buffers["pheromones"].shared
    no_wall = placed("messages", "pheromones", world={})
    assert no_wall.minds.buffers["pheromones"].shared


@pytest.mark.parametrize(("blocked", "stored"), [(("messages",), 8), (("pheromones",), 4), ((), 4)])
def test_pheromones_reach_no_robot_behind_a_wall_when_they_are_left_if_messages_are_blocked(blocked, stored):
    assert len(placed(*blocked).minds.buffers["pheromones"]) == stored  # each in two contents, or each in one for all


def seen(worlds, row):
    """Return where the pheromones lie that a row senses, in the order of x."""
    pairs = Queries(worlds.minds.buffers["pheromones"]).gather(worlds.now, [row], EVERYTHING).pairs
    static = pairs[pairs[:, c.PAIR_SLOT] >= 0.0]
    return np.sort(static[:, c.PAIR_DX] + worlds.physics.positions[row, 0])


def test_pheromones_behind_a_wall_are_not_sensed_from_here_and_are_from_beyond_its_end():
    worlds, free = placed("pheromones"), placed()
    places = seen(free, 0)
    assert len(places) == 4
    for row in range(4):
        beside = places[(places < 5.0) == (worlds.physics.positions[row, 0] < 5.0)]
        assert seen(worlds, row).tolist() == pytest.approx(beside.tolist(), abs=0.1)
    worlds.physics.positions[0] = 4.9, 10.5
    worlds.minds.spread_poses(worlds.physics.positions, worlds.physics.headings, worlds.now)
    assert len(seen(worlds, 0)) == 4


def test_one_that_looks_for_any_pheromone_passes_over_those_behind_a_wall():
    worlds = placed("pheromones")
    queries = Queries(worlds.minds.buffers["pheromones"])
    for row, few in ((0, 2), (3, 2)):
        look = Filter(view_distance=20.0, moving=False)
        assert len(queries.gather(worlds.now, [row], look).pairs) == few
