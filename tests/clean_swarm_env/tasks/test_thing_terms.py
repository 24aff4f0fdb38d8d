"""Terms of tasks: what robots see of things, of what mechanisms ask for, of facts, and of the task itself."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from clean_swarm_env.borders.infos import team_infos
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.tasks import TASKS, Measure, Task, TaskSettings, TaskState
from clean_swarm_env.testing import check_term


class Eastward(Task[TaskSettings, TaskState]):
    """Robots are to be in the east."""

    measures = (Measure("share in the east", "-", "higher", 0.9, "nearly all"),)
    goal = "CollectiveExploration"

    def observe(self):
        places = self.world.floor.physics.positions / self.world.ground.extent
        return {"east": places[:, 0], "place": 2.0 * places - 1.0}

    def result(self):
        return {"share in the east": (self.world.positions[..., 0] > self.world.ground.centre[0]).mean(axis=1)}


@pytest.fixture
def eastward():
    TASKS.register(Eastward)
    yield {"task": "Eastward"}
    TASKS._classes.pop("Eastward")


def seen(mission, *terms, seed=5, steps=0, **settings):
    batch = Batch(mission, observation={"terms": list(terms) or list(Task.terms)}, **settings)
    observations = batch.reset([seed])
    for _ in range(steps):
        observations = batch.step(np.tile(batch.choices.default, (batch.rows, 1))).observations
    return batch, observations.astype(np.float64)


def test_the_way_to_a_thing_is_the_one_that_the_positions_give():
    batch, observations = seen({"task": "Foraging"}, "things")
    names, worlds = batch.observer.names, batch.worlds
    nest = {part: observations[:, names.index(f"nest_{part}")] for part in ("seen", "distance", "ahead", "left")}
    offsets = worlds.floor.ground.offsets(worlds.physics.positions, worlds.floor.ground.centre)
    away = np.linalg.norm(offsets, axis=1)
    assert nest["seen"].any()
    near = nest["seen"] == 1.0
    assert_array_equal(near, away - 0.5 - 1.5 <= 2.0)
    assert_allclose(nest["distance"][near], away[near] / (0.5 * np.hypot(30.0, 30.0)), atol=1e-6)
    assert (nest["distance"][~near] == 1.0).all()
    cosine, sine = np.cos(worlds.physics.headings), np.sin(worlds.physics.headings)
    ahead = (cosine * offsets[:, 0] + sine * offsets[:, 1]) / away
    left = (cosine * offsets[:, 1] - sine * offsets[:, 0]) / away
    assert_allclose(nest["ahead"][near], ahead[near], atol=1e-6)
    assert_allclose(nest["left"][near], left[near], atol=1e-6)


def test_sight_is_a_setting_of_the_term():
    _, usual = seen({"task": "Foraging"}, "things")
    _, wide = seen({"task": "Foraging"}, {"name": "things", "sight": 30.0})
    assert wide[:, 0].sum() == 12 > usual[:, 0].sum()


def test_what_the_mechanism_asked_for_is_seen_in_the_frame_of_the_robot():
    batch, observations = seen({"task": "ReachGoal"}, "command", steps=3)
    asked = batch.worlds.task.asked
    assert_allclose(np.linalg.norm(observations, axis=1), np.minimum(np.linalg.norm(asked, axis=1), 1.0), atol=1e-6)
    assert np.abs(observations).max() > 0.3


def test_facts_are_those_that_options_know_of():
    batch, observations = seen({"task": "Foraging"}, "facts", steps=60)
    assert "carrying" in batch.observer.names
    carrying = batch.worlds.minds.memory["carrying"].values
    assert_array_equal(observations[:, batch.observer.names.index("carrying")], carrying)
    assert carrying.any()


def test_a_task_shows_what_it_wants_to_show(eastward):
    batch, observations = seen(eastward, "task")
    assert batch.observer.names == ("east", "place_0", "place_1")
    check_term(TERMS.find("task"), mission=eastward)
    assert_allclose(observations[:, 1], 2.0 * observations[:, 0] - 1.0, atol=1e-6)
    assert team_infos(batch)["share_in_the_east"][0] == (observations[:, 0] > 0.5).mean()
