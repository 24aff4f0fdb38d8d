"""The borders while robots leave and join: agents by step."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.wrappers import AllRobots
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


CHANGING = mission(events=EVENTS, time_limit=14.0)
FORAGERS = {"task": "Foraging", "robots": {"count": 5, "capacity": 7}, "time_limit": 4.0}


@pytest.mark.parametrize("autoreset", ["SameStep", "NextStep"])
@pytest.mark.parametrize("kind", [CHANGING, FORAGERS], ids=["cleaning", "foraging"])
def test_robots_that_fail_or_are_absent_are_told_alike_at_all_borders(kind, autoreset):
    """They see zeros, are not alive, have no choice and are paid nothing, in the last step of a mission too."""
    every = AllRobots(clean_swarm_v0.parallel_env(kind))
    robots, teams = (made(1, mission=kind, autoreset_mode=autoreset) for made in (RobotVectorEnv, TeamVectorEnv))
    first, infos = every.reset(seed=3)
    told = [(np.stack([*first.values()]), None, infos, robots.reset(seed=[3]), teams.reset(seed=[3]))]
    while every.agents:
        count = len(every.agents)
        seen, paid, _, _, infos = every.step(dict.fromkeys(every.agents, 0))
        steps = robots.step(np.zeros(count, np.int64)), teams.step(np.zeros((1, count), np.int64))
        told.append((np.stack([*seen.values()]), [*paid.values()], infos, *steps))
    before = told[0][3][1]["alive"]
    for number, (seen, paid, infos, (row, *others, about), (team, *_, shared)) in enumerate(told):
        last = number == len(told) - 1 and autoreset == "SameStep"
        row, team = (np.stack([*about["final_obs"]]), shared["final_obs"][0]) if last else (row, team)
        alive = np.array([info["alive"] for info in infos.values()])
        about, shared = (about["final_info"], shared["final_info"]) if last else (about, shared)
        assert alive.tolist() == about["alive"].tolist() == shared["alive"][0].tolist() == seen[:, -1].tolist()
        assert np.array_equal(seen[:, :-1], row)
        assert np.array_equal(row.ravel(), team.ravel())
        assert not row[~alive].any()
        assert row[alive].any(axis=1).all()
        masks = np.stack([info["action_mask"] for info in infos.values()])
        assert masks[~alive].sum(axis=1).tolist() == [1] * (~alive).sum()
        assert last or np.array_equal(masks, about["action_mask"])
        if number:  # PettingZoo has agents that have just joined paid from their first action on
            assert np.where(before, others[0], 0.0).tolist() == paid
            assert not others[0][~alive & ~before].any()
        before = alive
    counts = [int(sum(seen[:, -1])) for seen, *_ in told]
    assert counts[:7] == [5, 5, 5, 5, 4, 4, 6] if kind is CHANGING else set(counts) == {5}
