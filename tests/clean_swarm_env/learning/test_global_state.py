"""The global state: named components within [-1, 1] that say where everything is."""

import numpy as np

from clean_swarm_env import clean_swarm_v0
from tests.clean_swarm_env.borders.test_changing_agents import EVENTS
from tests.clean_swarm_env.courses import OPTIONS, begun, mission


def named(env):
    return dict(zip(env.state_names, env.state().tolist(), strict=True))


def test_the_state_says_where_everything_is():
    env = begun(clean_swarm_v0.parallel_env(), seed=1)
    worlds, state = env.batch.worlds, named(env)
    assert env.state_space.shape == (len(state),) == (5 * (7 + 3) + 10 * 5 + 4 + 2,)
    for row in range(5):
        x, y = worlds.physics.positions[row] / worlds.extent * 2 - 1
        heading = worlds.physics.headings[row]
        assert np.allclose([state[f"robot_{row}_{name}"] for name in ("x", "y")], [x, y])
        pair = [state[f"robot_{row}_heading_{name}"] for name in ("cos", "sin")]
        assert np.allclose(pair, [np.cos(heading), np.sin(heading)])
        assert [state[f"robot_{row}_holds_{option}"] for option in OPTIONS] == [1, 0, 0]
    assert np.allclose(state["dump_x"], worlds.task.stations[0, 1, 0] / worlds.extent[0] * 2 - 1)
    for _ in range(40):
        env.step(dict.fromkeys(env.agents, 2))
    state, garbage = named(env), worlds.task.garbage
    assert [state[f"robot_{row}_carrying"] for row in range(5)] == (garbage.cargo >= 0).tolist()
    assert [state[f"item_{k}_done"] for k in range(10)] == (garbage.stage[0] == 2).tolist()
    assert [state[f"robot_{row}_holds_{OPTIONS[2]}"] for row in range(5)] == [1] * 5
    assert np.allclose(state["time"], 40.0 / worlds.mission.time_limit)
    assert np.allclose(state["garbage_done"], garbage.done[0] / 10)


def test_the_state_lies_in_its_space_while_robots_leave_and_join_and_absent_ones_are_zero():
    config = mission(events=EVENTS, time_limit=30.0)
    for settings in ({}, {"action": {"mode": "velocity"}}, {"state": "observations"}):
        env = begun(clean_swarm_v0.parallel_env(config, **settings), seed=2)
        while env.agents:
            assert env.state_space.contains(env.state())
            env.step({agent: env.action_space(agent).sample() for agent in env.agents})
        if not settings:
            assert not any(value for name, value in named(env).items() if name.startswith("robot_0_"))


def test_all_observations_stay_available():
    env = clean_swarm_v0.parallel_env(state="observations")
    observations, _ = env.reset(seed=1)
    assert np.array_equal(env.state(), np.concatenate(list(observations.values())))
