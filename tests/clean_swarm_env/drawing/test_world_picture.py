"""The canvas of a world has the robots, items and pheromones of the world."""

import numpy as np

from clean_swarm_env.drawing.canvas import GARBAGE, LEFTOVERS, SEARCHING
from clean_swarm_env.drawing.world_picture import canvas_of
from clean_swarm_env.world.garbage import LYING, NOTHING
from tests.clean_swarm_env.courses import mission, worlds_at_start


def test_the_scene_shows_robots_items_cargo_and_the_trail_of_its_own_world():
    worlds = worlds_at_start(mission(), [1, 2])
    loads = set()
    for _ in range(400):
        worlds.tick()
        for world in range(2):
            rows = worlds.rows_of(world)
            for row, load in zip(rows, canvas_of(worlds, world).cargo, strict=True):
                carries, recycled = worlds.garbage.cargo[row] != NOTHING, worlds.garbage.recycled[row]
                assert load == ((LEFTOVERS if recycled else GARBAGE) if carries else SEARCHING)
                loads.add(int(load))
    assert loads == {SEARCHING, GARBAGE, LEFTOVERS}
    canvas = canvas_of(worlds, 1)
    assert np.array_equal(canvas.positions, worlds.physics.positions[5:])
    assert len(canvas.garbage) == (worlds.garbage.stage[1] == LYING).sum()
    assert len(canvas.pheromones) > 50
    assert canvas.pheromone_diffusions.max() == 1.0
    assert 0.3 < canvas.pheromone_diffusions.min() < 0.95  # evaporated once at least, and not yet gone
    assert ((canvas.pheromones >= 0.0) & (canvas.pheromones < 11.0)).all()
