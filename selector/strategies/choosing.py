"""The two ways to take one of several options: the best, or by chance."""

import numpy as np

from selforg.arrays import Flags, Floats, Ints


def best(values: Floats, allowed: Flags) -> Ints:
    """Return the allowed option (K,) of the highest value (K, O), the first of equals."""
    highest: Ints = np.where(allowed, values, -np.inf).argmax(axis=1)
    return highest


def drawn(chances: Floats, uniform: Floats) -> Ints:
    """Return an option (K,) drawn with `chances` (K, O), 0 or more with any sum, by one number in [0, 1) each (K,)."""
    reached = np.cumsum(chances, axis=1)
    total = reached[:, -1]
    mark = np.minimum(uniform * total, np.nextafter(total, 0.0))  # below the total, even if the product is rounded up
    option: Ints = (reached > mark[:, None]).argmax(axis=1)
    return option


def even(allowed: Flags) -> Floats:
    """Return equal chances (K, O) of all allowed options, 0 of the others."""
    shares: Floats = allowed / allowed.sum(axis=1, keepdims=True)
    return shares


def chance_of(chances: Floats, option: Ints) -> Floats:
    """Return the chance (K,) that each option taken (K,) had among `chances` (K, O)."""
    taken: Floats = np.take_along_axis(chances, option[:, None], axis=1)[:, 0]
    return taken
