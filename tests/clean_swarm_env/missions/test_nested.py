"""A network inside a behaviour of the cleaning robot's document decides and acts in a mission."""

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.world.mission import Course, MissionRun
from tests.clean_swarm_env.courses import difference, mission, snapshot
from tests.paths import ROOT

WALK = {
    "mechanisms": {"walk": {"type": "Exploration"}},
    "sensors": {"carrying": "fact"},
    "behaviours": {
        "Walk": {
            "action": {"type": "Move", "mechanism": "walk"},
            "preconditions": [{"sensor": "carrying", "activator": {"type": "Boolean", "desired": False}}],
        }
    },
}


def _course(directory, **networks):
    """Return a course of robots whose patrol is done by the network `patrol`, if there is one."""
    document = yaml.safe_load((ROOT / "configs/robots/cleaning.yaml").read_text())
    document["networks"] |= networks
    if networks:
        document["networks"]["robot"]["behaviours"]["Patrol"]["network"] = "patrol"
    (directory / "robots").mkdir(parents=True)
    (directory / "robots" / "own.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
    config = mission(network={"robot": "own"})
    return Course(MissionRun(config, random_start(config, 4, 0), 4, {}, directories=(directory,)))


@pytest.fixture
def walking(tmp_path):
    return _course(tmp_path / "inner", patrol=WALK)


def _steps(course, ticks):
    steps = []
    for _ in range(ticks):
        course.tick()
        steps.append(snapshot(course.worlds, 0))
    return steps


def test_it_runs_where_its_behaviour_runs_and_moves_the_robots(walking, tmp_path):
    (nested,) = walking.worlds.minds.nested
    ran = 0
    for _ in range(60):
        walking.tick()
        running = walking.worlds.network.executing[:, nested.index] == 1
        assert np.array_equal(nested.network.executing[:, 0] == 1, running)
        ran += running.sum()
    assert ran > 20
    assert (
        walking.worlds.minds.buffers["pheromones"].count(0, "pheromone") == 0
    )  # the robots' own patrol does not run beside it
    assert difference(_steps(_course(tmp_path / "a", patrol=WALK), 40), _steps(_course(tmp_path / "b"), 40)) != ""


def test_it_begins_anew_with_its_world(walking, tmp_path):
    first = _steps(walking, 40)
    run = walking.worlds
    run.reset(0, random_start(run.mission, 4, 0), 4)
    again = []
    for _ in range(40):
        run.tick()
        again.append(snapshot(run, 0))
    assert difference(first, again) == ""
