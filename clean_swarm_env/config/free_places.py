"""The ground that robots can reach among the walls of a world, and the errors of walls that leave too little of it."""

import math
from functools import lru_cache
from typing import Final

import numpy as np

from clean_swarm_env.config.types import Point
from clean_swarm_env.config.world import WallConfig, WorldConfig
from selector.documents.errors import impossible
from selforg.arrays import Floats
from selforg.walls.free_ground import FreeGround
from selforg.walls.segments import NEAR, images

MAX_COVERED_SHARE = 0.45
"""Largest share of the free ground that solid discs may cover [-]; random sequential placement ends at 0.547."""
MARGIN: Final = 1.0
"""Width of the open land around the field that counts as one with it [m]."""
MOST_PIECES: Final = 2000
"""Corners of all walls of a mission, above which each start would take seconds."""
LEAST_LENGTH: Final = 1e-3
"""Least length of a piece of wall [m]."""


def check_walls(world: WorldConfig, radius: float) -> None:
    """Raise the error of the first wall that is impossible, or of walls among which robots of `radius` have no room."""
    pieces = sum(len(wall.corners) for wall in world.walls)
    if pieces > MOST_PIECES:
        raise impossible("world.walls", f"walls of at most {MOST_PIECES} corners together", pieces)
    for k, wall in enumerate(world.walls):
        for n, (x, y) in enumerate(wall.corners):
            if not (0.0 <= x <= world.width and 0.0 <= y <= world.height):
                expected = f"a point on {world.width:g} m x {world.height:g} m"
                raise impossible(f"world.walls.{k}.corners.{n}", expected, f"[{x:g}, {y:g}]")
        if wall.closed and len(wall.corners) < 3:
            expected = "at least three corners of a closed wall"
            raise impossible(f"world.walls.{k}.corners", expected, len(wall.corners))
        lengths = np.linalg.norm(wall.segments[:, 2:] - wall.segments[:, :2], axis=1)
        if lengths.min() < LEAST_LENGTH:
            expected = f"corners at least {LEAST_LENGTH:g} m from the ones before"
            raise impossible(f"world.walls.{k}.corners", expected, f"{lengths.min():g} m")
    if not world.has_walls:
        return
    free = free_ground(world, radius)
    if not len(free.sizes):
        raise impossible("world.walls", f"room for robots of radius {radius:g} m", "none")
    room = free.closed_room()
    if room is not None:
        expected = f"a door into every room, wider than a robot of radius {radius:g} m"
        raise impossible("world.walls", expected, f"none into the room about [{room[0]:.2f}, {room[1]:.2f}]")


def check_place(key: str, place: Point, world: WorldConfig, radius: float, apart: float = 0.0) -> None:
    """Raise the error of a place [m] that robots of `radius` do not reach, or nearer to a wall than `apart` [m]."""
    if not world.has_walls:
        return
    free, point = free_ground(world, radius), np.array(place)
    if free.clearance(point) < apart:
        expected = f"a place at least {apart:g} m from walls"
        raise impossible(key, expected, f"[{place[0]:g}, {place[1]:g}], {free.clearance(point):.3g} m from one")
    if not free.has(point[None])[0]:
        raise impossible(key, "a place that robots can reach among the walls", f"[{place[0]:g}, {place[1]:g}]")


def robots_that_fit(world: WorldConfig, radius: float, largest: float = 0.0) -> int:
    """Return the number of solid discs of a mean `radius` [m] for which random placement finds room.

    largest: radius of the largest of them [m], if they differ.
    """
    largest = max(radius, largest)
    if min(world.width, world.height) < 4.0 * largest:  # a disc would touch its own image across the seam
        return 0
    area = free_ground(world, largest).area if world.has_walls else world.width * world.height
    return int(MAX_COVERED_SHARE * area / (math.pi * radius**2))


def segments_of(world: WorldConfig) -> Floats:
    """Return all walls as segments (K, 4), x and y of either end [m], that around a field included."""
    corners = ((0.0, 0.0), (world.width, 0.0), (world.width, world.height), (0.0, world.height))
    around = (WallConfig(corners=corners, closed=True),) if world.ground == "walled" else ()
    return np.concatenate([np.zeros((0, 4)), *(wall.segments for wall in (*world.walls, *around))])


def images_of(world: WorldConfig, near: float = NEAR) -> Floats:
    """Return the segments (K, 4) [m], those of a torus with their images across seams within `near` [m]."""
    segments = segments_of(world)
    return images(segments, np.array([world.width, world.height]), near) if world.ground == "torus" else segments


@lru_cache(16)
def free_ground(world: WorldConfig, radius: float) -> FreeGround:
    """Return the ground that robots of `radius` [m] can reach."""
    beyond = MARGIN + 2.0 * radius if world.ground == "open" else 0.0
    low, high = np.full(2, -beyond), np.array([world.width, world.height]) + beyond
    solids = [np.array(wall.corners) for wall in world.walls if wall.closed]
    return FreeGround.among(images_of(world), solids, low, high, radius, world.ground == "torus")
