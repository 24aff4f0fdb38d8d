"""Garbage that comes to lie during a mission: in the world, and as a gradient in the buffer of items."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from clean_swarm_env.world.worlds import Worlds

Floats = NDArray[np.float64]
ITEMS = "garbage"
"""Channel of the items."""


def land(worlds: Worlds, world: int, position: Floats) -> bool:
    """Let an item come to `position` (2,) [m]; False if there is no room for more items, and it is lost."""
    arrived = worlds.garbage.arrive(world, position)
    if arrived:
        store_items(worlds, world, position[None])
    return arrived


def drop_cargo(worlds: Worlds, row: int) -> None:
    """Let what the robot of a row carries, if anything, lie where the robot is."""
    place = worlds.physics.positions[row]
    if worlds.garbage.drop(row, place):
        store_items(worlds, row // worlds.robots, place[None])


def store_items(worlds: Worlds, world: int, positions: Floats) -> None:
    """Store the gradients of items that lie at `positions` (M, 2) [m]."""
    garbage = worlds.mission.garbage
    worlds.items.store_static(
        np.full(len(positions), world), ITEMS, positions, worlds.now, diffusion=garbage.diffusion,
        goal_radius=garbage.goal_radius,
    )  # fmt: skip
