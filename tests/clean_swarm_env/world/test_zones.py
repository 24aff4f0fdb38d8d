"""Zones: messages from and to robots inside are lost, robots inside are slow; all bits are repeatable."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.world.worlds import Worlds
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c
from tests.clean_swarm_env.courses import (
    avoidance,
    begun,
    course,
    mission,
    ticked,
)

LEFT = {"name": "left", "area": [[0.0, 0.0], [5.0, 11.0]]}
PLACES = ((1.0, 1.0, 0.0), (2.0, 1.0, 0.0), (7.0, 1.0, 0.0), (8.0, 1.0, 0.0))


def placed(loss=0.0, speed=1.0, **changes):
    """Two robots in the left half and two outside, with a zone there."""
    world = {"zones": [{**LEFT, "loss": loss, "speed": speed}]}
    config = mission(world=world, robots={"count": 4}, garbage={"count": 0, "respawn": 1.0}, **changes)
    return begun(Worlds(config, avoidance(), 1), 0, StartConfiguration(id="s", robots=PLACES), 1)


def test_robots_in_a_zone_of_silence_hear_nobody_and_are_heard_by_nobody():
    worlds = ticked(placed(loss=1.0), 4)
    heard = worlds.minds.poses.row_table[:, c.ROW_HEARD : c.ROW_HEARD + 4] >= 0
    assert heard[2, 3]
    assert heard[3, 2]
    assert not heard[:2].any()
    assert not heard[2:, :2].any()


def test_a_share_of_the_messages_of_a_zone_gets_lost():
    worlds, lost = placed(loss=0.7, speed=0.01), []
    worlds.tick()
    for _ in range(200):
        worlds.tick()
        lost.append(worlds.minds.poses.row_table[[0, 1, 2], [c.ROW_HEARD + k for k in (1, 2, 0)]] != 0)
    assert np.mean(lost) == pytest.approx(0.7, abs=0.06)  # within the zone, into it and out of it


def test_pheromones_from_and_to_a_zone_of_silence_reach_only_who_left_them():
    worlds = placed(loss=1.0)
    worlds.tick()
    worlds.tick()
    assert len(worlds.minds.buffers["pheromones"]) == 6  # of two robots outside with both, of each one inside with it


@pytest.mark.parametrize("vector", [(1.0, 0.0), (5.0, 0.0), (0.4, 0.0)])
def test_robots_in_mud_drive_at_a_share_of_their_speed(vector):
    worlds = placed(speed=0.5)
    for _ in range(5):
        worlds.drive(np.tile(vector, (4, 1)))
        worlds.tick()
    gone = worlds.physics.positions[:, 0] - np.array(PLACES)[:, 0]
    speed = min(vector[0], 1.0)
    assert gone == pytest.approx([0.5 * speed, 0.5 * speed, speed, speed], abs=1e-9)


@pytest.mark.parametrize(("max_speed", "mud"), [(1.0, 0.3), (0.3, 1.0)])
def test_slow_robots_that_patrol_leave_a_trail_and_do_not_stay_where_they_are(max_speed, mud):
    zones = [{"name": "mud", "area": [[0.0, 0.0], [11.0, 11.0]], "speed": mud}] if mud < 1.0 else []
    config = mission(world={"zones": zones}, robots={"count": 1, "max_speed": max_speed})
    worlds = Worlds(config, avoidance(), 1)
    far = tuple((0.5 + 0.5 * k, 0.5) for k in range(10))
    worlds.reset(0, StartConfiguration(id="s", robots=((5.5, 5.5, 0.0),), items=far), 1)
    course(worlds, 0, 75)
    trail = Queries(worlds.minds.buffers["pheromones"]).gather(15.0, [0], Filter(view_distance=np.inf)).pairs
    assert len(trail) > 30  # one for each step of 0.06 m; turns on the spot leave none
    assert np.hypot(*(worlds.physics.positions[0] - 5.5)) > 2.0
