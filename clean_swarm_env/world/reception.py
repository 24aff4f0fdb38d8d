"""How well the messages of the robots reach the others, world by world: their poses, and the pheromones of the patrol.

Missions with ideal delivery need none of this: all robots of a world share one content. In the others every robot has
pheromones of its own, and sees the last pose that it received from each other robot for `pose_memory`. Robots sense
garbage and stations by themselves; what the mechanisms of coordinators spread always arrives.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from selforg.arrays import Floats
from selforg.gradients.delivery import Delivery
from selforg.gradients.pose_delivery import Hearing
from selforg.gradients.poses import OwnPoses

LOSSES = 0xFFFFFFFD
"""Spawn key of the streams by which messages of a world get lost; its other streams have other keys."""


def pose_history(mission: MissionConfig) -> int:
    """Return how many poses of each robot are kept."""
    remembered = ceil(mission.delivery.pose_memory * mission.world.control_rate - 1e-9)
    return max(2, 1 + remembered) if mission.own_contents else 2


class Reception:
    """Range and losses of the messages in W worlds of R robots together."""

    def __init__(self, mission: MissionConfig, worlds: int, rows: int) -> None:
        self.own_contents = mission.own_contents
        self._reaches: Floats = np.full(worlds, np.inf)
        self._losses: Floats = np.zeros(worlds)
        self._generators = [np.random.default_rng(0)] * rows
        self._hearing: Hearing | None = None

    def delivery(self) -> Delivery:
        """Return the delivery of what robots leave behind."""
        return Delivery(self._reaches, self._losses, 0.0, self._generators) if self.own_contents else Delivery()

    def hear(self, poses: OwnPoses) -> None:
        """Decide from now on who receives the `poses`, too."""
        if self.own_contents:
            self._hearing = Hearing(poses, self._reaches, self._losses, self._generators)

    def begin(self, world: int, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        """Set range, losses and chance of a world that begins anew."""
        if self.own_contents:
            robots = len(self._generators) // len(self._losses)
            streams = np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, LOSSES)).spawn(robots)
            own = slice(world * robots, (world + 1) * robots)
            self._generators[own] = [np.random.default_rng(stream) for stream in streams]
            self.set(world, mission.delivery.reach, mission.delivery.loss)

    def set(self, world: int, reach: float, loss: float) -> None:
        """Set the delivery of a world: messages reach robots within `reach` [m] and get lost with probability `loss`.

        Raises ValueError if the robots share one content (`delivery.own_contents`).
        """
        if not self.own_contents:
            raise ValueError("delivery: expected a mission with delivery.own_contents, got one whose robots share all")
        self._reaches[world], self._losses[world] = reach, loss

    def listen(self) -> None:
        """Let robots receive the poses that have just been spread."""
        if self._hearing is not None:
            self._hearing.listen()
