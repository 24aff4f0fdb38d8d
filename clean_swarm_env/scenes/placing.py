"""Random places at the start, drawn one after the other with a least distance."""

from typing import NamedTuple

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes.ground import Ground
from selforg.arrays import Floats

PLACE_TRIES = 10_000
"""Draws for one place before the placement fails."""


class Taken(NamedTuple):
    """Places that are taken already."""

    places: Floats
    """(K, 2) [m]."""
    gap: float | Floats
    """Least distance from them [m], one or one for each (K,)."""


NOTHING_TAKEN = Taken(np.zeros((0, 2)), 0.0)


def scattered(
    rng: np.random.Generator,
    count: int,
    ground: Ground,
    apart: float,
    side: float | None = None,
    free_of: Taken = NOTHING_TAKEN,
) -> Floats:
    """Return (count, 2) uniform places [m] in a square at least `apart` [m] from each other.

    Args:
        rng: generator of the draws.
        count: number of places.
        ground: ground with its metric.
        apart: least distance between places [m].
        side: side of the square in the middle of the field [m]; the whole field unless given.
        free_of: other places, and the least distance from them.

    Raises:
        ConfigurationError: there is no room for `count` places.

    """
    side = ground.field_side if side is None else side
    corner = ground.centre - 0.5 * side
    places = np.empty((count, 2))
    for placed in range(count):
        for _ in range(PLACE_TRIES):
            place = ground.space.wrap(corner + rng.uniform(size=2) * side)
            others, things = ground.distances(place, places[:placed]), ground.distances(place, free_of.places)
            if (others >= apart).all() and (things >= free_of.gap).all():
                places[placed] = place
                break
        else:
            raise ConfigurationError(
                f"--robots: expected room for {count} places {apart:g} m apart on {side:g} m x {side:g} m, "
                f"got stuck after {placed} of them"
            )
    return places


def any_headings(rng: np.random.Generator, count: int) -> Floats:
    """Return (count,) headings [rad], all equally likely."""
    return rng.uniform(-np.pi, np.pi, size=count)
