"""Infos have the same keys with the same values at all borders, in every step; velocity mode shows no options."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.borders.infos import ALIVE, MASK, OPTION_MASK, OWN
from clean_swarm_env.tasks import Cleaning
from tests.clean_swarm_env.courses import mission
from tests.paths import ROOT

SHORT = mission(garbage={"count": 2}, time_limit=20.0)
FORAGING = {"task": "Foraging", "time_limit": 4.0}
TEAM = ("time_s", "dumped", "garbage_done", "mission_collision_events", "completed", "duration_s")
ROBOTS = {f"own_{one.name}": one.about for one in Cleaning.achievements} | OWN
KEYS = {*TEAM, *ROBOTS, ALIVE, MASK}
VELOCITY = {"mode": "velocity"}


def check_infos(told, team, robots):
    """Compare infos by agent with those of a team and of robots as environments."""
    for row, agent in enumerate(told):
        assert told[agent].keys() == team.keys()
        for name, value in told[agent].items():
            if name in (MASK, OPTION_MASK):
                own = slice(row * len(value), (row + 1) * len(value))
                assert value.tolist() == team[name][own].tolist() == robots[name][row].tolist()
            elif name == ALIVE or name.startswith("own_"):
                assert value == team[name][row] == robots[name][row]
            else:
                assert value == team[name] == robots[name][row]


@pytest.mark.parametrize(
    ("kind", "mode"), [(SHORT, "option"), (FORAGING, "option"), (FORAGING, "velocity"), (FORAGING, "both")]
)
def test_all_borders_have_one_course_and_say_the_same_in_every_step(kind, mode):
    settings = {"mission": kind, "action": {"mode": mode}}
    parallel, team = clean_swarm_v0.parallel_env(**settings), CleanSwarmTeam(**settings)
    teams, robots = TeamVectorEnv(1, **settings), RobotVectorEnv(1, **settings, autoreset_mode="NextStep")
    first, infos = parallel.reset(seed=3)
    others = [team.reset(seed=3), *(vector.reset(seed=[3]) for vector in (robots, teams))]
    for seen, _ in others:
        assert np.array_equal(seen.ravel(), np.concatenate(list(first.values())))
    check_infos(infos, others[0][1], others[1][1])
    robots.action_space.seed(1)
    while parallel.agents:
        actions = robots.action_space.sample()
        parts = (
            {name: part.reshape(1, -1) for name, part in actions.items()} if mode == "both" else actions.reshape(1, -1)
        )
        alone = {name: part[0] for name, part in parts.items()} if mode == "both" else parts[0]
        rows = range(len(parallel.agents))
        each = [{n: p[k] for n, p in actions.items()} if mode == "both" else actions[k] for k in rows]
        seen, paid, _, cut, infos = parallel.step(dict(zip(parallel.agents, each, strict=True)))
        one, many, row = team.step(alone), teams.step(parts), robots.step(actions)
        assert np.array_equal(row[0], np.stack(list(seen.values())))
        assert np.array_equal(one[0], np.concatenate(list(seen.values())))
        assert row[1].tolist() == list(paid.values())
        assert one[1] == many[1][0] == pytest.approx(np.mean(list(paid.values())))
        assert row[3].tolist() == list(cut.values())
        assert kind is FORAGING or infos["robot_0"].keys() == KEYS
        check_infos(infos, one[4], row[4])
    assert infos["robot_0"]["duration_s"] == infos["robot_0"]["time_s"]
    assert infos["robot_0"]["completed"] is False


@pytest.mark.parametrize("border", [clean_swarm_v0.parallel_env, CleanSwarmTeam, RobotVectorEnv])
def test_velocity_mode_shows_neither_masks_nor_options(border):
    env = border(mission=SHORT, action=VELOCITY)
    _, infos = env.reset(seed=1)
    names = env.batch.observer.names
    assert not [name for name in names if name.startswith("holds_")]
    assert not {MASK, OPTION_MASK} & infos.get("robot_0", infos).keys()
    with pytest.raises(ValueError, match="terms: 'holds': expected options as actions, got mode 'velocity'"):
        border(mission=SHORT, action=VELOCITY, observation={"terms": ["cargo", "holds"]})


def test_the_keys_stand_in_the_docs():
    page = (ROOT / "docs" / "environment.md").read_text(encoding="utf-8")
    for name, meaning in {**dict.fromkeys(TEAM, ""), **ROBOTS}.items():
        assert f"| `{name}` | {meaning}" in page
