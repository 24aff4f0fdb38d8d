"""The border to Stable-Baselines3: rows beside the batch, ends of episodes, wrappers, seeds, attributes, learning."""

import copy
import pickle

import cloudpickle
import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")

from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import world_seeds
from clean_swarm_env.learning.joined import batches_of
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.sb3 import MissionCallback, RobotVecEnv, evaluate_missions
from tests.clean_swarm_env.courses import OPTIONS, begun, long_course, mission

pytestmark = pytest.mark.extra
SHORT = mission(garbage={"count": 2}, time_limit=30.0)
END = ("duration_s", "garbage_done", "mission_collision_events", "completed")


def stepped(envs, steps, seed=3):
    """Seed and reset, then yield the results of each step."""
    rng = np.random.default_rng(seed)
    envs.seed(range(seed, seed + envs.worlds))
    envs.reset()
    for _ in range(steps):
        yield envs.step(rng.integers(0, 3, envs.num_envs))


@long_course
def test_rows_are_those_of_the_batch_and_truncation_is_kept_apart():
    batch, rng, kinds = Batch(SHORT, 2), np.random.default_rng(3), set()
    batch.reset([3, 4])
    totals, lengths = np.zeros(10), np.zeros(10)
    for seen, rewards, dones, infos in stepped(RobotVecEnv(2, mission=SHORT), 120):
        step = batch.step(rng.integers(0, 3, 10))
        totals, lengths = totals + step.rewards, lengths + 1
        assert np.array_equal(seen, step.observations)
        assert np.array_equal(rewards, step.rewards.astype(np.float32))
        assert np.array_equal(dones, np.repeat(step.terminated | step.truncated, 5))
        ends = {end.world: end for end in batch.finished}
        for row, info in enumerate(infos):
            assert ("terminal_observation" in info) == dones[row] == ("TimeLimit.truncated" in info)
            for kind, name in enumerate(("picked", "recycled", "dumped", "collisions")):
                assert info[f"own_{name}"] == batch.progress.events[kind, row]
            if dones[row]:
                assert np.array_equal(info["terminal_observation"], step.final_observations[row])
                assert info["TimeLimit.truncated"] == step.truncated[row // 5]
                assert {name: info[name] for name in END} == ends[row // 5].statistics
                assert 0.0 <= info["episode"]["t"] < 3600.0
                assert (info["episode"]["r"], info["episode"]["l"]) == (pytest.approx(totals[row]), lengths[row])
                totals[row], lengths[row] = 0.0, 0
                kinds.add(info["TimeLimit.truncated"])
    assert kinds == {True, False}


def test_seeds_count_for_the_next_reset_and_the_series_goes_on_without():
    envs = RobotVecEnv(2, mission=SHORT)
    seeds = envs.seed(5)
    assert seeds == np.repeat(world_seeds(5, 2), 5).tolist()
    assert envs.seed([8, 9]) == envs.seed([8] * 5 + [9] * 5) == [8] * 5 + [9] * 5
    envs.seed(5)
    first = envs.reset()
    alone, _ = clean_swarm_v0.parallel_env(SHORT).reset(seed=seeds[5])
    assert np.array_equal(first[5:], np.stack([*alone.values()]))
    second = envs.reset()
    assert not np.array_equal(first, second)
    envs.seed(5)
    assert np.array_equal(envs.reset(), first)
    assert np.array_equal(envs.reset(), second)
    assert envs.seed() != envs.seed()


def test_options_of_a_reset_count_once():
    envs, start = RobotVecEnv(2, mission=SHORT), random_start(SHORT, 7, 1)
    envs.set_options({"start": start})
    envs.reset()
    positions = envs.batches[0].worlds.physics.positions
    assert np.allclose(positions, np.tile(np.array(start.robots)[:, :2], (2, 1)))
    envs.reset()
    assert not np.allclose(positions[:5], positions[5:])


def test_attributes_and_methods_of_rows():
    envs = RobotVecEnv(2, mission=SHORT, action=ActionConfig(serves={"RepulsionFernandez-view2.0": ("patrol",)}))
    envs.seed(1)
    envs.reset()
    assert envs.get_attr("world") == [0] * 5 + [1] * 5
    assert envs.get_attr("robot", indices=[0, 6]) == [0, 1]
    assert envs.get_attr("options", 0) == [{"AvoidCollision": OPTIONS}]
    masks = np.stack(envs.env_method("action_masks"))
    assert np.array_equal(masks, envs.batches[0].masks())
    assert np.array_equal(masks, envs.action_masks())
    assert np.array_equal(envs.env_method("action_masks", indices=7)[0], masks[7])
    assert envs.has_attr("action_masks")
    assert not envs.has_attr("weather")
    with pytest.raises(AttributeError, match="weather"):
        envs.get_attr("weather")
    envs.set_attr("nickname", "Wall-E", indices=[3])
    assert envs.get_attr("nickname", 3) == ["Wall-E"]
    assert not envs.has_attr("nickname")
    with pytest.raises(AttributeError):
        envs.set_attr("options", {})
    assert envs.env_is_wrapped(VecMonitor) == [False] * 10


def test_making_it_sets_one_torch_thread_unless_the_user_says_otherwise(monkeypatch):
    import torch

    before = torch.get_num_threads()
    try:
        for given, expected in ((None, 1), ("3", 3)):
            torch.set_num_threads(3)
            monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
            if given:
                monkeypatch.setenv("OMP_NUM_THREADS", given)
            RobotVecEnv(1, mission=SHORT)
            assert torch.get_num_threads() == expected
    finally:
        torch.set_num_threads(before)


@long_course
def test_a_single_agent_for_the_team_passes_sb3s_check():
    check_env(CleanSwarmTeam(SHORT))
    check_env(CleanSwarmTeam(SHORT, one_for_all=True))
    check_env(CleanSwarmTeam(SHORT, action=ActionConfig(mode="velocity")))


@pytest.mark.long
@pytest.mark.parametrize("mode", ["option", "velocity"])
def test_ppo_learns_on_it_and_equal_seeds_learn_alike(mode):
    weights = []
    for _ in range(2):
        envs = VecNormalize(VecMonitor(RobotVecEnv(3, mission=SHORT, action=ActionConfig(mode=mode))))
        model = PPO("MlpPolicy", envs, n_steps=32, batch_size=160, n_epochs=2, seed=1, device="cpu")
        model.learn(2 * 32 * envs.num_envs)
        assert model.num_timesteps == 960
        assert len(model.ep_info_buffer) > 0
        weights.append({name: tensor.numpy().copy() for name, tensor in model.policy.state_dict().items()})
    assert all(np.array_equal(weights[0][name], weights[1][name]) for name in weights[0])
    assert all(np.isfinite(tensor).all() for tensor in weights[0].values())
    envs.training = False
    mean, _ = evaluate_policy(model, envs, n_eval_episodes=15)
    assert np.isfinite(mean)


def of_two():
    """Return the worlds of a mission, and those of a family with larger teams."""
    settings = {"knowledge": "avoidance", "observation": ObservationConfig(terms=["situation", "crowd"])}
    return [Batch(SHORT, 2, **settings), *batches_of("crowded", 1, **settings)]


@long_course
def test_rows_of_several_batches_are_those_of_each_alone():
    together, alone = RobotVecEnv(batches=of_two()), [RobotVecEnv(batches=[batch]) for batch in of_two()]
    seeds = together.seed(5)
    assert seeds == np.repeat(world_seeds(5, 3), [5, 5, 20]).tolist()
    alone[0].seed(seeds[:10])
    alone[1].seed(seeds[10:])
    assert np.array_equal(together.reset(), np.concatenate([envs.reset() for envs in alone]))
    assert together.get_attr("robot", [9, 10, 29]) == [4, 0, 19]
    assert together.get_attr("batch", [9, 10]) == list(together.batches)
    ends = 0
    for options in np.random.default_rng(1).integers(0, 6, (40, 30)):
        answer, others = together.step(options), [alone[0].step(options[:10]), alone[1].step(options[10:])]
        for mine, *parts in zip(answer[:3], *others, strict=False):
            assert np.array_equal(mine, np.concatenate(parts))
        for info, other in zip(answer[3], others[0][3] + others[1][3], strict=True):
            assert info.keys() == other.keys()
            assert all(np.array_equal(info[key], other[key]) for key in info.keys() - {"episode"})
            assert all(info["episode"][key] == other["episode"][key] for key in "rl" if "episode" in info)
        ends += len(together.finished)
    assert ends > 0
    with pytest.raises(ValueError, match="expected batches or settings of one, got both"):
        RobotVecEnv(batches=of_two(), knowledge="avoidance")


@pytest.mark.parametrize("way", [copy.deepcopy, lambda envs: pickle.loads(cloudpickle.dumps(envs))])
def test_a_vecenv_is_copied_and_goes_back(way):
    """Over the end of missions: returns and lengths of episodes are copied and kept in states, too."""

    def play(envs):
        steps = [envs.step(np.full(envs.num_envs, k % 2)) for k in range(35)]
        ends = [info["episode"] | {"t": 0} for *_, infos in steps for info in infos if "episode" in info]
        return [(seen.tolist(), rewards.tolist(), dones.tolist()) for seen, rewards, dones, _ in steps], ends

    envs = RobotVecEnv(2, mission=SHORT)
    envs.seed(3)
    envs.reset()
    for _ in range(10):
        envs.step(np.zeros(10, np.int64))
    twin, state = way(envs), envs.get_state()
    course = play(envs)
    assert len(course[1]) >= 10
    assert play(twin) == course
    envs.set_state(state)
    assert play(envs) == course


OPEN = mission(
    robots={"capacity": 8},
    events=[{"at": 2.0, "do": "fail", "robots": [1]}, {"at": 4.0, "do": "join"}],
    garbage={"count": 3},
    time_limit=25.0,
)
"""Five robots, of which one fails, and one that joins; two rows of eight have no robot in any mission."""


class Still:
    """A model that always takes the same option, and notes what it sees."""

    def __init__(self, option=2):
        self.option, self.seen = option, []

    def predict(self, observation, state=None, episode_start=None, deterministic=False):
        self.seen.append(observation)
        return np.full(len(observation), self.option), None


def test_missions_are_evaluated_one_by_one_and_robots_that_do_not_exist_are_not_counted():
    envs, model = RobotVecEnv(2, mission=OPEN), Still()
    told = evaluate_missions(model, envs, 3, seed=3)
    batch = begun(Batch(OPEN, 2, begin_anew=False), envs.seed(3)[::8])
    gained = sum(batch.step(np.full(16, 2)).rewards for _ in range(25)).reshape(2, 8)
    assert {*gained[:, :6].mean(axis=1).round(9)} <= {round(one["return"], 9) for one in told}
    assert [one["robots"] for one in told] == [6] * 3
    assert told[0].keys() >= {"scenario", "cost_s", *END}
    assert not np.stack(model.seen)[:, [6, 7, 14, 15]].any()
    assert len(evaluate_missions(model, envs, 1)) == 1, "fewer missions than worlds"
    with pytest.raises(TypeError, match="envs: expected a RobotVecEnv, wrapped or not, got Foreign"):
        evaluate_missions(model, type("Foreign", (), {"unwrapped": property(lambda self: self)})(), 1)


@pytest.mark.parametrize("wrapped", [lambda envs: envs, VecMonitor])
def test_an_evaluation_by_rows_ends_where_rows_have_no_robot_and_one_warning_says_what_to_use(wrapped):
    with pytest.warns(UserWarning, match="evaluate_missions") as warned:
        returns, _ = evaluate_policy(Still(), wrapped(RobotVecEnv(1, mission=OPEN)), 16, return_episode_rewards=True)
    assert len(returns) == 16
    assert returns.count(0.0) == 4
    ours = [str(one.message) for one in warned if "evaluate_missions" in str(one.message)]
    assert len(ours) == 1


def test_the_mean_return_of_a_learner_is_that_of_real_robots_and_a_callback_keeps_the_best(tmp_path):
    envs, others, path = RobotVecEnv(1, mission=OPEN), RobotVecEnv(1, mission=OPEN), tmp_path / "best.zip"
    model = PPO("MlpPolicy", envs, n_steps=26, batch_size=104, n_epochs=1, seed=1, device="cpu")
    callback = MissionCallback(others, 2, every=8 * 26, path=path)
    model.learn(2 * 8 * 26, callback=callback)
    assert len(model.ep_info_buffer) == 12
    assert not [one for one in model.ep_info_buffer if one["r"] == 0.0]
    assert [*callback.told] == [208, 416]
    means = [np.mean([one["return"] for one in told]) for told in callback.told.values()]
    assert callback.best == max(means)
    assert path.exists()
    with pytest.raises(ValueError, match="envs: expected other worlds than those in which the model learns"):
        model.learn(8 * 26, callback=MissionCallback(envs, 2, every=8))
