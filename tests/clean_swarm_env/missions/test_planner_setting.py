"""The planner of the robots, by name."""

import pytest

from clean_swarm_env.world.worlds import Worlds
from tests.clean_swarm_env.courses import avoidance, mission, worlds_at_start


def test_robots_without_planner_have_none():
    assert Worlds(mission(network={"planner": "off"}), avoidance()).network.planner is None
    assert Worlds(mission(), avoidance()).network.planner is not None


@pytest.mark.extra
def test_an_engine_plans_for_the_robots():
    pytest.importorskip("up_aries")
    worlds = worlds_at_start(mission(network={"planner": "aries"}), [1])
    worlds.tick()
    assert worlds.network.state.plan_marks[:, 2].any()  # a plan is known
