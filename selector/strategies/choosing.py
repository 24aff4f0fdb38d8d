"""Ways to choose one of several options: the best one, or one at random."""

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.elementary import exponentials


def best(values: Floats, allowed: Flags) -> Ints:
    """Return the allowed option (K,) of the highest value (K, O), the first of equals."""
    highest: Ints = np.where(allowed, values, -np.inf).argmax(axis=1)
    return highest


def drawn(chances: Floats, uniform: Floats) -> Ints:
    """Return options (K,) drawn with the weights `chances` (K, O) >= 0, by one number `uniform` (K,) in [0, 1) each."""
    reached = np.cumsum(chances, axis=1)
    total = reached[:, -1]
    mark = np.minimum(uniform * total, np.nextafter(total, 0.0))  # below the total: the product may be rounded up
    option: Ints = (reached > mark[:, None]).argmax(axis=1)
    return option


def even(allowed: Flags) -> Floats:
    """Return equal probabilities (K, O) of all allowed options, 0 of the others."""
    shares: Floats = allowed / allowed.sum(axis=1, keepdims=True)
    return shares


def shares(preferences: Floats) -> Floats:
    """Return probabilities (K, O) whose logarithms are `preferences` (K, O), up to a constant for each row."""
    weights = exponentials(preferences - preferences.max(axis=1, keepdims=True))
    parts: Floats = weights / weights.sum(axis=1, keepdims=True)
    return parts


def chance_of(chances: Floats, option: Ints) -> Floats:
    """Return the probability (K,) of each chosen `option` (K,) among `chances` (K, O)."""
    return np.take_along_axis(chances, option[:, None], axis=1)[:, 0]
