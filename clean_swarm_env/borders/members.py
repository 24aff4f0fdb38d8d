"""Members of a vectorised environment: rows of a batch that are one environment together, for `get_attr` and `call`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.borders.spaces import action_space, observation_space
from clean_swarm_env.learning.batch import Batch


class Member:
    """One environment of a vectorised environment.

    Attributes:
        batch: the batch of its world.
        world: number of its world, over all batches.
        robot: number of its first robot within the world.

    """

    spec = None
    render_mode = None

    def __init__(self, batch: Batch, world: int, rows: slice) -> None:
        """Make the environment of the `rows` of a batch that belong to one world."""
        self.world, self.robot = world, rows.start % batch.robots
        self._batch, self._rows = batch, rows

    @property
    def batch(self) -> Batch:
        """The batch of the world."""
        return self._batch

    @property
    def options(self) -> dict[str, tuple[str, ...]]:
        """Coordinated goal -> names of its options."""
        return dict(self._batch.options)

    @property
    def observation_space(self) -> gymnasium.spaces.Box:
        """Space of the observations."""
        return observation_space(self._batch, self._rows.stop - self._rows.start)

    @property
    def action_space(self) -> gymnasium.Space[Any]:
        """Space of the actions."""
        return action_space(self._batch, self._rows.stop - self._rows.start)

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which options of all goals and robots, one after the other, can serve next (for sb3-contrib)."""
        return self._batch.masks()[self._rows].ravel()
