"""Draws what `render()` returns a minute into a mission: `python -m docs.figures.draw_world [FILE] [SECONDS]`."""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.picture import pixels_of
from clean_swarm_env.tasks.cleaning.robot import GOAL
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge

FILE, SECONDS, SEED = Path(__file__).parents[1] / "pictures" / "world.png", 60.0, 14
OPTION = "RepulsionGradient"


def world_after(seconds: float, seed: int) -> Worlds:
    """Return the world of Table 1 at a random start, `seconds` into its mission."""
    mission = load_mission("table1")
    worlds = Worlds(mission, CoordinatorModel(GOAL, load_knowledge(mission.knowledge), Library()))
    worlds.reset(0, random_start(mission, seed, 0), seed)
    worlds.hold(np.full(worlds.rows, worlds.minds.coordinator_of(GOAL).model.options.index(OPTION)))
    for _ in range(round(seconds / worlds.period)):
        worlds.tick()
    return worlds


def main() -> None:
    """Draw and save."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else SECONDS
    Image.fromarray(pixels_of(canvas_of(world_after(seconds, SEED), 0))).save(file, optimize=True)


if __name__ == "__main__":
    main()
