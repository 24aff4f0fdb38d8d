"""Order of a group: common direction, spacing, and the spread around a centre.

Shapes: W worlds, N robots a world. Positions (W, N, 2) [m], headings (W, N) [rad].
"""

import numpy as np

from clean_swarm_env.world.ground import Ground
from selforg.arrays import Floats
from selforg.elementary import directions, unit_vectors


def polarisation(headings: Floats) -> Floats:
    """Return the length (W,) [-] of the mean heading: 1 if all look the same way, about 1/sqrt(N) if by chance."""
    ahead, left = (part.reshape(headings.shape).mean(axis=1) for part in unit_vectors(headings.ravel()))
    length: Floats = np.sqrt(ahead * ahead + left * left)
    return length


def nearest_neighbours(positions: Floats, ground: Ground) -> Floats:
    """Return the distance (W, N) [m] of each robot to the nearest other one; infinite for a lone robot."""
    distances = ground.distances(positions[:, :, None], positions[:, None, :])
    own = np.eye(positions.shape[1], dtype=np.bool_)
    nearest: Floats = np.where(own, np.inf, distances).min(axis=2)
    return nearest


def unevenness(positions: Floats, ground: Ground) -> Floats:
    """Return the spread of the nearest-neighbour distances by their mean (W,) [-].

    0 on a lattice, 0.52 for places at random.
    """
    nearest = nearest_neighbours(positions, ground)
    spread: Floats = nearest.std(axis=1) / nearest.mean(axis=1)
    return spread


def radial_spread(positions: Floats, centre: Floats, ground: Ground) -> Floats:
    """Return the standard deviation (W,) [m] of the distances to `centre` (W, 2) or (2,): 0 on a circle."""
    spread: Floats = ground.distances(_broadcast(centre, positions), positions).std(axis=1)
    return spread


def gap_spread(positions: Floats, centre: Floats, ground: Ground) -> Floats:
    """Return the standard deviation (W,) [rad] of the angles between neighbours around `centre`: 0 if even."""
    offsets = ground.offsets(_broadcast(centre, positions), positions)
    angles = np.sort(directions(offsets.reshape(-1, 2)).reshape(offsets.shape[:-1]), axis=1)
    gaps = np.diff(angles, axis=1, append=angles[:, :1] + 2.0 * np.pi)
    spread: Floats = gaps.std(axis=1)
    return spread


def barycentre(positions: Floats, ground: Ground) -> Floats:
    """Return the mean place (W, 2) [m], around the first robot on a torus (so all must be within half of it)."""
    first = positions[:, :1]
    return ground.space.wrap(first[:, 0] + ground.offsets(np.broadcast_to(first, positions.shape), positions).mean(1))


def _broadcast(centre: Floats, positions: Floats) -> Floats:
    """Return `centre` (W, 2) or (2,) for each of positions (W, N, 2)."""
    return np.broadcast_to(centre if centre.ndim == 1 else centre[:, None], positions.shape)
