"""The picture of one world of a batch."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.drawing.canvas import GARBAGE, LEFTOVERS, SEARCHING, Canvas
from clean_swarm_env.drawing.recorded_picture import TRAILS
from clean_swarm_env.world.garbage import LYING, NOTHING
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c


def canvas_of(worlds: Worlds, world: int) -> Canvas:
    """Return the canvas of a world as it is now; the options are those of the first coordinated goal."""
    garbage, mission = worlds.garbage, worlds.mission
    rows = worlds.rows_of(world)
    rows = rows[worlds.physics.present[rows]]
    loaded = garbage.cargo[rows] != NOTHING
    lying = garbage.stage[world] == LYING
    coordinator = worlds.coordinators[0] if worlds.coordinators else None
    trail, diffusions = trail_of(worlds.minds.buffers["pheromones"], int(worlds.rows_of(world)[0]), worlds.now)
    return Canvas(
        worlds.physics.positions[rows].copy(),
        worlds.physics.headings[rows].copy(),
        width=mission.world.width,
        height=mission.world.height,
        time=float(worlds.ticks[world]) * worlds.period,
        state=f"{garbage.done[world]} of {garbage.arrived[world]} items dumped",
        radius=mission.robots.radius,
        cargo=np.where(loaded, np.where(garbage.recycled[rows] == 1, LEFTOVERS, GARBAGE), SEARCHING),
        working=worlds.team.working[rows].astype(np.bool_),
        options=coordinator.model.options if coordinator else (),
        held=coordinator.held[rows].copy() if coordinator else None,
        garbage=garbage.positions[world][lying],
        leftover=garbage.leftover[world][lying] == 1,
        stations=worlds.stations[world].copy(),
        station_kinds=mission.stations.kinds,
        station_radius=mission.stations.reach,
        pheromones=trail,
        pheromone_diffusions=diffusions,
    )


def trail_of(buffer: SoBuffer, row: int, now: float) -> tuple[Floats, Floats]:
    """Return positions (M, 2) [m] and diffusions (M,) [m] of the pheromones that a row finds at `now` [s]."""
    everything = Filter(TRAILS, moving=False, view_distance=np.inf)
    pairs = Queries(buffer).gather(now, [row], everything, without_pose=True).pairs
    slots = pairs[:, c.PAIR_SLOT].astype(np.int64)
    return buffer.table.record.near[slots][:, [c.X, c.Y]], pairs[:, c.PAIR_DIFFUSION].copy()
