"""Teams whose models of robots follow deciders of their own."""

import numpy as np
import pytest

from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import Cleaning
from selector.documents.errors import DocumentError
from tests.selector.strategies.policies import exported

GROUPS = [{"model": "quick", "count": 3, "max_speed": 1.0}, {"model": "slow", "count": 2, "max_speed": 0.5}]
MISSION = {"base": "exploring", "robots": GROUPS}
GOAL = "AvoidCollision+ExplorationPatrol"
QUICK, SLOW = "fixed:ORCA+Patrol", "fsm:recent-finds"


def decided(text, periods=5):
    """Return the options (periods, R) of two worlds, and of which model the rows are."""
    named = decider_named(text)
    batch = Batch(MISSION, 2, observation=named.observation((*Cleaning.terms, "finds")))
    goal = DecidedGoal(batch, named.decides(GOAL))
    decider, taken, seen = named.build(goal.problem, np.zeros(batch.rows, dtype=np.int64)), [], batch.reset([1, 2])
    decider.reset(np.arange(batch.rows), 5)
    for _ in range(periods):
        taken.append(decider.decide(seen).options)
        seen = batch.step(np.zeros((batch.rows, 2), dtype=int)).observations
    assert decider.opinions().shape == (batch.rows, len(goal.problem.options))
    return np.array(taken), np.tile(np.repeat([0, 1], [3, 2]), 2)


def test_the_robots_of_each_model_do_what_their_decider_says():
    both, models = decided(f"models:slow={SLOW};quick={QUICK}")
    for own, model in ((QUICK, 0), (SLOW, 1)):
        alone, _ = decided(own)
        np.testing.assert_array_equal(both[:, models == model], alone[:, models == model])
    assert (both[:, models == 0] != both[:, models == 1][:, :1]).all()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("models:", "models:: expected models:MODEL=STRATEGY;MODEL=STRATEGY"),
        ("models:quick", "models:quick: expected models:MODEL=STRATEGY;MODEL=STRATEGY"),
        ("models:quick=fixed:ORCA;quick=fixed:Off", "expected models:MODEL=STRATEGY;MODEL=STRATEGY"),
        ("models:quick=velocity:a.zip;slow=fixed:Off", "only chooses options"),
        ("models:quick=fixed:ORCA+Patrol", "expected quick=STRATEGY; slow=STRATEGY, got strategies for quick"),
    ],
)
def test_what_does_not_fit_is_one_line(text, said):
    with pytest.raises(DocumentError, match=said.replace("+", r"\+")):
        decided(text)


def test_a_policy_sees_terms_with_the_settings_of_its_training(tmp_path):
    terms = [{"name": "cargo", "weight": 0.5}, {"name": "lidar", "rays": 4.0, "farthest": 2.0}]
    exported(tmp_path, "AvoidCollision", ("ORCA", "Off"), ("lidar_0",), observation={"terms": terms})
    text = f"policy:{tmp_path}"
    batch = Batch(MISSION, observation=decider_named(text).observation((*Cleaning.terms, "lidar", "finds")))
    assert batch.observer.names[-4:] == tuple(f"lidar_{ray}" for ray in range(4))
    expected = Batch(MISSION, observation={"terms": terms}).reset([1])
    assert np.array_equal(batch.reset([1]), expected)
    with pytest.raises(DocumentError, match="expected a policy that sees terms with their usual settings"):
        decider_named(f"models:quick={text};slow=fixed:ORCA")
