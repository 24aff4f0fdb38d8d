"""Rounds until robots that only hear their neighbours agree on the largest value."""

import numpy as np

from clean_swarm_env.world.ground import Ground
from selforg.arrays import Flags, Floats, Ints


def in_earshot(positions: Floats, reach: float, ground: Ground) -> Flags:
    """Return (W, N, N) whether two robots at positions (W, N, 2) [m] hear each other within `reach` [m]."""
    distances = ground.distances(positions[:, :, None], positions[:, None, :])
    return (distances <= reach) & ~np.eye(positions.shape[1], dtype=np.bool_)


def connected(hears: Flags) -> bool:
    """Return whether every robot can be reached from every other; hears (N, N) is symmetric."""
    reached = np.zeros(len(hears), dtype=np.bool_)
    reached[0] = True
    for _ in range(len(hears)):
        reached |= hears[reached].any(axis=0)
    return bool(reached.all())


def rounds_needed(hears: Flags, first: int) -> int:
    """Return the fewest rounds in which a message of robot `first` reaches all others: hops to the farthest one.

    hears (N, N); N if it is not connected.
    """
    reached = np.zeros(len(hears), dtype=np.bool_)
    reached[first] = True
    for rounds in range(len(hears)):
        if reached.all():
            return rounds
        reached |= hears[reached].any(axis=0)
    return len(hears)


def rounds_by_calls(hears: Flags, values: Floats, rng: np.random.Generator, most: int) -> int:
    """Return the rounds until all know the maximum if each robot asks one random neighbour a round, at most `most`.

    hears (N, N) connected; values (N,). A robot that is asked answers what it knew before the round.
    """
    known, best = values.copy(), values.max()
    neighbours: list[Ints] = [np.flatnonzero(row) for row in hears]
    for rounds in range(most):
        if (known == best).all():
            return rounds
        known = np.maximum(known, known[np.array([rng.choice(near) for near in neighbours])])
    return most
