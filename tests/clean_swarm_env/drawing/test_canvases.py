"""The canvas of a world has the robots, items and pheromones of the world."""

import numpy as np
import pytest

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.drawing.canvas import NOTHING as EMPTY
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from tests.clean_swarm_env.courses import course_of, mission, ticked, worlds_at_start
from tests.clean_swarm_env.recording.shepherding import with_shepherding


def test_the_picture_shows_robots_items_cargo_and_the_trail_of_its_own_world():
    worlds = worlds_at_start(mission(), [1, 2])
    loads = set()
    for _ in range(400):
        worlds.tick()
        for world in range(2):
            rows = worlds.rows_of(world)
            for row, load in zip(rows, canvas_of(worlds, world).load, strict=True):
                carries, recycled = worlds.task.garbage.cargo[row] != NOTHING, worlds.task.garbage.recycled[row]
                assert load == (int(recycled) if carries else EMPTY)
                loads.add(int(load))
    canvas = canvas_of(worlds, 1)
    assert loads == {EMPTY, 0, 1}
    assert canvas.loads == ("item", "leftovers")
    assert np.array_equal(canvas.positions, worlds.physics.positions[5:])
    lying = {sign: len(places) for sign, places, _ in canvas.signs}
    assert lying["item"] + lying["leftovers"] == (worlds.task.garbage.stage[1] == LYING).sum()
    assert len(canvas.pheromones) > 50
    assert canvas.pheromone_diffusions.max() == 1.0
    assert 0.3 < canvas.pheromone_diffusions.min() < 0.95  # evaporated once at least, and not yet gone
    assert ((canvas.pheromones >= 0.0) & (canvas.pheromones < 11.0)).all()


@pytest.mark.parametrize("task", ["FormationControl", "CircleFormation"])
def test_of_open_land_the_part_is_shown_that_robots_have_reached(task):
    config = MissionConfig.model_validate({"task": task})
    worlds = course_of(config, 1, 2).worlds
    near = canvas_of(worlds, 0)
    assert near.width == near.height == max(config.world.width, config.world.height)
    side, middle = near.width, worlds.floor.ground.centre
    for beyond, steps in ((0.0, 1), (4.0, 2), (40.0, 9)):  # the edge of the land is 2 m away, a step is 5 m
        worlds.physics.positions[0] = middle + np.array([0.5 * side + beyond, 0.0])
        canvas = canvas_of(worlds, 0)
        assert canvas.width == canvas.height == side + 10.0 * steps
        assert ((canvas.positions >= 0.0) & (canvas.positions <= canvas.width)).all()
        assert np.allclose(canvas.positions[0], 0.5 * canvas.width + np.array([0.5 * side + beyond, 0.0]))


def test_the_picture_of_a_task_shows_what_moves_and_the_measures(monkeypatch):
    with_shepherding(monkeypatch)
    config = MissionConfig.model_validate({"task": "Shepherding"})
    course = ticked(course_of(config, 1, 2), 20)
    canvas, sheep = canvas_of(course.worlds, 0), course.worlds.task.state.places[0]
    assert [area.name for area in canvas.areas] == ["ring", *["sheep"] * 4]
    assert [(area.x, area.y) for area in canvas.areas[1:]] == [tuple(place) for place in sheep.tolist()]
    assert canvas.state.startswith("sheep in the ring ")
    assert (canvas.width, canvas.height, canvas.load) == (8.0, 6.0, None)
