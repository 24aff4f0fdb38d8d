"""The start of one world: random places at a least distance, drawn one after the other."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.ground import Ground
from selforg.arrays import Floats

PLACE_TRIES = 10_000
"""Draws for one place before the placement fails."""


class WorldStart:
    """One world at its start, into which a task puts robots and things.

    Attributes:
        world: number of the world.
        robots: number of robots.
        ground: the ground.
        rng: generator of all draws.
        poses: (robots, 3) x [m], y [m] and heading [rad], once they are put.
        given: whether the robots were placed by whoever began the mission; `put_robots` then changes nothing.

    """

    def __init__(
        self, world: int, robots: int, ground: Ground, rng: np.random.Generator, poses: Floats | None = None
    ) -> None:
        self.world, self.robots, self.ground, self.rng = world, robots, ground, rng
        self.given = poses is not None
        self.poses: Floats = np.zeros((robots, 3)) if poses is None else poses

    @property
    def places(self) -> Floats:
        """Places (robots, 2) [m] of the robots."""
        return self.poses[:, :2]

    def put_robots(self, places: Floats, headings: Floats | None = None) -> None:
        """Put the robots at places (robots, 2) [m] with headings (robots,) [rad], any unless given."""
        if not self.given:
            turned = self.rng.uniform(-np.pi, np.pi, size=self.robots) if headings is None else headings
            self.poses[:] = np.column_stack((places, turned))

    def scattered(
        self,
        count: int,
        apart: float,
        side: float = 0.0,
        away: float = 0.0,
        *,
        free_of: Floats | None = None,
        gap: float | Floats = 0.0,
    ) -> Floats:
        """Return (count, 2) uniform places [m] at least `apart` [m] from each other.

        Args:
            count: number of places.
            apart: least distance between places [m].
            side: side of the square in the middle in which they lie; 0: the whole ground [m].
            away: least distance from the middle [m].
            free_of: other places (K, 2) [m] that stay free.
            gap: least distance from these [m], one or one for each.

        Raises:
            ConfigurationError: no room for so many places.

        """
        ground, taken = self.ground, np.zeros((0, 2)) if free_of is None else free_of
        sides = ground.size if side == 0.0 else np.full(2, side)
        places = np.empty((count, 2))
        for placed in range(count):
            for _ in range(PLACE_TRIES):
                place = ground.space.wrap(ground.centre + (self.rng.uniform(size=2) - 0.5) * sides)
                if (
                    (ground.distances(place, places[:placed]) >= apart).all()
                    and (ground.distances(place, taken) >= gap).all()
                    and float(ground.distances(place, ground.centre)) >= away
                ):
                    places[placed] = place
                    break
            else:
                raise ConfigurationError(
                    f"robots.count: expected room for {count} places {apart:g} m apart on {sides[0]:g} m x "
                    f"{sides[1]:g} m, got stuck after {placed} of them"
                )
        return places
