"""Items and stations on the ground of W worlds: where they are, and the gradients by which robots sense them."""

from __future__ import annotations

from typing import Annotated, Final

import numpy as np

from clean_swarm_env.config.tasks import item_rows
from clean_swarm_env.physics.cells import cells_along
from clean_swarm_env.tasks.cleaning.consequences import Consequences
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING, Garbage
from clean_swarm_env.tasks.cleaning.records import FloorRecord
from clean_swarm_env.tasks.cleaning.settings import DUMP, RECYCLING, settings_of
from clean_swarm_env.world.view import TaskView
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed
from selforg.space import nearest_image, shorten

SAME_PLACE = 1e-6
"""Distance below which the gradients of two items may have become one [m]; a buffer tells farther ones apart."""
ITEM_CHANNEL: Final = "garbage"
"""Channel of the items."""
STATION_CHANNELS: Final = ("recycling", "dump")
"""Channels of the stations, by their kinds."""


class Site:
    """The owner of items and stations.

    Attributes:
        garbage: the items, and which robot carries which.
        stations: (W, K, 2) places of the stations [m], in the order of `StationsConfig.places`.
        kinds: (K,) kinds of the stations.
        of_kind: numbers of the stations of each kind.
        packed: the record that compiled code takes.

    """

    stations: Annotated[Floats, "W K 2", KEPT]
    kinds: Annotated[Ints, "K", READ]

    def __init__(self, world: TaskView, consequences: Consequences) -> None:
        mission, rows, extent = world.mission, world.rows, world.ground.extent
        task, count = settings_of(mission), item_rows(mission)
        config = task.garbage
        self._world = world
        self.garbage = Garbage(world.worlds, count, world.robots)
        self.stations = np.tile(np.array(task.stations.places), (world.worlds, 1, 1))
        self.kinds = np.array(task.stations.kinds, dtype=np.int64)
        self.of_kind = [np.flatnonzero(self.kinds == kind).tolist() for kind in (RECYCLING, DUMP)]
        sight = config.diffusion + config.goal_radius + config.view_distance
        own = world.of_each("sight")
        sights, room = np.where(own > 0.0, own, sight), world.of_each("carries").astype(np.int64)
        cells = cells_along(count, max(float(sights.max()), config.at_distance, config.pick_distance), extent)
        self.packed: Packed[FloorRecord] = Packed(
            FloorRecord(
                robots=world.floor.physics.positions,
                headings=world.floor.physics.headings,
                extent=extent,
                longest=world.ground.longest,
                stations=self.stations,
                kinds=self.kinds,
                items=self.garbage.positions,
                stage=self.garbage.stage,
                leftover=self.garbage.leftover,
                under=self.garbage.under,
                found=self.garbage.found,
                cargo=self.garbage.cargo,
                recycled=self.garbage.recycled,
                leg=self.garbage.leg,
                blind=self.garbage.blind,
                done=self.garbage.done,
                nearest=np.full(rows, NOTHING, dtype=np.int64),
                picked=np.zeros((rows, 2), dtype=np.int64),
                standing=consequences.standing,
                phases=np.zeros(rows, dtype=np.int64),
                in_sight=np.full(rows, NOTHING, dtype=np.int64),
                station_ways=np.zeros((rows, 2, 3)),
                nearness=np.zeros((rows, 2)),
                lying=np.zeros(count, dtype=np.bool_),
                cells=np.zeros(cells, dtype=np.int64),
                links=np.zeros(count, dtype=np.int64),
                walled=mission.world.has_walls,
                hidden=mission.world.blocks("sight"),
                sight=sights,
                found_again=max(round(config.found_again * mission.world.control_rate), 1),
                room=room,
                finders=int((room == 0).any()),
                at_item=config.at_distance,
                at_station=task.stations.reach,
                pick_distance=config.pick_distance,
            )
        )

    def show(self, world: int) -> None:
        """Show the items and stations of a world that has just been placed."""
        garbage = self.garbage
        self.show_items(world, garbage.positions[world, garbage.stage[world] == LYING])
        self.put_stations(world, np.array(settings_of(self._world.missions[world]).stations.places))

    def put_stations(self, world: int, places: Floats) -> None:
        """Put the first stations of a world at `places` (up to K, 2) [m], and show all."""
        self.stations[world, : len(places)] = places
        buffer = self._world.buffers["stations"]
        buffer.clear(world)
        for kind, channel in enumerate(STATION_CHANNELS):
            buffer.store_static(world, channel, self.stations[world][self.kinds == kind], self._world.now)

    def land(self, world: int, positions: Floats) -> int:
        """Put items at `positions` (M, 2) [m]; they are lost if there is no room for more. Return their number."""
        for position in positions:
            if self.garbage.arrive(world, position):
                self.show_items(world, position[None])
        return len(positions)

    def drop(self, rows: Ints) -> None:
        """Let the cargo of `rows` (K,) lie where the robots are."""
        for row in rows.tolist():
            place = self._world.floor.physics.positions[row]
            if self.garbage.drop(row, place):
                self.show_items(row // self._world.robots, place[None])

    def show_items(self, worlds: int | Ints, positions: Floats) -> None:
        """Store the gradients of items that lie at `positions` (M, 2) [m] of one world, or of `worlds` (M,)."""
        config = settings_of(self._world.mission).garbage
        self._world.buffers["items"].store_static(
            np.broadcast_to(worlds, len(positions)),
            ITEM_CHANNEL,
            positions,
            self._world.now,
            diffusion=config.diffusion,
            goal_radius=config.goal_radius,
        )

    def hide_items(self, worlds: Ints, places: Floats) -> None:
        """Delete the gradients of items that lay at `places` (K, 2) [m] of `worlds` (K,), unless others lie there."""
        self._world.buffers["items"].extinguish(worlds, ITEM_CHANNEL, places, self._world.now)
        others = self._left_at(worlds, places)  # their gradients were one
        if len(others[0]):
            self.show_items(*others)

    def hide_picked(self, count: int) -> None:
        """Hide the first `count` items picked in this tick."""
        if count:
            rows, items = self.packed.record.picked[:count].T
            worlds = rows // self._world.robots
            self.hide_items(worlds, self.garbage.positions[worlds, items])

    def _left_at(self, worlds: Ints, places: Floats) -> tuple[Ints, Floats]:
        """Return worlds (K,) and places (K, 2) [m] of the items that lie where others were: `worlds` and `places`."""
        garbage, extent = self.garbage, self._world.ground.extent
        shared: Flags = np.zeros(len(worlds), dtype=bool)  # hardly ever; all offsets of a large world fill the memory
        find_shared(worlds, places, garbage.positions, garbage.stage, extent, shared)
        worlds, places = worlds[shared], places[shared]
        apart = garbage.positions[worlds] - places[:, None]  # (P, M, 2)
        shorten(apart.reshape(-1, 2), extent)
        lying = garbage.stage[worlds] == LYING
        which, items = np.nonzero(lying & (np.abs(apart).max(axis=2) < SAME_PLACE))
        return worlds[which], garbage.positions[worlds[which], items]


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
