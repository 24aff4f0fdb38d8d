"""Several coordinators in a cleaning robot: the same course as without nesting, and options of their own."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import mission_begun, run_out
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.documents.errors import DocumentError
from selector.knowledge import load_knowledge
from tests.clean_swarm_env.courses import course_of, forced, snapshot


def test_a_coordinated_patrol_takes_the_course_of_a_plain_one():
    plain, coordinated = load_mission("table1"), load_mission("cleaning-patrol")
    start = random_start(plain, 5, 0)
    one, other = mission_begun(plain, start, 3), mission_begun(coordinated, start, 3)
    for _ in range(1000):
        one.tick()
        other.tick()
    parts = snapshot(other.worlds, 0)
    for name, part in snapshot(one.worlds, 0).items():
        if name not in ("inner", "held"):  # of the coordinators, of which one has one more
            assert np.array_equal(part, parts[name]), name
    assert (
        other.worlds.minds.buffers["pheromones"].count(0, "pheromone")
        == one.worlds.minds.buffers["pheromones"].count(0, "pheromone")
        > 100
    )


def test_what_robots_patrol_by_decides_the_mission():
    mission = load_mission("cleaning-patrol")
    options = ({}, {"ExplorationPatrol": "RandomWalk"}, {"ExplorationPatrol": "Patrol-period10"})
    assert len({run_out(forced(course_of(mission, 5, 1, 1), **held)).duration_s for held in options}) == 3


def test_each_coordinator_wants_an_option():
    mission = load_mission("cleaning-patrol")
    models = coordinators_of(mission, load_knowledge(mission.knowledge), Library())
    assert [model.goal for model in models] == ["ExplorationPatrol", "AvoidCollision"]
    worlds = Worlds(mission, models)
    worlds.hold(np.tile([2, 1], (5, 1)))
    assert [coordinator.held.tolist() for coordinator in worlds.coordinators] == [[2] * 5, [1] * 5]
    with pytest.raises(ValueError, match=r"one option for each of ExplorationPatrol, AvoidCollision, got shape \(5,\)"):
        worlds.hold(np.zeros(5, np.int64))
    assert worlds.minds.coordinator_of("AvoidCollision") is worlds.coordinators[1]
    assert worlds.minds.coordinator_of("ExplorationPatrol") is worlds.coordinators[0]
    with pytest.raises(DocumentError, match="unknown coordinated goal 'ExplorationPatrol'"):
        Worlds(mission, models[1:])
