"""The PettingZoo border: whole trajectories, spaces, the ends of episodes and wrong use."""

import subprocess
import sys

import numpy as np
import pytest
from pettingzoo.test.render_test import render_test
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import ConfigurationError
from tests.clean_swarm_env.courses import begun, long_course, mission


@long_course
def test_an_episode_terminates_when_all_garbage_is_dumped_and_agents_stay_gone():
    env = begun(clean_swarm_v0.parallel_env(), seed=1)
    assert env.agents == env.possible_agents
    total = 0.0
    while env.agents:
        agents = env.agents
        _, rewards, terminations, truncations, infos = env.step(dict.fromkeys(env.agents, 2))
        assert set(rewards) == set(terminations) == set(truncations) == set(infos) == set(agents)
        total += sum(rewards.values()) / len(rewards)
    assert set(terminations.values()) == {True}
    assert set(truncations.values()) == {False}
    last = infos["robot_0"]
    assert total == pytest.approx(-0.01 * (last["time_s"] + 2.0 * last["mission_collision_events"]), abs=1e-9)
    with pytest.raises(RuntimeError, match="call reset first"):
        env.step({})
    assert env.agents == []
    env.reset()
    assert env.agents == env.possible_agents


def test_an_action_is_the_option_held_in_the_next_period():
    env = clean_swarm_v0.parallel_env()
    observations, _ = env.reset(seed=1)
    assert [observations[agent][-3:].tolist() for agent in env.agents] == [[1, 0, 0]] * 5  # the highest score
    observations, *_ = env.step({"robot_0": 0, "robot_1": 1, "robot_2": 2, "robot_3": 2, "robot_4": 0})
    assert [int(observations[agent][-3:].argmax()) for agent in env.agents] == [0, 1, 2, 2, 0]


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ({"robot_0": 0}, r"missing \['robot_1', 'robot_2', 'robot_3', 'robot_4'\]"),
        ({**{f"robot_{k}": 0 for k in range(5)}, "robot_5": 0}, r"unknown \['robot_5'\]"),
        ({f"robot_{k}": 3 for k in range(5)}, r"actions\['robot_0'\]: expected 0\.\.2, got 3"),
        ({f"robot_{k}": -1 for k in range(5)}, r"expected 0\.\.2, got -1"),
        ({f"robot_{k}": 0.5 for k in range(5)}, r"expected 0\.\.2, got 0\.5"),
        ({f"robot_{k}": None for k in range(5)}, r"expected 0\.\.2, got None"),
    ],
)
def test_wrong_actions_are_named_and_nothing_moves(actions, message):
    env = begun(clean_swarm_v0.parallel_env(), seed=1)
    before = env.state()
    with pytest.raises(ValueError, match=message):
        env.step(actions)
    assert np.array_equal(env.state(), before)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda make: make("tabel1"),
            ConfigurationError,
            r"unknown mission, family, experiment or task 'tabel1'.*table1",
        ),
        (lambda make: make(render_mode="ansi"), ValueError, "expected None or 'human' or 'rgb_array', got 'ansi'"),
        (lambda make: make().step({}), RuntimeError, "call reset first"),
        (lambda make: make(max_cycles=0), ValueError, "max_cycles: expected a whole number of at least 1, got 0"),
        (
            lambda make: make().reset(options={"start": [1, 2]}),
            TypeError,
            "expected a dictionary or a StartConfiguration, got \\[1, 2\\]",
        ),
        (
            lambda make: make().reset(options={"start": random_start(mission(robots={"count": 6}), 1, 0)}),
            ValueError,
            "expected 5 robots and 10 items, got 6 and 10",
        ),
    ],
)
def test_wrong_use_is_an_error_that_says_what_was_expected(call, error, message):
    with pytest.raises(error, match=message):
        call(clean_swarm_v0.parallel_env)


def test_observations_belong_to_the_caller():
    env = clean_swarm_v0.parallel_env()
    observations, _ = env.reset(seed=1)
    kept = {agent: seen.copy() for agent, seen in observations.items()}
    env.step(dict.fromkeys(env.agents, 0))
    assert all(np.array_equal(observations[agent], kept[agent]) for agent in kept)


def test_importing_the_environment_loads_neither_torch_nor_matplotlib():
    code = "from clean_swarm_env import clean_swarm_v0; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {name.partition(".")[0] for name in done.stdout.split()} & {"torch", "stable_baselines3", "matplotlib"}


@pytest.mark.extra
def test_the_usual_parts_of_a_pettingzoo_module_are_there():
    pytest.importorskip("pygame", reason="the mode human opens a window")
    assert isinstance(clean_swarm_v0.env(), OrderEnforcingWrapper)
    assert not isinstance(clean_swarm_v0.raw_env(), OrderEnforcingWrapper)
    render_test(clean_swarm_v0.env)
