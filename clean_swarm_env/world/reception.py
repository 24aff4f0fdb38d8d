"""Delivery of the robots' messages, world by world: their poses, and the pheromones of the patrol.

With ideal delivery all robots of a world share one content, and nothing here is used. Otherwise every robot stores the
pheromones that it received, and keeps the last pose of each other robot for `pose_memory`. Robots sense garbage and
stations by themselves. What the mechanisms of coordinators spread always arrives. Who misses what is drawn in
`selforg.gradients.delivery` and `poses`; the settings are `config.delivery`.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from selforg.arrays import Floats
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses, PoseDelivery

LOSSES = 0xFFFFFFFD
"""Spawn key of the streams that decide which messages of a world are lost; other streams have other keys."""


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

    def delivery(self) -> Delivery:
        """Return the delivery of what robots leave behind."""
        return Delivery(self._reaches, self._losses, 0.0, self._generators) if self.own_contents else Delivery()

    def of_poses(self, poses: OwnPoses) -> PoseDelivery | None:
        """Return the delivery of `poses`; None if robots share one content."""
        return PoseDelivery(poses, self._reaches, self._losses, self._generators) if self.own_contents else None

    def begin(self, world: int, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        """Set range, losses and random draws of a world that begins anew."""
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

    @property
    def generators(self) -> list[np.random.Generator]:
        """The random draws of the rows (R,): which messages get lost."""
        return self._generators

    def of_worlds(self) -> tuple[Floats, ...]:
        """Return range and losses: arrays (W,)."""
        return self._reaches, self._losses
