"""The borders while robots leave and join: agents by step."""

import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.learning.actions import ActionConfig
from tests.clean_swarm_env.courses import mission

EVENTS = [
    {"at": 3.0, "do": "fail", "robots": [1]},
    {"at": 5.4, "do": "join", "robots": 2},
    {"at": 8.0, "do": "remove", "robots": [0, 5]},
    {"at": 8.0, "do": "join"},
    {"at": 11.0, "do": "land", "items": 2},
]


def _env(mode="option", **changes):
    config = mission(events=EVENTS, **{"time_limit": 60.0, **changes})
    return clean_swarm_v0.parallel_env(config, action=ActionConfig(mode=mode))


def test_agents_leave_and_join_when_the_mission_says_so_and_it_ends_for_those_that_are_there():
    env = _env(time_limit=14.0)
    assert env.possible_agents == [f"robot_{k}" for k in range(8)]
    env.reset(seed=1)
    there = {0: "01234", 4: "0234", 6: "023456", 9: "23467"}
    for second in range(1, 14):
        agents = "".join(agent[-1] for agent in env.agents)
        latest = max(begin for begin in there if begin < second)
        assert agents == there[latest]
        before = set(env.agents)
        observations, rewards, terminations, truncations, _ = env.step(dict.fromkeys(env.agents, 2))
        gone = before - set(env.agents)
        assert set(observations) == before | set(env.agents)
        assert {agent for agent, ended in terminations.items() if ended} == gone
        assert not any(truncations.values())
        assert all(rewards[agent] == 0.0 for agent in set(env.agents) - before)
    with pytest.raises(ValueError, match=r"unknown \['robot_0'\]"):
        env.step(dict.fromkeys(["robot_0", *env.agents], 2))
    _, _, terminations, truncations, _ = env.step(dict.fromkeys(env.agents, 2))
    assert truncations == dict.fromkeys(["robot_2", "robot_3", "robot_4", "robot_6", "robot_7"], True)
    assert not any(terminations.values())
    env.reset(seed=2)
    assert env.agents == [f"robot_{k}" for k in range(5)]
