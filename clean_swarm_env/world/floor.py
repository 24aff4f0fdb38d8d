"""The floor of W worlds of N robots: bodies, drives and collisions.

Rows are robots, R = W * N. What robots know and decide is in `minds`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.errors import Errors
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from clean_swarm_env.physics.zones import slow_down
from clean_swarm_env.world.ground import Ground, walls_of, zones_of
from selforg.arrays import READ, Flags, Floats, Ints
from selforg.commands import Commanded
from selforg.compiler.records import Packed
from selforg.elementary import directions
from selforg.program import MOVE, Rows, Step

SLIP = 0xFFFFFFF6
"""Spawn key of the streams of slipping wheels in a world; other streams have other keys."""


class Floor:
    """The owner of all arrays of bodies.

    Attributes:
        worlds, robots: W and N.
        ground: the ground, with its metric.
        extent: (2,) of each world's torus [m].
        walls: what stops the bodies.
        physics: the bodies.
        drive: turns commands into speeds and turn rates.
        collisions: counts of robots that are too close to each other.

    """

    extent: Annotated[Floats, "2", READ]
    _holonomic: Annotated[Flags, "R", READ]

    def __init__(self, mission: MissionConfig, worlds: int) -> None:
        world = mission.world
        self.worlds, self.robots = worlds, mission.rows
        self.ground = Ground.of(mission)

        def each(key: str) -> Floats:
            return np.tile(mission.of_each(key), worlds)

        self.extent = self.ground.extent
        width, height = self.extent.tolist()
        self.walls = walls_of(mission)
        self._zones = zones_of(mission)
        self.physics = Physics(
            PhysicsSettings(
                worlds=worlds,
                robots=mission.rows,
                width=width,
                height=height,
                radius=each("radius"),
                contacts=world.contacts,
                timestep=1.0 / world.physics_rate,
            ),
            self.walls,
        )
        self.drive = DifferentialDrive(
            worlds * mission.rows,
            max_speed=each("max_speed"),
            max_turn_rate=each("max_turn_rate"),
            turn_gain=each("turn_gain"),
            turn_in_place_beyond=each("turn_in_place_beyond"),
            command_timeout=each("command_timeout"),
        )
        self._slip = Errors(SLIP, each("slip"))
        wider = each("radius") - mission.robots.models[0].radius
        self.collisions = CollisionCounter(worlds, mission.rows, width, height, mission.counted_distances, wider)
        holonomic = np.array([model.drive == "holonomic" for model in mission.robots.models])
        self._holonomic = np.tile(holonomic[mission.models], worlds)
        self._turns_at_once = bool(self._holonomic.any())
        self._substeps = mission.world.physics_steps_per_tick

    def rows_of(self, world: int) -> Ints:
        """Return the rows (N,) of the robots of a world."""
        return np.arange(world * self.robots, (world + 1) * self.robots)

    def reset(self, rows: Ints, seed: np.random.SeedSequence) -> None:
        """Restart what is random in the bodies of a world's `rows` (N,)."""
        self._slip.reset(rows, seed)

    def moving(self, commands: Packed[Commanded]) -> list[Step]:
        """Return the steps that move the robots by their commands for one control period, and count collisions."""
        rows, moving = Rows.of(np.arange(self.worlds * self.robots)), []
        if self._turns_at_once:
            moving.append(Step(MOVE, lambda now, _: self._turn_at_once(commands.record), rows))
        if self._zones.slow:
            places, fastest = self.physics.positions, self.drive.max_speed
            zones = places, fastest, self._zones.corners, self._zones.speeds
            moving.append(Step(MOVE, lambda now, _: slow_down(commands.handle, *zones), rows))
        if not self._slip.none:
            moving.append(Step(MOVE, lambda now, _: np.add(1.0, self._slip.draw(), out=self.drive.grip), rows))
        return [*moving, self.physics.ticking(self._substeps, commands, self.drive, self.collisions)]

    def _turn_at_once(self, given: Commanded) -> None:
        """Turn the robots that drive in any direction to where they go."""
        turned = self._holonomic & given.commanded & ~given.in_place & (given.vectors != 0.0).any(axis=1)
        self.physics.headings[turned] = directions(given.vectors[turned])
