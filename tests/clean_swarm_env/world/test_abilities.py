"""Robots whose models see, carry, hear and hold otherwise than others."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, LYING, NOTHING
from selforg.gradients.queries import Filter, Queries
from tests.clean_swarm_env.courses import begun, mission, worlds_at_start

WIDE = {"width": 20.0, "height": 20.0}
STATIONS = {"recycling": [15.0, 10.0], "dump": [18.0, 10.0]}


def team(*groups, name="table1", items=0, **changes):
    return mission(name, robots=list(groups), world=WIDE, stations=STATIONS, garbage={"count": items}, **changes)


def placed(config, robots, items):
    return begun(worlds_at_start(config, [1]), 0, StartConfiguration(id="placed", robots=robots, items=items), 1)


def test_a_carrier_fetches_what_it_has_room_for_before_it_goes_to_a_station():
    items = ((5.0, 10.0), (5.4, 10.0), (6.0, 10.5), (6.5, 9.5))
    config = team({"model": "carrier", "count": 1, "carries": 3}, items=4, time_limit=200.0)
    worlds = placed(config, ((4.0, 10.0, 0.0),), items)
    garbage, most = worlds.task.garbage, 0
    for _ in range(600):
        worlds.tick()
        load = garbage.load(0)
        most = max(most, len(load))
        assert (garbage.stage[0] == CARRIED).sum() == len(load)
        assert len(np.unique(load)) == len(load)
        if garbage.done[0] and most == 3:
            break
    assert most == 3
    assert garbage.done[0] == 3  # all of the load at once
    assert (garbage.stage[0] == LYING).sum() == 1
    assert garbage.cargo[0] == NOTHING


def test_a_load_that_is_lost_lies_on_the_floor_again():
    config = team({"model": "carrier", "count": 2, "carries": 2}, items=2)
    worlds = placed(config, ((4.0, 10.0, 0.0), (19.0, 19.0, 0.0)), ((5.0, 10.0), (5.3, 10.0)))
    garbage = worlds.task.garbage
    while len(garbage.load(0)) < 2:
        worlds.tick()
    worlds.team.fail(np.array([0]))
    assert (garbage.stage[0] == LYING).all()
    assert np.allclose(garbage.positions[0], worlds.physics.positions[0])


def test_a_robot_that_carries_nothing_finds_one_item_after_the_other_and_tells_of_each():
    scout = {"model": "scout", "count": 1, "carries": 0, "sight": 5.0}
    config = team(scout, {"model": "far", "count": 1}, name="exploring", items=2, consequences={"stop": 0.0})
    batch = Batch(config, worlds=1)
    robots = ((4.0, 10.0, 0.0), (4.0, 0.5, 0.0))
    batch.reset([0], [StartConfiguration(id="placed", robots=robots, items=((8.0, 10.0), (8.3, 10.0)))])
    worlds, known = batch.worlds, set()
    garbage, finds = worlds.task.garbage, Filter(("find",), moving=False, view_distance=np.inf)
    while len(known) < 2:
        worlds.tick()
        assert worlds.ticks[0] < 60
        known |= set(np.flatnonzero(garbage.found[0]).tolist())
    assert (garbage.stage[0] == LYING).all()
    assert (garbage.cargo == NOTHING).all()
    worlds.tick()
    told = Queries(worlds.minds.buffers["pheromones"]).gather(worlds.now, [1], finds, without_pose=True).pairs
    assert len(told) >= 1


def test_the_sight_of_a_model_reaches_as_far_as_it_says():
    config = team({"model": "far", "count": 1, "sight": 4.0}, {"model": "near", "count": 1}, items=1)
    worlds = placed(config, ((4.0, 10.0, 0.0), (4.0, 10.6, 0.0)), ((7.5, 10.0),))
    worlds.tick()
    seen = worlds.network.readings[:, worlds.network.model.sensor_index["garbage_seen"]]
    assert seen.tolist() == [1.0, 0.0]
    batch = Batch(config, worlds=1)
    robots = ((4.0, 10.0, 0.0), (4.0, 10.6, 0.0))
    batch.reset([0], [StartConfiguration(id="placed", robots=robots, items=((7.5, 10.0),))])
    assert batch.observations[:, batch.observer.names.index("garbage_seen")].tolist() == [1.0, 0.0]


def test_messages_of_a_model_reach_as_far_as_it_says():
    groups = {"model": "quiet", "count": 1, "message_range": 2.0}, {"model": "loud", "count": 1}
    config = team(*groups)
    assert config.own_contents
    worlds = placed(config, ((4.0, 10.0, 0.0), (8.0, 10.0, np.pi)), ())
    worlds.tick()
    heard = worlds.minds.poses.row_table[:, -4:-2]  # ages of the last poses heard of robots 0 and 1
    assert heard[0, 1] >= 0  # the quiet one hears the loud one
    assert heard[1, 0] == -1


def test_a_model_holds_its_option_whatever_is_given_and_masks_say_so():
    held = {"AvoidCollision": "RepulsionGradient-view1.5"}
    config = team({"model": "free", "count": 2}, {"model": "bound", "count": 1, "holds": held}, terms=("model",))
    env = clean_swarm_v0.parallel_env(config)
    observations, infos = env.reset(seed=0)
    assert env.agents_by_model == {"free": ["robot_0", "robot_1"], "bound": ["robot_2"]}
    place = env.observation_names.index("model_bound")
    assert [observations[agent][place] for agent in env.agents] == [0.0, 0.0, 1.0]
    assert infos["robot_2"]["action_mask"].tolist() == [0, 0, 1]
    assert infos["robot_0"]["action_mask"].tolist() == [1, 1, 1]
    env.step(dict.fromkeys(env.agents, 0))
    assert env.batch.worlds.coordinators[0].held.tolist() == [0, 0, 2]


def test_an_option_that_nobody_knows_cannot_be_held():
    with pytest.raises(ConfigurationError, match=r"robots\.groups\.0\.holds\.AvoidCollision: unknown option 'Fly'"):
        worlds_at_start(team({"model": "a", "holds": {"AvoidCollision": "Fly"}}), [0])
    with pytest.raises(ConfigurationError, match=r"robots\.holds: unknown coordinated goal 'Fly'"):
        worlds_at_start(mission(robots={"holds": {"Fly": "Fly"}}), [0])
