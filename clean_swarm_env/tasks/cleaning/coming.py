"""Garbage that comes during a mission: at random times, or by events."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from clean_swarm_env.config.events import Event, Land, MoveSpots, MoveStations, Respawn
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import draw_places
from clean_swarm_env.config.tasks import expected_items, items_keep_coming, items_of
from clean_swarm_env.tasks.cleaning.garbage import Arrivals
from clean_swarm_env.tasks.cleaning.site import Site
from clean_swarm_env.world.agenda import own_streams
from clean_swarm_env.world.view import TaskView
from selforg.arrays import KEPT, Flags


class Coming:
    """The garbage that comes to one world.

    Attributes:
        spots: where it comes; empty: anywhere [m].
        arrivals: when it comes by itself.
        landings: random numbers for what lands.
        landing: items that have still to land.
        came: items that have come so far, also those for which there was no room.

    """

    def __init__(self, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        arriving, self.landings, _ = own_streams(seed)
        items = items_of(mission)
        self.spots = items.spots
        self.arrivals = Arrivals(arriving, items.respawn, 60.0 * mission.world.control_rate)
        self.landing, self.came = expected_items(mission) - items.count, items.count
        self._ends = not items_keep_coming(mission)

    @property
    def over(self) -> bool:
        """Whether no more garbage will come."""
        return self._ends and self.landing == 0


class Comings:
    """The garbage that comes to all worlds of a batch.

    Attributes:
        over: (W,) bool, worlds into which no more garbage will come.

    """

    over: Annotated[Flags, "W", KEPT]
    _comings: Annotated[list[Coming | None], "W", KEPT]

    def __init__(self, world: TaskView, site: Site) -> None:
        self._world, self._site = world, site
        self._comings = [None] * world.worlds
        self.over = np.zeros(world.worlds, dtype=np.bool_)

    def reset(self, number: int, seed: np.random.SeedSequence) -> None:
        """Begin a world anew; what comes depends on its mission and `seed` only."""
        coming = self._comings[number] = Coming(self._world.missions[number], seed)
        self.over[number] = coming.over

    @property
    def at_spots(self) -> Flags:
        """Where (W,) garbage comes about spots now."""
        return np.array([coming is not None and len(coming.spots) > 0 for coming in self._comings])

    def came(self, number: int) -> int:
        """Return how many items have come into a world, those without room included: whatever robots do."""
        coming = self._comings[number]
        return coming.came if coming is not None else 0

    def come(self, number: int, tick: int) -> int:
        """Let the items come that arrive up to a tick; return the tick of the next one."""
        coming = self._comings[number]
        assert coming is not None  # the world has been reset
        for places in coming.arrivals.until(tick, coming.spots, self._world.missions[number]):
            coming.came += self._site.land(number, places)
        return coming.arrivals.due

    def happen(self, number: int, event: Event) -> None:
        """Let an event of cleaning happen in a world."""
        coming = self._comings[number]
        assert coming is not None  # the world has been reset
        if isinstance(event, Land):
            mission = self._world.missions[number]
            places = draw_places(event.items, coming.landings, mission, coming.spots)
            coming.came += self._site.land(number, places)
            coming.landing -= event.items
            self.over[number] = coming.over
        elif isinstance(event, Respawn):
            coming.arrivals.set_rate(event.rate, int(self._world.ticks[number]))
        elif isinstance(event, MoveSpots):
            coming.spots = event.spots
        elif isinstance(event, MoveStations):
            self._site.put_stations(number, np.array([event.recycling, event.dump]))
