"""Every task as an environment passes the checks of the cleaning environment, at every border and with all actions."""

import gymnasium
import numpy as np
import pettingzoo
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, parallel_api_test

import clean_swarm_env.registration  # noqa: F401  (the ids of the environments)
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.tasks import TASKS, Measure, Task, TaskSettings, TaskState
from clean_swarm_env.testing import check_task
from clean_swarm_env.wrappers import AllRobots, MaskedObservations
from tests.clean_swarm_env.courses import begun, long_course

MODES = ("option", "velocity", "both")
SECONDS = 4.0
OTHERS = tuple(name for name in TASKS.names() if name != "Cleaning")
KINDS = ("Foraging", "CollisionAvoidance", "FormationControl", "MaxValue")
"""Facts, an errand, holonomic drives, decisions: the other tasks are long tests."""
every_task = pytest.mark.parametrize(
    "task", [pytest.param(task, marks=[] if task in KINDS else pytest.mark.long) for task in OTHERS]
)
every_mode = pytest.mark.parametrize("mode", MODES)


def mission_of(task, seconds=SECONDS):
    return {"task": task, "time_limit": seconds}


def environment(task, mode="option", seconds=SECONDS, **settings):
    return clean_swarm_v0.parallel_env(mission_of(task, seconds), action={"mode": mode}, **settings)


def sampled(env):
    return {agent: env.action_space(agent).sample() for agent in env.agents}


LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""


@pytest.mark.parametrize("task", TASKS.names())
def test_a_task_keeps_its_contract(task):
    check_task(TASKS.find(task))


class Waiting(Task[TaskSettings, TaskState]):
    """Robots wait; the measure is the time."""

    measures = (Measure("waited", "s", "higher", 2.0, "half of the time"),)
    goal = "CollectiveExploration"

    def result(self):
        return {"waited": self.world.ticks * 0.2}


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"result": lambda self: {}}, "result: expected the measure 'waited'"),
        ({"result": lambda self: {"waited": np.full(self.world.worlds, np.nan)}}, "result: waited: expected finite"),
        ({"result": lambda self: {"waited": np.zeros(9)}}, "result: waited: expected"),
        ({"result": lambda self: {"waited": self.world.ticks.sum() + 0.0 * self.world.ticks}}, "same bits alone"),
        ({"reward": lambda self: LUCK.random(self.world.rows)}, "AssertionError|same bits"),
        ({"after_moving": lambda self: self.nothing}, "AttributeError: 'Mine' object has no attribute 'nothing'"),
        ({"things": lambda self: 7}, "TypeError"),
    ],
)  # fmt: skip
def test_a_task_that_breaks_its_contract_is_one_line(members, said, monkeypatch):
    monkeypatch.setitem(TASKS._classes, "Mine", type("Mine", (Waiting,), {**members, "__module__": __name__}))
    with pytest.raises(ValueError, match=said) as raised:
        check_task(TASKS.find("Mine"))
    assert "\n" not in str(raised.value)


@pytest.mark.filterwarnings("ignore::UserWarning")  # remarks on observations, such as not being normalised pictures
@every_task
def test_the_turn_based_environment_passes_pettingzoos_test(task):
    api_test(clean_swarm_v0.env(mission_of(task)), num_cycles=20)


@pytest.mark.filterwarnings("ignore::UserWarning")
@every_task
def test_gymnasiums_check_passes(task):
    check_env(gymnasium.make("CleanSwarm-v0", mission=mission_of(task)).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("task", ["Cleaning", *KINDS])
def test_the_time_limit_and_max_cycles_truncate(task):
    for settings, steps in (({}, 4), ({"max_cycles": 2}, 2), ({"seconds": 2.2}, 3), ({"seconds": 0.2}, 1)):
        env = begun(environment(task, **settings), seed=1)
        for step in range(steps):
            assert env.agents
            _, _, terminations, truncations, infos = env.step(sampled(env))
            assert set(terminations.values()) == {False}
            assert set(truncations.values()) == {step == steps - 1}
        assert env.agents == []
        assert infos["robot_0"]["time_s"] == pytest.approx(min(steps, settings.get("seconds", 9.0)))


@every_mode
def test_all_borders_have_one_course(mode):
    settings = {"mission": mission_of("Foraging"), "action": {"mode": mode}}
    parallel, team = clean_swarm_v0.parallel_env(**settings), CleanSwarmTeam(**settings)
    robots, teams = RobotVectorEnv(1, **settings), TeamVectorEnv(1, **settings)
    first, _ = parallel.reset(seed=4)
    for border in (team, robots, teams):
        assert np.array_equal(border.reset(seed=4)[0].ravel(), np.concatenate(list(first.values())))
    robots.action_space.seed(1)
    for _ in range(4):
        actions = robots.action_space.sample()
        parts = (
            {name: part.reshape(1, -1) for name, part in actions.items()} if mode == "both" else actions.reshape(1, -1)
        )
        alone = {name: part[0] for name, part in parts.items()} if mode == "both" else parts[0]
        each = [{n: p[k] for n, p in actions.items()} if mode == "both" else actions[k] for k in range(12)]
        seen, paid, _, cut, infos = parallel.step(dict(zip(parallel.agents, each, strict=True)))
        one, many, row = team.step(alone), teams.step(parts), robots.step(actions)
        final = row[4].get("final_obs", row[0])
        assert np.array_equal(np.stack(list(final)), np.stack(list(seen.values())))
        assert np.array_equal(one[0], np.concatenate(list(seen.values())))
        assert row[1].tolist() == list(paid.values())
        assert one[1] == many[1][0] == pytest.approx(np.mean(list(paid.values())))
        assert row[3].tolist() == list(cut.values())
        assert one[4].keys() == infos["robot_0"].keys()
        ended = row[4].get("final_info", row[4])
        assert {name: ended[name][0] for name in ("time_s", "items_brought_per_minute", "own_collisions")} == {
            name: infos["robot_0"][name] for name in ("time_s", "items_brought_per_minute", "own_collisions")
        }


def test_ids_take_tasks():
    settings = {"mission": mission_of("CircleFormation", 2.0)}
    vector = begun(
        gymnasium.make_vec("CleanSwarmOneForAll-v0", num_envs=2, action={"mode": "both"}, **settings), seed=1
    )
    assert vector.step(vector.action_space.sample())[1].shape == (2,)
    assert pettingzoo.make("parallel", "CleanSwarm-v0", **settings).options == {"CircleFormation": ("Circle",)}


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_worlds_begin_anew_together(mode):
    envs = begun(RobotVectorEnv(2, mission=mission_of("CircleFormation", 3.0), autoreset_mode=mode), seed=1)
    cut = [envs.step(envs.action_space.sample())[3] for _ in range(8)]
    expected = [2, 5] if mode == "SameStep" else [2, 6]
    assert [step for step, flags in enumerate(cut) if flags.all()] == expected
    assert [step for step, flags in enumerate(cut) if flags.any()] == expected


def test_some_worlds_begin_while_others_go_on():
    """A world begins anew without its neighbour, which goes on as it would alone."""
    envs = RobotVectorEnv(2, mission=mission_of("Foraging", 30.0), autoreset_mode="Disabled")
    alone = RobotVectorEnv(1, mission=mission_of("Foraging", 30.0), autoreset_mode="Disabled")
    envs.reset(seed=[1, 2])
    alone.reset(seed=[1])
    for step in range(8):
        if step == 4:
            envs.reset(seed=[None, 7], options={"reset_mask": np.arange(24) >= 12})
        seen = envs.step(np.zeros(24, dtype=np.int64))[0]
        assert np.array_equal(seen[:12], alone.step(np.zeros(12, dtype=np.int64))[0])
    fresh = begun(RobotVectorEnv(1, mission=mission_of("Foraging", 30.0), autoreset_mode="Disabled"), seed=[7])
    for _ in range(4):
        own = fresh.step(np.zeros(12, dtype=np.int64))[0]
    assert np.array_equal(seen[12:], own)


@long_course
def test_wrappers_take_tasks():
    parallel_api_test(MaskedObservations(AllRobots(environment("Foraging"))), num_cycles=10)
