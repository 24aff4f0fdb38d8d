"""Contract of every task: what it declares, that it measures on both grounds, and that nothing but its seed counts.

A task of a test's own, `Gathering`, joins: all that is said of tasks holds for those of users.
"""

from typing import Annotated

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.config.task_names import task_stories
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS, Measure, Task, TaskSettings, TaskState, Things
from selector.knowledge import load_knowledge
from selforg.arrays import KEPT, Floats
from tests.clean_swarm_env.courses import begun
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import BaselineDecider

FOURTEEN = {
    "ReachGoal", "CollectiveExploration", "FormationControl", "CircleFormation", "Foraging", "IndividualExploration",
    "FindBarycenter", "MaxValue", "UniformDistribution", "CollisionAvoidance", "AgentCollisionAvoidance",
    "ExplorationPatrol", "FollowPotentialField", "FollowMaxPotential",
}  # fmt: skip
SECONDS = 4


class Rest(TaskState):
    rested: Annotated[Floats, "R", KEPT]  # [s]


class Gathering(Task[TaskSettings, Rest]):
    """Robots come together in the middle."""

    story = "4 robots come together on a torus of 100 m2"
    measures = (Measure("distance to the middle", "m", "lower", 2.5, "room for four"),)
    goal = "ReachGoal"
    mission = {"world": {"width": 10.0, "height": 10.0}, "robots": {"count": 4}, "time_limit": 20.0}  # noqa: RUF012

    def things(self):
        middle = np.broadcast_to(self.world.ground.centre, (self.world.worlds, 1, 2))
        return (Things("goal", middle, diffusion=20.0, goal_radius=0.5),)

    def after_moving(self):
        self.state.rested += self.world.period

    def result(self):
        ground = self.world.ground
        return {"distance to the middle": ground.distances(self.world.positions, ground.centre).mean(axis=1)}


@pytest.fixture(autouse=True)
def gathering(monkeypatch):
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    TASKS.register(Gathering)


every_task = pytest.mark.parametrize("name", [*sorted(FOURTEEN), "Gathering"])


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
    assert set(TASKS.names()) == FOURTEEN | {"Cleaning", "Gathering"}


def test_sources_tell_names_and_stories_of_all_tasks():
    assert task_stories() == {name: find_task(name).story for name in sorted({*FOURTEEN, "Cleaning", "Gathering"})}


@every_task
def test_a_task_says_what_it_is_and_its_name_is_a_mission_and_a_family(name):
    task = find_task(name)
    assert task.story
    assert task.baseline
    assert not all(measure.guard for measure in task.measures)
    for measure in task.measures:
        assert measure.reason, measure.name
        assert np.isfinite(measure.target)
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
        (lambda: load_family("crowdde"), r"unknown mission, family or task 'crowdde'.*did you mean 'crowded'"),
        (lambda: Batch("tabl"), r"known: .*table1.*Foraging"),
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


@pytest.mark.parametrize(
    ("part", "returned", "said"),
    [
        ("result", {}, "result: expected the measure 'distance to the middle'"),
        ("result", {"distance to the middle": np.array([np.nan])}, "result: distance to the middle: expected finite"),
        ("result", {"distance to the middle": np.zeros(3)}, r"expected shape \(1,\), got \(3,\)"),
        ("observe", {"near": np.full(4, np.nan)}, "observe: expected finite"),
        ("observe", {"near": np.zeros(3)}, r"observe: expected shape \(1, 4\), got \(1, 3\)"),
        ("things", (Things("goal", np.zeros((2, 2))),), r"things: goal: expected shape \(1, 2, 2\)"),
    ],
)
def test_what_a_task_returns_is_checked(monkeypatch, part, returned, said):
    monkeypatch.setattr(Gathering, part, lambda _: returned)
    with pytest.raises(ConfigurationError, match=said):
        clean_swarm_v0.parallel_env("Gathering").reset(seed=1)


def test_robots_are_put_at_places(monkeypatch):
    monkeypatch.setattr(Gathering, "place", lambda _, start: start.put_robots(np.full((4, 2), np.inf)))
    with pytest.raises(ConfigurationError, match="put_robots: places: expected finite numbers"):
        clean_swarm_v0.parallel_env("Gathering").reset(seed=1)


def test_a_task_of_a_tests_own_is_reached():
    _, measured = course(Batch("Gathering", 2, begin_anew=False), [0, 1], False, 20)
    assert Gathering.measures[0].met(float(measured["distance to the middle"].mean()))


def test_targets_are_met_from_their_better_side():
    lower, higher = (Measure("x", "-", better, 1.0, "why") for better in ("lower", "higher"))
    assert [lower.met(0.9), lower.met(1.1), higher.met(0.9), higher.met(1.1)] == [True, False, False, True]
