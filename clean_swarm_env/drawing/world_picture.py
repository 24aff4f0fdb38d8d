"""The picture of one world of a batch."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray

from clean_swarm_env.drawing.picture import GARBAGE, LEFTOVERS, SEARCHING, Canvas, draw_world
from clean_swarm_env.world.garbage import LYING, NOTHING
from clean_swarm_env.world.minds import PHEROMONES
from clean_swarm_env.world.worlds import Worlds
from selforg.gradients.queries import Filter, Queries


def canvas_of(worlds: Worlds, world: int) -> Canvas:
    """Return the canvas of a world as it is now."""
    garbage, mission = worlds.garbage, worlds.mission
    rows = worlds.rows_of(world)
    rows = rows[worlds.physics.present[rows]]
    recycling, dump = (tuple(place) for place in worlds.stations[world].tolist())
    loaded = garbage.cargo[rows] != NOTHING
    cargo = np.where(loaded, np.where(garbage.recycled[rows] == 1, LEFTOVERS, GARBAGE), SEARCHING)
    trail, diffusions = _trail(worlds, world)
    return Canvas(
        worlds.physics.positions[rows].copy(),
        worlds.physics.headings[rows].copy(),
        recycling,
        dump,
        width=mission.world.width,
        height=mission.world.height,
        radius=mission.robots.radius,
        goal_radius=mission.robots.pose_goal_radius,
        diffusion=mission.robots.pose_diffusion,
        station_radius=mission.stations.reach,
        cargo=cargo,
        garbage=garbage.positions[world][garbage.stage[world] == LYING],
        pheromones=trail,
        pheromone_diffusions=diffusions,
    )


def _trail(worlds: Worlds, world: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions (M, 2) [m] and diffusions (M,) [m] of the pheromones of a world."""
    everything = Filter((PHEROMONES,), moving=False, view_distance=np.inf)
    trail = Queries(worlds.minds.pheromones).gradients(int(worlds.rows_of(world)[0]), worlds.now, everything)
    places = np.array([gradient.position for gradient in trail], dtype=np.float64).reshape(-1, 2)
    return places, np.array([gradient.diffusion for gradient in trail], dtype=np.float64)


def portrait(worlds: Worlds, world: int) -> NDArray[np.uint8]:
    """Return a picture (height, width, 3) of a world as it is now."""
    figure = draw_world(canvas_of(worlds, world), title=f"{worlds.ticks[world] * worlds.period:.0f} s")
    agg = FigureCanvasAgg(figure)
    agg.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(agg.buffer_rgba(), dtype=np.uint8)  # type: ignore[no-untyped-call]
    return pixels[:, :, :3].copy()


def show_picture(picture: NDArray[np.uint8]) -> None:
    """Show a picture in a window of Matplotlib, always the same one."""
    from matplotlib import pyplot  # waits: it looks for a display

    figure = pyplot.figure("Clean Swarm", figsize=(picture.shape[1] / 100, picture.shape[0] / 100), dpi=100)
    figure.clear()
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.axis("off")
    axes.imshow(picture)
    pyplot.pause(0.001)
