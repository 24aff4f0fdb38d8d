"""What each world asks of delivery: ranges, losses, streams; `gradients.delivery` has the rules.

Messages are poses, and the pheromones of the patrol.

With ideal delivery all robots of a world share one content, and nothing here is used. Otherwise every robot stores the
pheromones that it received, and keeps the last pose of each other robot for `pose_memory`. Robots sense garbage and
stations by themselves. What the mechanisms of coordinators spread always arrives. Who misses what is drawn in
`selforg.gradients.delivery` and `poses`; the settings are `config.delivery`.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.errors import generators_of
from clean_swarm_env.physics.zones import write_losses
from clean_swarm_env.world.ground import walls_of, zones_of
from selforg.arrays import KEPT, READ, SCRATCH, Floats
from selforg.gradients.delivery import Delivery

LOSSES = 0xFFFFFFFD
"""Spawn key of the streams of losses in a world; other streams have other keys."""


def pose_history(mission: MissionConfig) -> int:
    """Return how many poses of each robot are kept."""
    remembered = ceil(mission.delivery.pose_memory * mission.world.control_rate - 1e-9) + mission.delay_ticks
    return max(2, 1 + remembered) if mission.own_contents else 2


class Reception:
    """Range, losses and delay of the messages in W worlds of R robots together.

    Attributes:
        reaches: (W,) range [m]; read only.
        losses: (W,) probability that a message gets lost; read only.

    """

    reaches: Annotated[Floats, "W", KEPT]
    losses: Annotated[Floats, "W", KEPT]
    _ranges: Annotated[Floats, "R", READ]  # farthest receivers of what robots spread [m]
    _generators: Annotated[list[np.random.Generator], "R", KEPT]  # which messages get lost
    _in_zones: Annotated[Floats, "R", SCRATCH]  # losses by the zones in which robots are; empty without such zones

    def __init__(self, mission: MissionConfig, worlds: int, rows: int) -> None:
        self._zones = zones_of(mission)
        self._walls = walls_of(mission) if mission.world.blocks("messages") else None
        self.in_zones = self._zones.silent
        self._in_zones = np.zeros(rows if self.in_zones else 0)
        self.own_contents, self.delay_ticks, self._delay = (
            mission.own_contents,
            mission.delay_ticks,
            mission.delivery.delay,
        )
        self.reaches = np.full(worlds, np.inf)
        self._ranges = np.tile(mission.of_each("message_range"), worlds)
        self.losses = np.zeros(worlds)
        self._generators = [np.random.default_rng(0)] * rows

    def delivery(self) -> Delivery:
        """Return the delivery of robots' deposits."""
        if not self.own_contents:
            return Delivery()
        zones, walls = self._in_zones, self._walls
        return Delivery(self.reaches, self.losses, self._delay, self._generators, self._ranges, zones, walls)

    def reset(self, world: int, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        """Set range, losses and random draws of a world that is reset."""
        if self.own_contents:
            robots = len(self._generators) // len(self.losses)
            self._generators[world * robots : (world + 1) * robots] = generators_of(seed, LOSSES, robots)
            self.set(world, mission.delivery.reach, mission.delivery.loss)

    def locate(self, positions: Floats) -> None:
        """Note in which zones robots at `positions` (R, 2) [m] are."""
        if self.in_zones:
            write_losses(positions, self._zones.corners, self._zones.losses, self._in_zones)

    def set(self, world: int, reach: float, loss: float) -> None:
        """Set the delivery of a world: messages reach robots within `reach` [m] and get lost with probability `loss`.

        Raises ValueError if the robots share one content (`delivery.own_contents`).
        """
        if not self.own_contents:
            raise ValueError("delivery: expected a mission with delivery.own_contents, got one whose robots share all")
        self.reaches[world], self.losses[world] = reach, loss
