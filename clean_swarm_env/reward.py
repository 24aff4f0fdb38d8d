"""What a selector is rewarded for: the mission's cost, in parts that are named and weighted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selector.documents import Closed, Number

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class RewardConfig(Closed):
    """Weights of the reward's terms; each robot gets their sum once a decision period."""

    dumped: Number = 1.0
    """For each item dumped by the team [1/item]."""
    time: Number = -0.01
    """For each second that passed before the mission was over [1/s]."""
    collision: Number = -0.1
    """For each collision event in which the robot took part [1/event]."""


def rewards(config: RewardConfig, dumped: Ints, seconds: Floats, collisions: Ints, robots: int) -> Floats:
    """Return the reward (R,) of `dumped` (W,) items, `seconds` (W,) [s] and `collisions` (R,) events of one period."""
    team = config.dumped * dumped + config.time * seconds
    return np.repeat(team, robots) + config.collision * collisions
