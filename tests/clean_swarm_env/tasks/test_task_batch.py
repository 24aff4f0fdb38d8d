"""Tasks as batches: rewards from measures, actions, states and wrong settings."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.infos import own_infos
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.world.parts.measure import key_of
from tests.clean_swarm_env.courses import begun, long_course

every_task = pytest.mark.parametrize("task", [name for name in TASKS.names() if name != "Cleaning"])


def batch_of(task, seconds=None, worlds=1, **settings):
    limit = {} if seconds is None else {"time_limit": seconds}
    return Batch({"task": task, **limit}, worlds, **settings)


def played(batch, action, seeds):
    """Return the rewards (R,) of an episode with the same action (R, ...) in each step, and its figures by world."""
    batch.reset(seeds)
    total = np.zeros(batch.rows)
    while not batch.finished:
        total += batch.step(action).rewards
    return total, [end.statistics for end in batch.finished]


def default_of(batch):
    return np.full(batch.rows, batch.choices.default[0])


@long_course
@every_task
def test_the_sum_of_rewards_is_what_the_measures_gained(task):
    batch = begun(batch_of(task, 21.0, 2), [7, 8])
    start = {name: values.copy() for name, values in batch.worlds.task.result().items()}
    total, figures = played(batch, default_of(batch), [7, 8])
    gained = np.zeros(2)
    for measure in batch.worlds.task.measures:
        ended = np.array([own[key_of(measure.name)] for own in figures])
        sign = 1.0 if measure.better == "higher" else -1.0
        gained += sign * (ended - start[measure.name]) / measure.target
    assert total.reshape(2, -1) == pytest.approx(np.repeat(gained[:, None], batch.robots, axis=1))
    assert np.isfinite(total).all()


def test_a_vector_takes_the_place_of_the_movement_and_all_else_goes_on():
    """Robots that follow what the mechanism asks for, period by period, bring food; those that stand bring none."""
    brought = []
    for speed in (0.0, 1.0):
        batch = batch_of("Foraging", worlds=2, action={"mode": "velocity"})
        seen = batch.reset([1, 2])
        while not batch.finished:
            seen = batch.step(speed * seen[:, :2]).observations
        brought.append([end.statistics["items_brought_per_minute"] for end in batch.finished])
    assert batch.observer.names[:2] == ("command_ahead", "command_left")
    assert brought[0] == [0.0, 0.0]
    assert min(brought[1]) > 1.0


def test_options_change_the_course():
    batch = batch_of("UniformDistribution", 10.0)
    first, second = (played(batch, np.full(batch.rows, option), [1])[0] for option in range(2))
    assert not np.array_equal(first, second)


def test_robots_with_different_options_of_deciding_agree():
    batch = batch_of("MaxValue")
    _, (figures,) = played(batch, np.arange(batch.rows) % 2, [1])
    assert figures["rounds_to_agreement"] < 12 * 5


def test_weights_of_a_task_pay():
    weights = {"items_brought_per_minute": 0.0, "collision": -2.0}
    batch = begun(batch_of("Foraging", 20.0, reward=weights), [1])
    collided = 0.0
    for _ in range(20):
        step = batch.step(default_of(batch))
        own = np.array(own_infos(batch)["own_collisions"])
        assert np.array_equal(step.rewards, -2.0 * own)
        collided += own.sum()
    assert collided > 0


FORAGING = {"task": "Foraging"}


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        ({"mission": {"task": "Foragin"}}, ConfigurationError, "unknown task 'Foragin'.*did you mean 'Foraging'"),
        ({"mission": {"task": {"name": "Foraging", "food": 3}}}, ConfigurationError, "food"),
        ({"mission": {**FORAGING, "garbage": {"count": 3}}}, ConfigurationError, "mission: garbage: unknown key"),
        ({"mission": {**FORAGING, "robots": {"count": 0}}}, ConfigurationError, "robots.count: "),
        ({"mission": {**FORAGING, "time_limit": -1.0}}, ConfigurationError, "time_limit: "),
        ({"mission": {**FORAGING, "world": {"ground": "moon"}}}, ConfigurationError, "world.ground: "),
        (
            {"mission": {"task": "CollectiveExploration", "world": {"width": 9000.0, "height": 9000.0}}},
            ConfigurationError,
            "world: expected at most 2896.25 m",
        ),
        (
            {"mission": {"task": "ExplorationPatrol", "world": {"ground": "open", "width": 9000.0, "height": 9000.0}}},
            ConfigurationError,
            "world: expected at most",
        ),
        ({"mission": {"world": {"ground": "open"}}}, ConfigurationError, "world.ground: .*task Cleaning"),
        (
            {"mission": {"task": "MaxValue", "robots": {"count": 1}}},
            ConfigurationError,
            "at least 2 with the task MaxV",
        ),
        ({"reward": {"items": 1.0}}, ConfigurationError, "reward: items: "),
        ({"reward": {"collision": "x"}}, ConfigurationError, "reward: collision: "),
        ({"observation": {"terms": ["cargos"]}}, ConfigurationError, "observation: terms"),
        ({"action": {"serves": {"Forag": ["patrol"]}}}, ConfigurationError, "serves: unknown option"),
        ({"action": {"mode": "velocity"}, "observation": {"terms": ["holds"]}}, ConfigurationError, "'holds'"),
    ],
)
def test_what_does_not_fit_is_refused(settings, error, message):
    with pytest.raises(error, match=message):
        clean_swarm_v0.parallel_env(**{"mission": FORAGING, **settings})


def test_states_of_other_tasks_are_refused():
    env = begun(clean_swarm_v0.parallel_env(FORAGING), seed=1)
    with pytest.raises(ValueError, match=r"actions\['robot_0'\]: expected 0..1, got 2"):
        env.step(dict.fromkeys(env.agents, 2))
    with pytest.raises(ValueError, match=r"^mission .Foraging.: task: expected .*MaxValue"):
        clean_swarm_v0.parallel_env({"task": "MaxValue"}).set_state(env.get_state())


def test_a_given_start_takes_the_place_of_robots_that_the_task_would_place():
    places = [[1.0 + 2.0 * k, 1.0, 0.0] for k in range(12)]
    env = begun(clean_swarm_v0.parallel_env(FORAGING), seed=1, options={"start": {"id": "own", "robots": places}})
    assert env.unwrapped.batch.worlds.physics.positions.tolist() == [place[:2] for place in places]
    with pytest.raises(ValueError, match="expected 12 robots and 0 items, got 1 and 0"):
        env.reset(options={"start": {"id": "own", "robots": places[:1]}})
