"""Wrappers: robots that are always there, and masks inside the observation, in a team that changes."""

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import ALIVE, AllRobots, MaskedObservations
from tests.clean_swarm_env.borders.test_changing_agents import EVENTS
from tests.clean_swarm_env.courses import begun, mission

CHANGING = mission(events=EVENTS, time_limit=20.0)
SERVES = {"serves": {"RepulsionFernandez-view2.0": ["patrol", "approach"]}}


def test_every_robot_is_there_in_every_step_with_a_flag_of_its_life():
    env, plain = AllRobots(clean_swarm_v0.parallel_env(CHANGING)), clean_swarm_v0.parallel_env(CHANGING)
    observations, infos = env.reset(seed=1)
    plain.reset(seed=1)
    for _ in range(20):
        working = set(plain.agents)
        assert env.agents == env.possible_agents == list(observations)
        for agent in env.agents:
            seen = observations[agent]
            assert env.observation_space(agent).contains(seen)
            assert seen[-1] == (agent in working) == infos[agent][ALIVE]
            assert agent in working or not seen.any()
        observations, rewards, terminations, truncations, infos = env.step(dict.fromkeys(env.agents, 2))
        own, paid, *_ = plain.step(dict.fromkeys(plain.agents, 2))
        for agent in env.possible_agents:
            assert rewards[agent] == paid.get(agent, 0.0)
            if agent in plain.agents:
                assert np.array_equal(observations[agent][:-1], own[agent])
        assert not any(terminations.values())
    assert set(truncations.values()) == {True}
    assert env.agents == []


def test_all_terminate_with_the_mission():
    env = begun(
        AllRobots(
            clean_swarm_v0.parallel_env(
                mission(garbage={"count": 1}, events=[{"at": 5.0, "do": "fail", "robots": [0]}])
            )
        ),
        seed=1,
    )
    while env.agents:
        _, _, terminations, truncations, _ = env.step(dict.fromkeys(env.agents, 2))
    assert set(terminations.values()) == {True}
    assert set(truncations.values()) == {False}


@pytest.mark.parametrize("key", ["observation", "observations"])
def test_masks_stand_in_the_observation(key):
    plain = clean_swarm_v0.parallel_env(CHANGING, action=SERVES)
    env = MaskedObservations(AllRobots(clean_swarm_v0.parallel_env(CHANGING, action=SERVES)), key)
    observations, infos = env.reset(seed=1)
    _, expected = plain.reset(seed=1)
    masked = 0
    while env.agents:
        for agent in plain.agents:
            assert observations[agent]["action_mask"].tolist() == expected[agent]["action_mask"].tolist()
        for agent in env.agents:
            assert env.observation_space(agent).contains(observations[agent])
            masked += not observations[agent]["action_mask"].all()
        observations, *_, infos = env.step(dict.fromkeys(env.agents, 2))
        *_, expected = plain.step(dict.fromkeys(plain.agents, 2))
    assert infos["robot_0"].keys() >= {ALIVE, "action_mask"}
    assert masked > 0
    parallel_api_test(env, num_cycles=30)


def test_vectors_have_no_masks():
    with pytest.raises(ValueError, match="expected options as actions, got mode 'velocity'"):
        MaskedObservations(clean_swarm_v0.parallel_env(action={"mode": "velocity"}))
