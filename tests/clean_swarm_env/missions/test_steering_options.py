"""Options that steer: they change what the robot's behaviours command, and never take a turn among them."""

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.world.explaining import _coordinated
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.model import coordinator_models
from selector.documents.errors import DocumentError
from selector.knowledge import knowledge_from, load_knowledge
from tests.clean_swarm_env.courses import begun, ticked

SCENARIO = load_family("crowded").scenario(3, 0, "train")


def crowd(knowledge=None, option="PredictiveSteering", *, library=None, explained=False):
    """Twenty robots that all hold an option."""
    mission = SCENARIO.mission
    known = knowledge_from(knowledge) if knowledge else load_knowledge("avoidance")
    models = coordinators_of(mission, known, library or Library())
    worlds = begun(Worlds(mission, models, explained=explained), 0, SCENARIO.start, 5)
    worlds.hold(np.full(worlds.rows, models[0].options.index(option)))
    return worlds


def test_robots_that_steer_do_what_their_other_behaviours_decide_and_take_no_turn_to_avoid():
    worlds = crowd()
    index = worlds.coordinators[0].index
    for _ in range(100):
        worlds.tick()
        assert not worlds.network.executing[:, index].any()
    assert worlds.task.garbage.done[0] > 0
    worlds.hold(np.zeros(worlds.rows, dtype=np.int64))  # a repulsion again
    ticked(worlds, 50)
    assert worlds.network.executing[:, index].any()


def test_only_commands_of_robots_that_others_are_near_to_change():
    worlds, off = crowd(option="Off"), crowd(option="Off")
    for world in (worlds, off):
        ticked(world, 30)
    worlds.hold(np.full(worlds.rows, worlds.coordinators[0].model.options.index("PredictiveSteering")))
    for world in (worlds, off):
        world.tick()
    ours, theirs, places = worlds.minds.commands, off.minds.commands, worlds.minds.poses.positions
    np.testing.assert_array_equal(ours.commanded, theirs.commanded)
    same = (ours.vectors == theirs.vectors).all(axis=1)
    apart = np.hypot(*np.moveaxis((places[:, None] - places + 5.5) % 11.0 - 5.5, 2, 0)) + 99.0 * np.eye(len(places))
    assert same[apart.min(axis=1) > 2.5].all()
    assert not np.allclose(ours.vectors, theirs.vectors)


def test_an_option_that_steers_serves_alone_and_is_explained():
    options = {"goals": {AVOIDANCE: [{"configuration": "PredictiveSteering", "score": 1.0}]}}
    worlds = ticked(crowd(options, explained=True), 3)
    told = _coordinated(worlds.coordinators[0], 0)
    (behaviour,) = told.inner.behaviours
    assert (behaviour.name, behaviour.running) == ("Steer", True)


POSED = {"goals": {AVOIDANCE: [
    {"configuration": "RepulsionGradient", "score": 1.0},
    {"name": "Wide", "configuration": "Wide", "score": 0.0},
]}}  # fmt: skip


@pytest.fixture
def library(tmp_path):
    content = yaml.safe_load((Library()._paths["RepulsionGradient"]).read_text()) | {"pose": {"diffusion": 2.5}}
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "Wide.yaml").write_text(yaml.safe_dump(content))
    return Library([tmp_path])


def test_an_option_states_what_the_robot_spreads_of_itself(library):
    worlds = crowd(POSED, "RepulsionGradient", library=library)
    worlds.hold(np.ones(3, dtype=np.int64), np.array([2, 4, 6]))
    worlds.tick()
    poses = worlds.minds.poses
    assert [poses.gradient(row).diffusion for row in range(8)] == [1.0, 1.0, 2.5, 1.0, 2.5, 1.0, 2.5, 1.0]
    assert {poses.gradient(row).goal_radius for row in range(8)} == {0.5}
    state = worlds.get_state()
    worlds.hold(np.zeros(worlds.rows, dtype=np.int64))
    worlds.tick()
    assert {poses.gradient(row).reach for row in range(8)} == {1.5}
    worlds.set_state(state)
    worlds.tick()
    assert poses.gradient(4).reach == 3.0


def test_two_goals_cannot_both_set_the_pose(library):
    goals = {"goals": dict.fromkeys(("A", "B"), POSED["goals"][AVOIDANCE])}
    with pytest.raises(DocumentError, match="pose: expected options of one goal to set radii, got options of A, B"):
        coordinator_models(("A", "B"), knowledge_from(goals), library)
