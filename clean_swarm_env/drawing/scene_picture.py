"""The picture of one world of a scene."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.drawing.canvas import GARBAGE, SEARCHING, Canvas
from clean_swarm_env.drawing.recorded_picture import EDGE_OF_LAND, DrawnThing, areas_of
from clean_swarm_env.drawing.world_picture import trail_of
from clean_swarm_env.recording.scene_recording import CARRYING, things_of
from clean_swarm_env.scenes.scene import Scene
from clean_swarm_env.scenes.served import ServedTeam
from selforg.arrays import Floats

LAND_STEP = 5.0
"""Step by which the part of open land grows that is shown [m]."""


def scene_canvas(scene: Scene, team: ServedTeam, world: int) -> Canvas:
    """Return the canvas of a world as it is now; of open land the field, and around it what robots have reached."""
    arena = scene.arena
    rows = np.arange(world * arena.robots, (world + 1) * arena.robots)
    corner, side = shown_part(scene, arena.positions[rows])
    loads = CARRYING in team.memory.kinds
    trail, diffusions = trail_of(team.buffers["pheromones"], int(rows[0]), arena.now)
    return Canvas(
        arena.positions[rows] - corner,
        arena.headings[rows].copy(),
        width=side,
        height=side,
        time=arena.now,
        state=", ".join(f"{name} {values[world]:.3g}" for name, values in scene.measured().items()),
        radius=scene.body.radius,
        cargo=np.where(team.memory[CARRYING].values[rows] == 1.0, GARBAGE, SEARCHING) if loads else None,
        options=team.options,
        held=team.held[rows].copy(),
        areas=areas_of([DrawnThing.model_validate(thing) for thing in things_of(scene, world)], corner),
        pheromones=trail - corner,
        pheromone_diffusions=diffusions,
    )


def shown_part(scene: Scene, places: Floats) -> tuple[Floats, float]:
    """Return lower left corner (2,) [m] and side [m] of the square that is shown; `places` (N, 2) of robots."""
    ground = scene.ground
    if ground.kind == "torus":
        return np.zeros(2), ground.side
    beyond = np.abs(places - ground.centre).max() + EDGE_OF_LAND - 0.5 * ground.field_side
    margin = LAND_STEP * np.ceil(max(beyond, 0.0) / LAND_STEP)
    return np.full(2, ground.corner - margin), ground.field_side + 2.0 * float(margin)
