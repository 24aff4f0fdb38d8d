"""The floor of W worlds of N robots: bodies, drives, items, stations, and collisions.

Rows are robots, R = W * N. What robots know and decide is in `minds`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.cells import cells_along
from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive, DriveSettings
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from clean_swarm_env.world.cleaning.consequences import Consequences
from clean_swarm_env.world.cleaning.garbage import LYING, NOTHING, Garbage
from clean_swarm_env.world.ground import Ground
from clean_swarm_env.world.records import FLOOR, FloorRecord
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.commands import Commanded
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed
from selforg.elementary import directions
from selforg.space import nearest_image, shorten

SAME_PLACE = 1e-6
"""Distance below which the gradients of two items may have become one [m]; a buffer tells farther ones apart."""


class Floor:
    """The owner of all arrays of bodies, items and stations.

    Attributes:
        worlds, robots: W and N.
        extent: (2,) of each world's torus [m].
        physics: the bodies.
        drive: turns commands into speeds and turn rates.
        collisions: counts of robots that are too close to each other.
        consequences: what collisions have done to the robots.
        garbage: the items, and which robot carries which.
        stations: (W, K, 2) places of the stations [m], in the order of `StationsConfig.places`.
        packed: the record that compiled code takes.

    """

    extent: Annotated[Floats, "2", READ]
    stations: Annotated[Floats, "W K 2", KEPT]

    def __init__(self, mission: MissionConfig, worlds: int) -> None:
        world, robots, garbage = mission.world, mission.robots, mission.garbage
        self.worlds, self.robots = worlds, mission.rows
        self.ground = Ground.of(mission)
        self.extent = self.ground.extent
        width, height = self.extent.tolist()
        self.physics = Physics(
            PhysicsSettings(
                worlds=worlds,
                robots=mission.rows,
                width=width,
                height=height,
                radius=robots.radius,
                contacts=world.contacts,
                timestep=1.0 / world.physics_rate,
            )
        )
        self.drive = DifferentialDrive(
            worlds * mission.rows,
            DriveSettings(
                max_speed=robots.max_speed,
                max_turn_rate=robots.max_turn_rate,
                turn_gain=robots.turn_gain,
                turn_in_place_beyond=robots.turn_in_place_beyond,
                command_timeout=robots.command_timeout,
            ),
        )
        self.collisions = CollisionCounter(worlds, mission.rows, width, height, mission.collision_distances)
        self.consequences = Consequences(mission, worlds * mission.rows)
        self.garbage = Garbage(worlds, mission.item_rows, mission.rows)
        self._holonomic = robots.drive == "holonomic"
        places, kinds = (mission.stations.places, mission.stations.kinds) if mission.cleans else ((), ())
        self.stations = np.tile(np.reshape(places, (-1, 2)), (worlds, 1, 1))
        sight = garbage.diffusion + garbage.goal_radius + garbage.view_distance
        cells = cells_along(mission.item_rows, max(sight, garbage.at_distance, garbage.pick_distance), self.extent)
        self._substeps = mission.world.physics_steps_per_tick
        self.packed: Packed[FloorRecord] = FLOOR.pack(
            FloorRecord(
                robots=self.physics.positions,
                extent=self.extent,
                stations=self.stations,
                kinds=np.array(kinds, dtype=np.int64),
                items=self.garbage.positions,
                stage=self.garbage.stage,
                leftover=self.garbage.leftover,
                cargo=self.garbage.cargo,
                recycled=self.garbage.recycled,
                leg=self.garbage.leg,
                blind=self.garbage.blind,
                done=self.garbage.done,
                nearest=np.full(worlds * mission.rows, NOTHING, dtype=np.int64),
                picked=np.zeros((worlds * mission.rows, 2), dtype=np.int64),
                standing=self.consequences.standing,
                lying=np.zeros(mission.item_rows, dtype=np.bool_),
                cells=np.zeros(cells, dtype=np.int64),
                links=np.zeros(mission.item_rows, dtype=np.int64),
                sight=sight,
                at_item=garbage.at_distance,
                at_station=mission.stations.reach,
                pick_distance=garbage.pick_distance,
            )
        )

    def rows_of(self, world: int) -> Ints:
        """Return the rows (N,) of the robots of a world."""
        return np.arange(world * self.robots, (world + 1) * self.robots)

    def reset(self, world: int, mission: MissionConfig, items: Floats) -> None:
        """Put stations and items (M, 2) [m] of a world in place, and set its collision counts to 0."""
        if mission.cleans:
            self.stations[world] = mission.stations.places
        self.garbage.place(world, items % self.extent)
        self.collisions.reset(world)

    def picked(self, count: int) -> tuple[Ints, Floats]:
        """Return worlds (K,) and places (K, 2) [m] of the first `count` items picked in this tick."""
        rows, items = self.packed.record.picked[:count].T
        worlds = rows // self.robots
        return worlds, self.garbage.positions[worlds, items]

    def left_at(self, worlds: Ints, places: Floats) -> tuple[Ints, Floats]:
        """Return worlds (K,) and places (K, 2) [m] of the items that lie where others were: `worlds` and `places`."""
        shared: Flags = np.zeros(len(worlds), dtype=bool)  # hardly ever; all offsets of a large world fill the memory
        find_shared(worlds, places, self.garbage.positions, self.garbage.stage, self.extent, shared)
        worlds, places = worlds[shared], places[shared]
        apart = self.garbage.positions[worlds] - places[:, None]  # (P, M, 2)
        shorten(apart.reshape(-1, 2), self.extent)
        lying = self.garbage.stage[worlds] == LYING
        which, items = np.nonzero(lying & (np.abs(apart).max(axis=2) < SAME_PLACE))
        return worlds[which], self.garbage.positions[worlds[which], items]

    def move(self, commands: Packed[Commanded], now: float) -> None:
        """Move the robots by their commands for one control period, and count collisions meanwhile."""
        if self._holonomic:
            given = commands.record
            turned = given.commanded & ~given.in_place & (given.vectors != 0.0).any(axis=1)
            self.physics.headings[turned] = directions(given.vectors[turned])
        self.physics.tick(now, self._substeps, commands, self.drive, self.collisions)


@lean_kernel
def find_shared(worlds: Ints, places: Floats, positions: Floats, stages: Ints, extent: Floats, shared: Flags) -> None:
    """Set `shared` (K,) where an item lies at `places` (K, 2) of `worlds` (K,); positions (W, M, 2), stages (W, M)."""
    for place, world in enumerate(worlds):
        for item in range(positions.shape[1]):
            if stages[world, item] == LYING:
                dx = nearest_image(positions[world, item, 0] - places[place, 0], extent[0])
                if abs(dx) < SAME_PLACE:
                    dy = nearest_image(positions[world, item, 1] - places[place, 1], extent[1])
                    if abs(dy) < SAME_PLACE:
                        shared[place] = True
