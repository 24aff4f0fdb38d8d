"""Draws loops of tasks and missions: `python -m docs.figures.draw_loops [NAME ...]`, all unless named.

Writes `docs/pictures/loops/NAME.webp`, of less than 300 kB: a picture each second of a mission of seed 1, in which
each robot holds the first option of its goals. Takes some minutes.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.task_names import task_names

FOLDER = Path(__file__).parents[1] / "pictures" / "loops"
STILL = {"Cleaning", "FindBarycenter", "MaxValue"}
"""Tasks without a loop: missions show the first, and robots of the others only talk."""
MISSIONS = ("table1", "bumpers", "exploring", "scouts", "silent-zone", "three-rooms", "transport")
SEED, SIDE, MOST = 1, 320, 80
"""Seed of the mission, longer side of the pictures [pixels], most pictures."""
SHOWN = 120
"""Time that a picture is shown [ms]: about eight times as fast as the mission."""
LARGEST = 300_000
"""Most bytes of a loop."""


def draw_loop(name: str) -> Path:
    """Write the loop of a task or a mission; return its path."""
    env = clean_swarm_v0.parallel_env(name, render_mode="rgb_array", picture={"side": SIDE, "numbers": False})
    env.reset(seed=SEED)
    pictures = [env.render()]
    while env.agents and len(pictures) < MOST:
        first = {agent: np.zeros_like(env.action_space(agent).sample()) for agent in env.agents}
        env.step(first)
        pictures.append(env.render())
    images = [Image.fromarray(picture) for picture in pictures]
    path = FOLDER / f"{name}.webp"
    path.parent.mkdir(exist_ok=True)
    for quality in (60, 40, 20, 5):
        images[0].save(path, save_all=True, append_images=images[1:], duration=SHOWN, loop=0, quality=quality, method=4)
        if path.stat().st_size <= LARGEST:
            break
    return path


def main() -> None:
    """Draw those that are named, or all."""
    for name in sys.argv[1:] or (*sorted({*task_names()} - STILL), *MISSIONS):
        path = draw_loop(name)
        print(path, path.stat().st_size)


if __name__ == "__main__":
    main()
