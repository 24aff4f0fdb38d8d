"""Contract of every task: what it declares, that it measures on both grounds, and that nothing but its seed counts.

A task of a test's own, `Shepherding`, joins: all that is said of tasks holds for those of users.
"""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import BaselineDecider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS, Measure
from selector.knowledge import load_knowledge
from tests.clean_swarm_env.courses import begun
from tests.clean_swarm_env.recording.shepherding import with_shepherding

FOURTEEN = {
    "ReachGoal", "CollectiveExploration", "FormationControl", "CircleFormation", "Foraging", "IndividualExploration",
    "FindBarycenter", "MaxValue", "UniformDistribution", "CollisionAvoidance", "AgentCollisionAvoidance",
    "ExplorationPatrol", "FollowPotentialField", "FollowMaxPotential",
}  # fmt: skip
SECONDS = 4


@pytest.fixture(autouse=True)
def _shepherding(monkeypatch):
    with_shepherding(monkeypatch)


every_task = pytest.mark.parametrize("name", [*sorted(FOURTEEN), "Shepherding"])


def batch_of(name, worlds, seconds=SECONDS, **world):
    changes = {"world": world} if world else {}
    return Batch({"task": name, "time_limit": float(seconds), **changes}, worlds, begin_anew=False)


def course(batch, seeds, led=False, steps=SECONDS):
    """Return places (T + 1, R, 2) of robots that the best option or the baseline commands, and the measures."""
    seen = batch.reset(seeds)
    decided, tracks = DecidedGoal(batch), [batch.worlds.physics.positions.copy()]
    decider = BaselineDecider(decided.problem, np.zeros(1))
    default = np.full(batch.rows, batch.choices.default[0])
    for _ in range(steps):
        actions = decided.decide(decider, seen) if led else decided.actions(default)
        for worlds in batch.ticks(actions):
            tracks.append(worlds.physics.positions.copy())
        seen = batch.end_period().observations
    return np.stack(tracks), {name: values.copy() for name, values in batch.worlds.task.result().items()}


def test_every_goal_of_the_library_has_a_task():
    assert set(load_knowledge("library").goals) == FOURTEEN
    assert set(TASKS.names()) == FOURTEEN | {"Cleaning", "Shepherding"}


@every_task
def test_a_task_says_what_it_is_and_its_name_is_a_mission_and_a_family(name):
    task = find_task(name)
    assert not all(measure.guard for measure in task.measures)
    mission = load_mission(name)
    assert (mission.name, mission.task.name) == (name, name)
    assert mission.robots.count >= task.fewest
    family = load_family(name)
    assert (family.name, family.robots) == (name, (mission.robots.count,) * 2)
    assert family.scenario(0, 0, "test").mission.task == mission.task


@pytest.mark.parametrize("ground", ["torus", "open"])
@every_task
def test_every_task_measures_on_both_grounds(name, ground):
    for led in (False, True):
        batch = batch_of(name, 2, ground=ground)
        tracks, measured = course(batch, [3, 4], led)
        assert set(measured) == {measure.name for measure in find_task(name).measures}
        for values in measured.values():
            assert values.shape == (2,)
            assert np.isfinite(values).all()
        assert np.isfinite(batch.worlds.task.cost(1, batch.worlds.task.result()))
        assert tracks.shape == (SECONDS * 5 + 1, batch.rows, 2)


@every_task
def test_mechanism_and_baseline_have_the_same_start(name):
    served, led = (course(batch_of(name, 1), [7], led, 1)[0] for led in (False, True))
    assert_array_equal(served[0], led[0])
    assert not np.array_equal(served[0], course(batch_of(name, 1), [8], True, 1)[0][0])


def test_robots_are_as_far_from_the_goal_as_the_task_says():
    batch = begun(Batch("ReachGoal", 20), list(range(20)))
    world = batch.worlds.world
    assert (world.ground.distances(world.positions, world.ground.centre) >= 8.0).all()


def test_open_land_is_wide_enough_for_the_fastest():
    tracks, _ = course(batch_of("CollectiveExploration", 1, 30, ground="open"), [0], True, 30)
    assert (np.abs(np.diff(tracks, axis=0)) < 1.0).all()  # nobody jumps across the seam


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: load_mission("ReachGaol"), r"unknown mission or task 'ReachGaol'.*did you mean 'ReachGoal'"),
        (
            lambda: load_family("crowdde"),
            r"unknown mission, family, experiment or task 'crowdde'.*did you mean 'crowded'",
        ),
        (lambda: Batch("tabl"), r"known: .*table1.*did you mean .table1."),
        (
            lambda: Batch({"task": "UniformDistribution", "robots": {"count": 1}}),
            "robots.count: expected at least 2 with the task Unif",
        ),
        (
            lambda: Batch({"task": "FormationControl", "robots": {"count": 50}}).reset([1]),
            "robots.count: expected room for 50 places",
        ),
    ],
)
def test_wrong_names_and_numbers_of_robots_are_named(call, message):
    with pytest.raises(ConfigurationError, match=message):
        call()


def test_cleaning_has_no_baseline_to_lead():
    batch = Batch("table1")
    decided = DecidedGoal(batch)
    with pytest.raises(ConfigurationError, match="baseline: the task Cleaning has none"):
        decided.check(BaselineDecider(decided.problem, np.zeros(1)))


def test_targets_are_met_from_their_better_side():
    lower, higher = (Measure("x", "-", better, 1.0, "why") for better in ("lower", "higher"))
    assert [lower.met(0.9), lower.met(1.1), higher.met(0.9), higher.met(1.1)] == [True, False, False, True]
