"""Measures what robots spend on each other: the cost of coordination, whatever the mechanism.

A robot *coordinates* in a control period in which its avoidance runs, a mechanism bends what it wanted to do, it
touches another robot, or a collision stops it.

Shapes: W worlds of N robots, R = W * N rows.
"""

from typing import Final

import numpy as np

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.progress import avoidance_column
from selforg.arrays import Floats, Ints

BENT: Final = 0.1
"""Share of a wish that a command has to differ by to count as bent [-]."""
MEETING: Final = 1.0
"""Distance of centres within which two robots meet [m]; they touch at 0.5 m."""


class Meter:
    """Shares of a decision period, for each robot of a batch whose missions are explained.

    Attributes:
        busy: (R,) share of the period in which the robot coordinated [-].
        spent: (R,) combined cost of that: half of the share, and half of the way driven meanwhile by the longest way
            that is possible in the period [-].
        collided: (R,) share in which it touched another robot or was stopped [-].
        caused: (R,) shares in which others coordinated while it was their nearest robot, all others together [-].
        met: (R,) whether another robot came nearer than `MEETING`.

    """

    def __init__(self, batch: Batch) -> None:
        self._worlds, self._column = batch.worlds, avoidance_column(batch.worlds)
        self._ticks = round(batch.decision_period / batch.period)
        self.busy, self.spent, self.collided, self.caused = self._sums = np.zeros((4, batch.rows))
        self.met = np.zeros(batch.rows, dtype=np.bool_)

    def start_period(self) -> None:
        """Begin to measure a decision period."""
        self._sums[:], self.met[:] = 0.0, False

    def note(self) -> None:
        """Add the control period that has just been run."""
        worlds, commands = self._worlds, self._worlds.minds.commands
        bend = np.linalg.norm(commands.vectors - commands.wishes, axis=1)
        bent = bend > BENT * np.linalg.norm(commands.wishes, axis=1)
        collided = worlds.collisions.in_contact | (worlds.task.standing > 0)
        busy = collided | bent | (worlds.network.executing[:, self._column] != 0)
        nearest, gaps = self._nearest()
        speed = np.linalg.norm(worlds.physics.bodies[:, 2:], axis=1) / worlds.world.max_speed[:, 0]
        caused = np.bincount(nearest, busy, len(busy))
        self._sums += np.stack([busy, busy * (1.0 + speed) / 2.0, collided, caused]) / self._ticks
        self.met |= gaps < MEETING

    def _nearest(self) -> tuple[Ints, Floats]:
        """Return the nearest other robot (R,) of each on a torus, and its distance (R,) [m]."""
        places = self._worlds.physics.positions.reshape(self._worlds.worlds, self._worlds.robots, 2)
        ways = places[:, :, None] - places[:, None]
        ways -= self._worlds.extent * np.round(ways / self._worlds.extent)
        gaps = np.linalg.norm(ways, axis=3)
        gaps[:, np.arange(self._worlds.robots), np.arange(self._worlds.robots)] = np.inf
        firsts = self._worlds.robots * np.arange(self._worlds.worlds)[:, None]
        nearest: Ints = (gaps.argmin(axis=2) + firsts).ravel()
        return nearest, gaps.min(axis=2).ravel()
