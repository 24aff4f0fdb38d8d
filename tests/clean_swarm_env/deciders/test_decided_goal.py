"""Learners and deciders choose for the goal that is named, wherever it stands in the robot's document."""

from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env.deciders.decided_goal import DecidedGoal, named_goal, option_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError

BOTH = ("ExplorationPatrol", "AvoidCollision")


@pytest.fixture(scope="module")
def batch():
    return Batch("cleaning-patrol", worlds=2)


def test_a_mission_of_two_goals_is_decided_for_the_goal_that_is_named(batch):
    assert [coordinator.model.goal for coordinator in batch.worlds.coordinators] == list(BOTH)
    options = np.full(batch.rows, 2)
    for name, column in ((None, 1), ("AvoidCollision", 1), ("ExplorationPatrol", 0)):
        decided = DecidedGoal(batch, name)
        assert decided.problem.goal == BOTH[column]
        assert decided.problem.options == batch.options[BOTH[column]]
        actions = decided.actions(options)
        assert (actions[:, column] == 2).all()
        assert (actions[:, 1 - column] == batch.choices.default[1 - column]).all()


def test_avoidance_is_the_goal_unless_another_is_named():
    assert named_goal(BOTH, None) == "AvoidCollision"
    assert named_goal(BOTH, "ExplorationPatrol") == "ExplorationPatrol"
    assert named_goal(("Foraging",), None) == "Foraging"
    with pytest.raises(DocumentError, match="goal: unknown goal 'Avoid'"):
        named_goal(BOTH, "Avoid")
    with pytest.raises(DocumentError, match="goal: expected the name of one of Foraging, Patrol"):
        named_goal(("Foraging", "Patrol"), None)


def test_several_goals_are_decided_as_one(batch):
    joint = DecidedGoal(batch, "AvoidCollision+ExplorationPatrol")
    assert joint.problem.goal == "AvoidCollision+ExplorationPatrol"
    names = [f"{a}+{e}" for a in batch.options["AvoidCollision"] for e in batch.options["ExplorationPatrol"]]
    assert list(joint.problem.options) == names
    assert option_named(joint.problem, "RepulsionGradient-view1.5") == "RepulsionGradient-view1.5+Patrol"
    assert option_named(joint.problem, "RandomWalk+RepulsionGradient-view1.5") == "RepulsionGradient-view1.5+RandomWalk"
    assert names[joint.problem.scores.argmax()] == "RepulsionFernandez-view2.0+Patrol"
    options = np.arange(batch.rows) % len(names)
    goals = list(batch.options)
    for name, actions in zip(np.array(names)[options], joint.actions(options), strict=True):
        held = {goal: batch.options[goal][option] for goal, option in zip(goals, actions, strict=True)}
        assert "+".join((held["AvoidCollision"], held["ExplorationPatrol"])) == name
    with pytest.raises(DocumentError, match="expected each goal once, got AvoidCollision"):
        DecidedGoal(batch, "AvoidCollision+AvoidCollision")
    with pytest.raises(DocumentError, match="unknown option 'Patrol\\+RandomWalk'"):
        option_named(joint.problem, "Patrol+RandomWalk")


def test_what_is_thought_of_combinations_is_recorded_for_each_goal(batch, monkeypatch):
    thought = {}

    class Recorder:
        settings = RecordSettings(Path("recordings"))

        def think(self, goal, values):
            thought[goal] = values

    monkeypatch.setattr(batch, "recorder", Recorder())
    joint = DecidedGoal(batch, "AvoidCollision+ExplorationPatrol")
    opinions = np.random.default_rng(1).random((batch.rows, len(joint.problem.options)))
    joint.think(opinions)
    for place, goal in enumerate(("AvoidCollision", "ExplorationPatrol")):
        for k, option in enumerate(batch.options[goal]):
            of_option = [n for n, name in enumerate(joint.problem.options) if name.split("+")[place] == option]
            np.testing.assert_array_equal(thought[goal][:, k], opinions[:, of_option].max(axis=1))
    joint.think(opinions / opinions.sum(axis=1, keepdims=True))  # probabilities
    assert all(np.allclose(values.sum(axis=1), 1.0) for values in thought.values())
