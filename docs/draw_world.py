"""Draws the world of the README, a real mission after a minute: `python -m docs.draw_world [FILE] [SECONDS]`."""

import sys
from pathlib import Path

import numpy as np

from clean_swarm_env.config_files import load_mission
from clean_swarm_env.picture import draw_world
from clean_swarm_env.portrait import scene_of
from clean_swarm_env.robot_model import GOAL
from clean_swarm_env.starts import random_start
from clean_swarm_env.worlds import Worlds
from selector.coordinator_model import CoordinatorModel
from selector.knowledge import load_knowledge
from selector.library import Library

FILE, SECONDS, SEED = Path(__file__).with_name("pictures") / "world.png", 60.0, 14
OPTION = "RepulsionGradient"


def world_after(seconds: float, seed: int) -> Worlds:
    """Return the world of Table 1 at a random start, `seconds` into its mission."""
    mission = load_mission("table1")
    worlds = Worlds(mission, CoordinatorModel(GOAL, load_knowledge(mission.knowledge), Library()))
    worlds.reset(0, random_start(mission, seed, 0), seed)
    worlds.hold(np.full(worlds.rows, worlds.coordinator.model.options.index(OPTION)))
    for _ in range(round(seconds / worlds.period)):
        worlds.tick()
    return worlds


def main() -> None:
    """Draw and save."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else SECONDS
    worlds = world_after(seconds, SEED)
    done, items = worlds.garbage.done[0], worlds.mission.garbage.count
    title = f"{seconds:.0f} s into a mission: {done} of {items} items are dumped"
    draw_world(scene_of(worlds, 0), title).savefig(file, dpi=110)


if __name__ == "__main__":
    main()
