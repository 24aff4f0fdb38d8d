"""Draws what `render()` returns some time into a mission, as `docs/pictures/MISSION.png`.

    python -m docs.figures.draw_world [MISSION] [SECONDS]

The mission is `table1` (whose picture is `world.png`) and the time a minute unless given.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.picture import pixels_of
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.knowledge import load_knowledge

PICTURES, MISSION, SECONDS, SEED = Path(__file__).parents[1] / "pictures", "table1", 60.0, 14
OPTION = "RepulsionGradient-view1.5"


def world_after(seconds: float, seed: int, name: str = MISSION) -> Worlds:
    """Return the world of a mission at a random start, `seconds` into it."""
    mission = load_mission(name)
    worlds = Worlds(mission, coordinators_of(mission, load_knowledge(mission.knowledge), Library()))
    worlds.reset(0, random_start(mission, seed, 0), seed)
    offered = [coordinator.model.options for coordinator in worlds.coordinators]
    worlds.hold(np.tile([options.index(OPTION) if OPTION in options else 0 for options in offered], (worlds.rows, 1)))
    for _ in range(round(seconds / worlds.period)):
        worlds.tick()
    return worlds


def main() -> None:
    """Draw and save."""
    name = sys.argv[1] if len(sys.argv) > 1 else MISSION
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else SECONDS
    file = PICTURES / ("world.png" if name == MISSION else f"{name}.png")
    Image.fromarray(pixels_of(canvas_of(world_after(seconds, SEED, name), 0))).save(file, optimize=True)


if __name__ == "__main__":
    main()
