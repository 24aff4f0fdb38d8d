"""Infos have the same keys with the same values at all borders, in every step; velocity mode shows no options."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv
from clean_swarm_env.borders.infos import MASK, OWN
from tests.clean_swarm_env.courses import begun, mission
from tests.paths import ROOT

SHORT = mission(garbage={"count": 2}, time_limit=20.0)
TEAM = ("time_s", "dumped", "garbage_done", "mission_collision_events", "completed", "duration_s")
KEYS = {*TEAM, *OWN, MASK}
VELOCITY = {"mode": "velocity"}


def test_all_borders_say_the_same_in_every_step():
    parallel, team = clean_swarm_v0.parallel_env(SHORT), CleanSwarmTeam(SHORT)
    robots = RobotVectorEnv(1, mission=SHORT, autoreset_mode="NextStep")
    _, infos = parallel.reset(seed=3)
    others = [team.reset(seed=3)[1], robots.reset(seed=3)[1]]
    rng, over = np.random.default_rng(1), False
    while True:
        for row, agent in enumerate(parallel.possible_agents):
            assert infos[agent].keys() == KEYS
            for name in TEAM:
                assert infos[agent][name] == others[0][name] == others[1][name][row]
            for name in OWN:
                assert infos[agent][name] == others[0][name][row] == others[1][name][row]
            assert infos[agent][MASK].tolist() == others[0][MASK][row * 3 : row * 3 + 3].tolist()
            assert infos[agent][MASK].tolist() == others[1][MASK][row].tolist()
        if over:
            break
        options = rng.integers(0, 3, 5)
        *_, infos = parallel.step(dict(zip(parallel.agents, options, strict=True)))
        over = not parallel.agents
        others = [team.step(options)[4], robots.step(options)[4]]
    assert infos["robot_0"]["duration_s"] == 20.0
    assert infos["robot_0"]["completed"] is False


def test_a_world_that_begins_anew_tells_the_end_of_its_mission():
    envs = begun(RobotVectorEnv(1, mission=SHORT), seed=1)
    for _ in range(20):
        *_, infos = envs.step(np.zeros(5, dtype=np.int64))
    (end,) = envs.batch.finished
    assert infos["final_info"]["garbage_done"].tolist() == [end.result.garbage_done] * 5
    assert infos["final_info"]["time_s"].tolist() == [20.0] * 5
    *_, infos = envs.step(np.zeros(5, dtype=np.int64))
    assert infos["time_s"].tolist() == [1.0] * 5


@pytest.mark.parametrize("border", [clean_swarm_v0.parallel_env, CleanSwarmTeam, RobotVectorEnv])
def test_velocity_mode_shows_neither_masks_nor_options(border):
    env = border(mission=SHORT, action=VELOCITY)
    _, infos = env.reset(seed=1)
    names = (env._batch if border is clean_swarm_v0.parallel_env else env.batch).observer.names
    assert not [name for name in names if name.startswith("holds_")]
    assert MASK not in infos.get("robot_0", infos)
    with pytest.raises(ValueError, match="terms: 'holds': expected options as actions, got mode 'velocity'"):
        border(mission=SHORT, action=VELOCITY, observation={"terms": ["cargo", "holds"]})


def test_the_keys_stand_in_the_docs():
    page = (ROOT / "docs" / "environment.md").read_text(encoding="utf-8")
    for name, meaning in {**dict.fromkeys(TEAM, ""), **OWN}.items():
        assert f"| `{name}` | {meaning}" in page
