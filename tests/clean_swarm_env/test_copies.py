"""Copies and pickles are independent, and have all further bits of the original, at any moment and also without it."""

import copy
import gc
import pickle
import subprocess
import sys

import cloudpickle
import gymnasium
import numpy as np
import pytest

import clean_swarm_env.registration  # noqa: F401  (the ids of the environments)
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv
from clean_swarm_env.borders.infos import team_infos
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.world.mission import Course, MissionRun, result_of
from tests.clean_swarm_env.copies import advance, random_batch
from tests.clean_swarm_env.courses import CROWD, long_course, mission, worlds_at_start
from tests.object_graph import arrays_of, differing, pointing_into, shared_in
from tests.paths import ROOT

WAYS = {
    "deepcopy": copy.deepcopy,
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
    "cloudpickle": lambda thing: pickle.loads(cloudpickle.dumps(thing)),
}
SHORT = mission(garbage={"count": 2}, time_limit=30.0)


def check_copy(seed, way):
    """Copy a random batch at a random moment: same bits side by side, alone, and after the original is gone."""
    rng = np.random.default_rng(seed)
    batch = random_batch(rng)
    advance(batch, rng, int(rng.integers(0, 60)))
    twin, orphan = way(batch), way(batch)
    arrays = arrays_of(batch)
    assert pointing_into(arrays_of(twin), arrays) == []
    assert shared_in(arrays_of(twin)) == shared_in(arrays)
    further = int(rng.integers(1 << 30))
    course = advance(twin, np.random.default_rng(further), 12)
    assert advance(batch, np.random.default_rng(further), 12) == course
    assert differing(batch, twin) == []
    del batch, twin, arrays
    gc.collect()
    assert advance(orphan, np.random.default_rng(further), 12) == course


@long_course
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("way", WAYS)
def test_a_copy_of_a_random_mission_at_a_random_moment_has_all_further_bits(seed, way):
    check_copy((seed, list(WAYS).index(way)), WAYS[way])


@pytest.mark.parametrize("ticks", [0, 1, 3, 57])
@pytest.mark.parametrize("way", WAYS)
def test_worlds_are_copied_at_any_tick_also_while_robots_touch(ticks, way):
    worlds = worlds_at_start(CROWD, [5, 6])
    for _ in range(ticks):
        worlds.tick()
    twin = WAYS[way](worlds)
    if ticks == 57:
        assert worlds.physics._motion.record.patience.any()
    for _ in range(20):
        assert np.array_equal(worlds.tick(), twin.tick())
    assert differing(worlds, twin) == []


@pytest.mark.parametrize("part", ["network", "floor", "minds", "physics"])
@pytest.mark.parametrize("way", WAYS)
def test_parts_of_worlds_are_copied(part, way):
    worlds = worlds_at_start(CROWD, [5])
    for _ in range(30):
        worlds.tick()
    original = getattr(worlds, part)
    twin = WAYS[way](original)
    assert pointing_into(arrays_of(twin), arrays_of(original)) == []
    assert differing(original, twin) == []


def test_a_mission_goes_on_in_another_process(tmp_path):
    """Saved at a tick, loaded by a process that has never seen it: the same result."""
    course = Course(MissionRun(SHORT, random_start(SHORT, 4, 0), 4, {}))
    for _ in range(37):
        course.tick()
    saved = tmp_path / "course"
    saved.write_bytes(pickle.dumps(course))
    while course.in_progress:
        course.tick()
    code = (
        "import pickle, sys; from clean_swarm_env.world.mission import result_of\n"
        f"course = pickle.loads(open({str(saved)!r}, 'rb').read())\n"
        "while course.in_progress: course.tick()\n"
        "print(course.worlds.physics.positions.tobytes().hex(), result_of(course.worlds, 0))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    positions = course.worlds.physics.positions.tobytes().hex()
    assert done.stdout.strip() == f"{positions} {result_of(course.worlds, 0)}"


def play_parallel(env, steps=25):
    """Sample and take steps; return all that the environment answers."""
    seen = []
    for _ in range(steps):
        if not env.agents:
            env.reset(seed=9)
        answers = env.step({agent: env.action_space(agent).sample() for agent in env.agents})
        seen.append([{agent: np.asarray(part).tolist() for agent, part in answer.items()} for answer in answers[:4]])
    return seen


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("settings", [{}, {"family": "shifting"}, {"mission": SHORT}], ids=["table1", "open", "ends"])
def test_the_pettingzoo_environment_is_copied_with_its_spaces(way, settings):
    """SuperSuit makes its copies of an environment so: by cloudpickle, before and after `reset`."""
    fresh = clean_swarm_v0.parallel_env(**settings)
    env = WAYS[way](fresh)
    env.reset(seed=3)
    for agent in env.agents:
        env.action_space(agent).seed(1)
    play_parallel(env)
    twin = WAYS[way](env)
    assert pointing_into(arrays_of(twin), arrays_of(env)) == []
    course = play_parallel(env)
    del env
    gc.collect()
    assert play_parallel(twin) == course


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["CleanSwarm-v0", "CleanSwarmOneForAll-v0"])
def test_a_gymnasium_environment_is_copied(way, name):
    env = gymnasium.make(name, mission=SHORT)
    env.reset(seed=2)
    env.action_space.seed(2)
    for _ in range(10):
        env.step(env.action_space.sample())
    twin = WAYS[way](env)
    for _ in range(10):
        action = env.action_space.sample()
        ours, its = env.step(action), twin.step(action)
        assert np.array_equal(ours[0], its[0])
        assert ours[1:4] == its[1:4]
    assert differing(env.unwrapped.batch, twin.unwrapped.batch) == []


@pytest.mark.parametrize("way", WAYS)
def test_a_gymnasium_vector_environment_is_copied(way):
    envs = RobotVectorEnv(2, mission=SHORT)
    envs.reset(seed=2)
    twin = WAYS[way](envs)
    for _ in range(35):  # over the end of the missions
        actions = envs.action_space.sample()
        for ours, its in zip(envs.step(actions)[:4], twin.step(actions)[:4], strict=True):
            assert np.array_equal(ours, its)
    assert differing(envs.unwrapped.batch, twin.unwrapped.batch) == []


def test_a_batch_that_records_says_that_it_cannot_be_copied(tmp_path):
    """Both would write the same files."""
    with pytest.raises(TypeError, match="a batch that records its missions cannot be copied"):
        copy.deepcopy(Batch(SHORT, record=RecordSettings(tmp_path)))


@pytest.mark.parametrize("task", [name for name in TASKS.names() if name != "Cleaning"])
def test_a_batch_of_any_task_is_copied_with_what_its_task_keeps(task):
    """The robots, the mechanism that serves them, what they leave behind, and the arrays of the task."""
    batch = Batch({"task": task, "time_limit": 10.0})
    batch.reset([3])

    def course(batch):
        steps = [batch.step(np.tile(batch.choices.default, (batch.rows, 1))) for _ in range(3)]
        figures = team_infos(batch)
        return [(step.observations.tobytes(), step.rewards.tobytes()) for step in steps], repr(figures)

    course(batch)
    twin, orphan = copy.deepcopy(batch), pickle.loads(pickle.dumps(batch))
    assert pointing_into(arrays_of(twin), arrays_of(batch)) == []
    expected = course(twin)
    assert course(batch) == expected
    del batch, twin
    gc.collect()
    assert course(orphan) == expected
