"""The Gymnasium borders: the library's checkers, whole trajectories beside the batch, ends of episodes, ids."""

import gymnasium
import numpy as np
import pettingzoo
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from clean_swarm_env import clean_swarm_v0, registration  # noqa: F401  (registers)
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.config.task_names import family_ids
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import world_seeds
from tests.clean_swarm_env.courses import begun, long_course, mission

SHORT = mission(garbage={"count": 2}, time_limit=50.0)
SERVES = ActionConfig(serves={"RepulsionFernandez-view2.0": ("patrol", "approach")})


@long_course
@pytest.mark.extra
@pytest.mark.filterwarnings("error::UserWarning")
@pytest.mark.filterwarnings("ignore:.*not run by the environment checker.*")  # render modes need a spec
@pytest.mark.parametrize(
    ("name", "mode"), [("CleanSwarm-v0", "option"), ("CleanSwarm-v0", "velocity"), ("CleanSwarmOneForAll-v0", "option")]
)
def test_the_environments_of_teams_pass_gymnasiums_check(name, mode):
    pytest.importorskip("pygame", reason="the mode human opens a window")
    check_env(gymnasium.make(name, mission=SHORT, action={"mode": mode}).unwrapped)


@long_course
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_teams_at_once_go_through_what_gymnasium_makes_of_single_ones(mode):
    """Gymnasium's own vector environment of single environments is the reference."""
    reference = SyncVectorEnv([lambda: CleanSwarmTeam(SHORT)] * 3, autoreset_mode=mode)
    envs = gymnasium.make_vec("CleanSwarm-v0", num_envs=3, mission=SHORT, autoreset_mode=mode.value)
    assert envs.unwrapped.autoreset_mode == envs.metadata["autoreset_mode"] == mode
    for name in ("single_observation_space", "single_action_space", "observation_space", "action_space"):
        assert getattr(envs, name) == getattr(reference, name)
    rng, ends = np.random.default_rng(1), 0
    assert np.array_equal(envs.reset(seed=[4, 5, 6])[0], reference.reset(seed=4)[0])
    for _ in range(120):
        actions = rng.integers(0, 3, (3, 5))
        own, other = envs.step(actions), reference.step(actions)
        assert envs.observation_space.contains(own[0])
        for mine, theirs in zip(own[:4], other[:4], strict=True):
            assert (mine.dtype, mine.tolist()) == (theirs.dtype, theirs.tolist())
        assert ("final_obs" in own[4]) == ("final_obs" in other[4])
        if "final_obs" in own[4]:
            _compare_ends(own[4], other[4])
        ends += int((own[2] | own[3]).sum())
    assert ends > 5


def _compare_ends(infos, theirs):
    assert np.array_equal(infos["_final_obs"], theirs["_final_obs"])
    for mine, other in zip(infos["final_obs"], theirs["final_obs"], strict=True):
        assert (mine is None) == (other is None)
        assert mine is None or np.array_equal(mine, other)
    final, reference = infos["final_info"], theirs["final_info"]
    for name, values in reference.items():
        if name.startswith("_"):
            assert np.array_equal(final[name], values)
        else:
            ended = reference[f"_{name}"]
            assert np.array_equal(final[name][ended], values[ended]), name


@long_course
def test_robots_as_environments_are_the_rows_of_the_batch():
    envs, batch, rng, ends = RobotVectorEnv(2, mission=SHORT), Batch(SHORT, 2), np.random.default_rng(1), 0
    first, infos = envs.reset(seed=[4, 5])
    assert np.array_equal(first, batch.reset([4, 5]))
    assert infos["time_s"].tolist() == [0.0] * 10
    for _ in range(60):
        actions = rng.integers(0, 3, 10)
        seen, rewards, terminated, truncated, infos = envs.step(actions)
        step = batch.step(actions)
        assert np.array_equal(seen, step.observations)
        assert np.array_equal(rewards, step.rewards)
        assert np.array_equal(terminated, np.repeat(step.terminated, 5))
        assert np.array_equal(truncated, np.repeat(step.truncated, 5))
        assert not (terminated & truncated).any()
        for end in batch.finished:
            ends += 1
            rows = batch.worlds.rows_of(end.world)
            assert np.array_equal(np.stack(infos["final_obs"][rows]), step.final_observations[rows])
            assert infos["final_info"]["duration_s"][rows].tolist() == [end.result.duration_s] * 5
            assert infos["final_info"]["garbage_done"][rows].tolist() == [end.result.garbage_done] * 5
            assert infos["time_s"][rows] == pytest.approx(end.result.ticks * 0.2)
    assert ends > 1


def test_what_is_returned_belongs_to_the_caller():
    envs = begun(RobotVectorEnv(1, mission=SHORT), seed=1)
    seen, rewards, *_, infos = envs.step(np.zeros(5, dtype=np.int64))
    kept = seen.copy(), rewards.copy(), infos["own_avoiding_s"].copy()
    for _ in range(5):
        envs.step(np.ones(5, dtype=np.int64))
    assert np.array_equal(seen, kept[0])
    assert np.array_equal(rewards, kept[1])
    assert np.array_equal(infos["own_avoiding_s"], kept[2])


def test_one_option_serves_all_robots_of_a_team():
    envs = begun(TeamVectorEnv(2, mission=SHORT, one_for_all=True), seed=1)
    envs.step(np.array([2, 1]))
    assert envs.batch.worlds.minds.coordinator_of(AVOIDANCE).held.tolist() == [2] * 5 + [1] * 5


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: RobotVectorEnv(0), ValueError, "worlds: expected a whole number of at least 1, got 0"),
        (
            lambda: begun(RobotVectorEnv(1), seed=1).step(np.zeros(4, dtype=np.int64)),
            ValueError,
            r"actions: expected shape \(5,\), got \(4,\)",
        ),
        (lambda: CleanSwarmTeam(SHORT).step(np.zeros(5, dtype=np.int64)), RuntimeError, "call reset first"),
        (
            lambda: RobotVectorEnv(1, mission=SHORT, render_mode="human"),
            ValueError,
            "render_mode: expected None or 'rgb_array', got 'human'",
        ),
        (
            lambda: CleanSwarmTeam(SHORT, render_mode="ansi"),
            ValueError,
            "expected None or 'human' or 'rgb_array', got 'ansi'",
        ),
        (
            lambda: RobotVectorEnv(2, mission=SHORT).reset(seed=[1, 2, 3]),
            ValueError,
            "seeds: expected one for each of 2 worlds, got 3",
        ),
    ],
)
def test_wrong_use_is_an_error_that_says_what_was_expected(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_without_beginning_anew_a_mask_says_which_worlds_begin():
    envs = RobotVectorEnv(2, mission=mission(time_limit=2.0), autoreset_mode="Disabled")
    envs.reset(seed=1, options={"reset_mask": np.arange(10) >= 5})
    with pytest.raises(RuntimeError, match="step: call reset first"):
        envs.step(np.zeros(10, dtype=np.int64))  # one world has not begun
    first, _ = envs.reset(seed=1)
    still = np.zeros(10, dtype=np.int64)
    envs.step(still)
    seen, _, _, truncated, _ = envs.step(still)
    assert truncated.all()
    with pytest.raises(RuntimeError, match=r"missions of worlds \[0, 1\] are over, call reset first"):
        envs.step(still)
    mask = np.arange(10) >= 5
    again, infos = envs.reset(seed=1, options={"reset_mask": mask})
    assert np.array_equal(again[5:], first[5:])
    assert np.array_equal(again[:5], seen[:5])
    assert infos["time_s"].tolist() == [2.0] * 5 + [0.0] * 5
    with pytest.raises(ValueError, match="expected all robots of a world or none"):
        envs.reset(options={"reset_mask": np.arange(10) > 5})
    with pytest.raises(ValueError, match=r"reset_mask.*: expected truth values of shape \(10,\)"):
        envs.reset(options={"reset_mask": [1]})


def test_seeds_may_be_those_of_worlds_or_of_robots():
    envs = RobotVectorEnv(2, mission=SHORT)
    first, _ = envs.reset(seed=[7, 9])
    assert np.array_equal(envs.reset(seed=[7] * 5 + [9] * 5)[0], first)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_seed_counts_for_the_worlds_that_begin_only(threads):
    envs, others = (RobotVectorEnv(2, mission=SHORT, threads=threads) for _ in "ab")
    for one in (envs, others):
        one.reset(seed=3)
    envs.reset(seed=8, options={"reset_mask": np.arange(10) >= 5})
    assert np.array_equal(envs.reset()[0][:5], others.reset()[0][:5])


def test_neighbouring_seeds_have_other_worlds_and_each_world_repeats_alone():
    """Ten seeds of 24 worlds are 240 worlds; world w of seed S is no world of seed S + 1."""
    assert len({one for seed in range(10) for one in world_seeds(seed, 24)}) == 240
    assert world_seeds(3, 2) == world_seeds(3, 5)[:2]
    for border in (RobotVectorEnv, TeamVectorEnv):
        envs = border(2, mission=SHORT)
        seen, following = (envs.reset(seed=seed)[0].reshape(2, -1) for seed in (6, 7))
        assert not (seen[:, None] == following).all(axis=2).any()
        for world, seed in enumerate(world_seeds(6, 2)):
            alone, _ = clean_swarm_v0.parallel_env(SHORT).reset(seed=seed)
            assert np.array_equal(seen[world], np.concatenate([*alone.values()]))


def test_attributes_methods_masks_and_pictures_of_environments():
    envs = begun(RobotVectorEnv(2, mission=SHORT, action=SERVES, render_mode="rgb_array"), seed=1)
    assert envs.get_attr("world") == (0,) * 5 + (1,) * 5
    assert envs.call("robot") == (0, 1, 2, 3, 4) * 2
    assert np.array_equal(np.stack(envs.call("action_masks")), envs.batch.masks())
    with pytest.raises(AttributeError, match="weather"):
        envs.get_attr("weather")
    assert len(envs.render()) == 10
    team = CleanSwarmTeam(SHORT, action=SERVES)
    _, infos = team.reset(seed=1)
    assert team.action_masks().tolist() == infos["action_mask"].tolist()
    assert CleanSwarmTeam(SHORT, one_for_all=True).action_masks().shape == (3,)


def test_make_vec_takes_what_make_takes_and_every_id_has_both():
    settings = {"mission": SHORT, "render_mode": "rgb_array", "knowledge": "avoidance", "reward": {"dumped": 2.0}}
    for name in [name for name in gymnasium.registry if name.startswith("CleanSwarm") and name not in family_ids()]:
        assert gymnasium.registry[name].entry_point
        assert gymnasium.make(name, **settings).observation_space.shape
        assert gymnasium.make_vec(name, num_envs=2, **settings).num_envs == 2
    assert gymnasium.make("clean_swarm_env.registration:CleanSwarm-v0").action_space.nvec.tolist() == [3] * 5
    assert gymnasium.make("CleanSwarmOneForAll-v0").action_space.n == 3
    assert pettingzoo.make("parallel", "CleanSwarm-v0", mission=SHORT).mission is SHORT
    assert pettingzoo.make("aec", "CleanSwarm-v0").possible_agents[0] == "robot_0"


def test_families_are_made_by_their_ids():
    settings = {"size": (14.0, 10.0)}
    team = gymnasium.make("CleanSwarm-Rooms-v1", **settings).unwrapped
    teams = gymnasium.make_vec("CleanSwarm-Rooms-v1", num_envs=2, **settings)
    agents = pettingzoo.make("parallel", "CleanSwarm-Rooms-v1", **settings)
    assert [each.batch.mission.name for each in (team, teams, agents)] == ["rooms-1"] * 3
    assert pettingzoo.make("aec", "CleanSwarm-Losses-v1").possible_agents[0] == "robot_0"
    with pytest.raises(ValueError, match="size: expected one of those of family 'rooms-1'"):
        clean_swarm_v0.parallel_env("CleanSwarm-Rooms-v1")


def plain(told):
    """Return nested results with lists in place of arrays."""
    if isinstance(told, dict):
        return {name: plain(part) for name, part in told.items()}
    return [plain(part) for part in told] if isinstance(told, list | tuple | np.ndarray) else told


@pytest.mark.parametrize("autoreset", ["SameStep", "NextStep"])
@pytest.mark.parametrize("border", [RobotVectorEnv, TeamVectorEnv])
def test_threads_change_no_bit_of_what_a_learner_gets(border, autoreset):
    short, told, states = mission(garbage={"count": 2}, time_limit=8.0), set(), []
    for threads in (1, 2, 5):
        envs = border(5, mission=short, threads=threads, autoreset_mode=autoreset)
        envs.action_space.seed(1)
        seen = [envs.reset(seed=4), *(envs.step(envs.action_space.sample()) for _ in range(12))]
        assert any("final_obs" in infos for *_, infos in seen) == (autoreset == "SameStep")
        states.append(envs.get_state())
        last = envs.step(envs.action_space.sample())
        told.add(repr(plain([seen, last, envs.masks(), [env.world for env in envs.envs]])))
    assert len(told) == 1
    assert np.array_equal(envs.set_state(states[0]), seen[-1][0]), "a state fits any number of threads"
