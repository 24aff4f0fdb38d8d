"""Places to start from: drawn one after the other, never on top of each other."""

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes.ground import Ground
from selforg.arrays import Floats

MAX_TRIES = 10_000
"""Draws for one place before the placement is given up."""


def scattered(
    rng: np.random.Generator, count: int, ground: Ground, apart: float, side: float | None = None,
    centre: Floats | None = None, free_of: Floats | None = None, gap: float | Floats = 0.0,
) -> Floats:  # fmt: skip
    """Return (count, 2) uniform places [m] in a square at least `apart` [m] from each other.

    Args:
        rng: where the places come from.
        count: how many.
        ground: whose metric counts.
        apart: least distance [m].
        side: of the square [m]; the whole field unless given.
        centre: of the square (2,) [m]; the field's unless given.
        free_of: places (K, 2) [m] that are taken already.
        gap: least distance from those [m], one or one for each (K,).

    Raises:
        ConfigurationError: no room for as many.

    """
    side = ground.field_side if side is None else side
    corner = (ground.centre if centre is None else centre) - 0.5 * side
    taken = np.zeros((0, 2)) if free_of is None else free_of
    places = np.empty((count, 2))
    for placed in range(count):
        for _ in range(MAX_TRIES):
            place = ground.space.wrap(corner + rng.uniform(size=2) * side)
            others, things = ground.distances(place, places[:placed]), ground.distances(place, taken)
            if (others >= apart).all() and (things >= gap).all():
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
