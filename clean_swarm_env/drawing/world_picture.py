"""The picture of one world of a batch."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.drawing.canvas import GARBAGE, LEFTOVERS, SEARCHING, Canvas, no_places
from clean_swarm_env.drawing.recorded_picture import EDGE_OF_LAND, TRAILS, DrawnThing, areas_of
from clean_swarm_env.recording.sampled import things_of
from clean_swarm_env.world.cleaning.garbage import LYING, NOTHING
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c

LAND_STEP = 5.0
"""Step by which the part of open land grows that is shown [m]."""


def canvas_of(worlds: Worlds, world: int) -> Canvas:
    """Return the canvas of a world as it is now; the options are those of the first coordinated goal."""
    garbage, mission = worlds.garbage, worlds.mission
    rows_of_world = worlds.rows_of(world)
    rows = rows_of_world[worlds.physics.present[rows_of_world]]
    loaded = (garbage.cargo[rows] != NOTHING) | worlds.world.carrying[rows]
    lying = garbage.stage[world] == LYING
    coordinator = worlds.coordinators[0] if worlds.coordinators else None
    trail, diffusions = trail_of(worlds.minds.buffers["pheromones"], int(rows_of_world[0]), worlds.now)
    corner, size = shown_part(worlds, worlds.physics.positions[rows])
    width, height = size.tolist()
    things = [DrawnThing.model_validate(thing) for thing in things_of(worlds, world)]
    return Canvas(
        worlds.physics.positions[rows] - corner,
        worlds.physics.headings[rows].copy(),
        width=width,
        height=height,
        time=float(worlds.ticks[world]) * worlds.period,
        state=_state_of(worlds, world),
        radius=mission.robots.radius,
        cargo=np.where(loaded, np.where(garbage.recycled[rows] == 1, LEFTOVERS, GARBAGE), SEARCHING),
        numbers=rows - rows_of_world[0],
        working=worlds.team.working[rows].astype(np.bool_),
        options=coordinator.model.options if coordinator else (),
        held=coordinator.held[rows].copy() if coordinator else None,
        garbage=garbage.positions[world][lying],
        leftover=garbage.leftover[world][lying] == 1,
        stations=worlds.stations[world].copy(),
        station_kinds=mission.stations.kinds,
        station_radius=mission.stations.reach,
        areas=areas_of(things, corner, no_places()),
        pheromones=trail - corner,
        pheromone_diffusions=diffusions,
    )


def shown_part(worlds: Worlds, places: Floats) -> tuple[Floats, Floats]:
    """Return lower left corner (2,) and size (2,) [m] of the visible part of a world; `places` (K, 2) of its robots.

    Of open land it is a square around the middle: where robots start, and in steps what they have reached.
    """
    ground = worlds.floor.ground
    if ground.kind == "torus":
        return np.zeros(2), ground.size
    side = float(ground.size.max())
    beyond = float(np.abs(places - ground.centre).max(initial=0.0)) + EDGE_OF_LAND - 0.5 * side
    side += 2.0 * LAND_STEP * float(np.ceil(max(beyond, 0.0) / LAND_STEP))
    return ground.centre - 0.5 * side, np.full(2, side)


def trail_of(buffer: SoBuffer, row: int, now: float) -> tuple[Floats, Floats]:
    """Return positions (M, 2) [m] and diffusions (M,) [m] of the pheromones that a row finds at `now` [s]."""
    everything = Filter(TRAILS, moving=False, view_distance=np.inf)
    pairs = Queries(buffer).gather(now, [row], everything, without_pose=True).pairs
    slots = pairs[:, c.PAIR_SLOT].astype(np.int64)
    return buffer.table.record.near[slots][:, [c.X, c.Y]], pairs[:, c.PAIR_DIFFUSION].copy()


def _state_of(worlds: Worlds, world: int) -> str:
    """Return the caption of a world: items dumped, or the measures of its task."""
    if worlds.mission.cleans:
        return f"{worlds.garbage.done[world]} of {worlds.garbage.arrived[world]} items dumped"
    return ", ".join(f"{name} {values[world]:.3g}" for name, values in worlds.task.result().items())
