"""Goals as batches: the courses of `clean-swarm run`, rewards from measures, actions, states and wrong settings."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.goals.goal_batch import GoalBatch
from clean_swarm_env.goals.settings import key_of
from clean_swarm_env.scenes import find, goals
from clean_swarm_env.scenes.served import ServedTeam, expertise
from tests.clean_swarm_env.courses import long_course

every_goal = pytest.mark.parametrize("goal", goals())


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
@every_goal
def test_the_default_option_is_the_run_of_the_command(goal):
    """Same seeds, same places tick by tick, same measures; the sum of rewards is what the measures gained."""
    kind = find(goal)
    seconds = min(kind.setting.seconds, 21.0)
    batch = GoalBatch(goal, worlds=2, seconds=seconds)
    run = kind(batch.setting, [7, 8]).run(lambda scene: ServedTeam(scene, expertise(goal)))
    batch.reset([7, 8])
    start = batch.play.scene.measured()
    total, figures = played(batch, default_of(batch), [7, 8])
    gained = np.zeros(2)
    for measure in kind.measures:
        assert [own[key_of(measure.name)] for own in figures] == run.values[measure.name].tolist()
        sign = 1.0 if measure.better == "higher" else -1.0
        gained += sign * (run.values[measure.name] - start[measure.name]) / measure.target
    assert total.reshape(2, -1) == pytest.approx(np.repeat(gained[:, None], batch.robots, axis=1))
    assert np.isfinite(total).all()


@every_goal
def test_a_world_has_the_same_course_alone_and_in_a_batch(goal):
    both, alone = GoalBatch(goal, worlds=2, seconds=3.0), GoalBatch(goal, seconds=3.0)
    both.reset([5, 6])
    alone.reset([6])
    for _ in range(2):
        beside, own = both.step(default_of(both)), alone.step(default_of(alone))
        assert np.array_equal(beside.observations[both.robots :], own.observations)
        assert np.array_equal(beside.rewards[both.robots :], own.rewards)


def test_a_zero_correction_changes_nothing_and_another_one_does():
    plain = GoalBatch("CollisionAvoidance", seconds=5.0)
    both = GoalBatch("CollisionAvoidance", seconds=5.0, action={"mode": "both"})
    still = np.column_stack((default_of(both), np.zeros((both.rows, 2))))
    total, _ = played(plain, default_of(plain), [1])
    assert np.array_equal(played(both, still, [1])[0], total)
    still[:, 1] = -0.5
    assert not np.array_equal(played(both, still, [1])[0], total)


def test_a_vector_takes_the_place_of_the_movement_and_all_else_goes_on():
    """Robots that follow what the mechanism asks for, period by period, bring food; those that stand bring none."""
    brought = []
    for speed in (0.0, 1.0):
        batch = GoalBatch("Foraging", worlds=2, action={"mode": "velocity"})
        seen = batch.reset([1, 2])
        while not batch.finished:
            seen = batch.step(speed * seen[:, :2]).observations
        brought.append([end.statistics["items_brought_per_minute"] for end in batch.finished])
    assert batch.observer.names[:2] == ("command_ahead", "command_left")
    assert brought[0] == [0.0, 0.0]
    assert min(brought[1]) > 1.0


def test_options_change_the_course():
    batch = GoalBatch("UniformDistribution", seconds=10.0)
    first, second = (played(batch, np.full(batch.rows, option), [1])[0] for option in range(2))
    assert not np.array_equal(first, second)


def test_robots_with_different_options_of_deciding_agree():
    batch = GoalBatch("MaxValue")
    _, (figures,) = played(batch, np.arange(batch.rows) % 2, [1])
    assert figures["rounds_to_agreement"] < 12 * 5


def test_weights_and_own_functions_pay():
    weights = {"items_brought_per_minute": 0.0, "collision": -2.0}
    batch = GoalBatch("Foraging", seconds=20.0, reward=weights)
    batch.reset([1])
    collided = 0.0
    for _ in range(20):
        step = batch.step(default_of(batch))
        own = np.array(batch.own_figures()["own_collisions"])
        assert np.array_equal(step.rewards, -2.0 * own)
        collided += own.sum()
    assert collided > 0
    own = GoalBatch("Foraging", reward=lambda batch: np.arange(batch.rows) * 1.0)
    own.reset([1])
    assert own.step(default_of(own)).rewards.tolist() == list(range(12))


def test_episodes_after_a_seed_are_new_ones_and_repeatable():
    batch = GoalBatch("CircleFormation", seconds=1.0)
    starts = [batch.reset([seed]).tobytes() for seed in (5, None, None, 5, None, None)]
    assert starts[:3] == starts[3:]
    assert len(set(starts)) == 3


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        ({"goal": "Foragin"}, ConfigurationError, "unknown goal 'Foragin'.*did you mean 'Foraging'"),
        ({"mission": "table1"}, ValueError, "goal: expected a mission or a goal, got both"),
        ({"family": "crowded"}, TypeError, "goal Foraging: unknown setting 'family'"),
        ({"robots": 0}, ConfigurationError, "Foraging: robots: "),
        ({"seconds": -1.0}, ConfigurationError, "Foraging: seconds: "),
        ({"ground": "moon"}, ConfigurationError, "Foraging: ground: "),
        ({"robots": 5000}, ConfigurationError, "^robots: robots: at most 4156 discs"),
        ({"reward": {"items": 1.0}}, ConfigurationError, "reward: items: "),
        ({"reward": {"collision": "x"}}, ConfigurationError, "reward: collision: "),
        ({"observation": {"terms": ["cargo"]}}, ConfigurationError, "observation: terms"),
        ({"action": {"serves": {"Foraging": ["patrol"]}}}, ConfigurationError, "action: serves: unknown key"),
        ({"action": {"mode": "velocity"}, "observation": {"terms": ["holds"]}}, ConfigurationError, "'holds'"),
    ],
)
def test_what_does_not_fit_is_refused(settings, error, message):
    with pytest.raises(error, match=message):
        clean_swarm_v0.parallel_env(**{"goal": "Foraging", **settings})


def test_scenes_have_no_starts():
    env = clean_swarm_v0.parallel_env(goal="Foraging")
    with pytest.raises(ValueError, match="start: expected none with a goal"):
        env.reset(options={"start": {"id": "own", "robots": [[1.0, 1.0, 0.0]], "items": []}})
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions\['robot_0'\]: expected 0..1, got 2"):
        env.step(dict.fromkeys(env.agents, 2))
    with pytest.raises(ValueError, match=r"^state: goal: expected MaxValue, got Foraging$"):
        clean_swarm_v0.parallel_env(goal="MaxValue").set_state(env.get_state())
