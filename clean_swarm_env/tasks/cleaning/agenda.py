"""Events of cleaning missions, and the items that arrive.

Both depend only on the seed of the world, not on what robots do: all options that are compared get the same.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Final

import numpy as np

from clean_swarm_env.config.events import Calendar, Event, Fail, Join, Land, MoveSpots, MoveStations, Remove, Respawn
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.tasks.cleaning.draws import Places
from clean_swarm_env.tasks.cleaning.garbage import NO_TICK, Arrivals
from clean_swarm_env.tasks.cleaning.settings import settings_of
from clean_swarm_env.tasks.cleaning.site import Site
from clean_swarm_env.world.team_changes import Place, Team
from clean_swarm_env.world.view import World
from selforg.arrays import KEPT, Flags, Ints, derived

OWN_STREAMS: Final = 0xFFFFFFFF
"""Spawn key of the streams of a world; the keys of its robots' streams are their numbers."""
TOLERANCE: Final = 1e-9
"""Share of a tick by which times of events may be rounded."""


class Agenda:
    """The events to come in one world.

    A robot that is to join waits until its place is free, and the events listed after it wait, too.

    Attributes:
        due: tick at which something happens next; call `run` then.
        came: items that have come so far, also those for which there was no room.

    """

    def __init__(self, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        streams = np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, OWN_STREAMS)).spawn(3)
        arriving, self._landings, self._places = (np.random.default_rng(stream) for stream in streams)
        per_tick = mission.world.control_rate
        self._garbage = Places.of(mission)
        self._arrivals = Arrivals(arriving, settings_of(mission).garbage.respawn, 60.0 * per_tick)
        self._per_tick, self._calendar = per_tick, Calendar(mission.events, mission.time_limit)
        self._joining: list[Place | None] = []
        items = mission.items
        self._landing = items.expected - items.first
        self.came = items.first
        self._ends = not items.keep_coming
        self._find_due(0)

    def run(self, number: int, world: World, site: Site) -> None:
        """Apply the events due in the world of a `number`."""
        tick = int(world.ticks[number])
        for places in self._arrivals.until(tick, self._garbage, world.missions[number]):
            self.came += site.land(number, places)
        while (not self._joining or self._let_join(number, world.team)) and self._next_tick <= tick:
            self._apply(self._calendar.pop(), number, world, site)
        self._find_due(tick)

    @property
    def at_spots(self) -> bool:
        """Whether garbage comes about spots now."""
        return len(self._garbage.spots) > 0

    @property
    def over(self) -> bool:
        """Whether no more garbage will come."""
        return self._ends and self._landing == 0

    @property
    def _next_tick(self) -> int:
        return ceil(min(self._calendar.at * self._per_tick - TOLERANCE, NO_TICK))

    def _find_due(self, tick: int) -> None:
        self.due = tick + 1 if self._joining else min(self._next_tick, self._arrivals.due)

    def _let_join(self, world: int, team: Team) -> bool:
        """Add the robots that wait to the team; return whether none has to wait longer."""
        while self._joining:
            place = self._joining[0] or team.free_place(world, self._places)
            if place is None or not team.is_free(team.next_row(world), np.array(place[:2])):
                return False
            self._joining.pop(0)
            team.add(world, place)
        return True

    def _apply(self, event: Event, number: int, world: World, site: Site) -> None:
        team, first = world.team, number * world.robots
        if isinstance(event, Join):
            self._joining += [*event.places, *[None] * (event.robots - len(event.places))]
        elif isinstance(event, Remove | Fail):
            rows = first + np.array(event.robots)
            rows = rows[team.working[rows]]  # a person may have taken some away
            if len(rows):
                (team.remove if isinstance(event, Remove) else team.fail)(rows)
        elif isinstance(event, Land):
            self.came += site.land(number, self._garbage.draw(event.items, self._landings, world.missions[number]))
            self._landing -= event.items
        elif isinstance(event, Respawn):
            self._arrivals.set_rate(event.rate, int(world.ticks[number]))
        elif isinstance(event, MoveSpots):
            self._garbage = self._garbage.at(event.spots)
        elif isinstance(event, MoveStations):
            site.put_stations(number, np.array([event.recycling, event.dump]))
        else:
            world.minds.reception.set(number, event.reach, event.loss)


class Agendas:
    """The agendas of all worlds of a batch.

    Attributes:
        over: (W,) bool, worlds into which no more garbage will come.

    """

    over: Annotated[Flags, "W", KEPT]
    _agendas: Annotated[list[Agenda | None], "W", KEPT]
    _due: Annotated[Ints, "1", derived(0)]  # tick of the batch at which something happens next in any world

    def __init__(self, world: World, site: Site) -> None:
        self._world, self._site = world, site
        self._agendas = [None] * world.worlds
        self._due = np.array([NO_TICK])
        self.over = np.zeros(world.worlds, dtype=np.bool_)

    def reset(self, number: int, seed: np.random.SeedSequence) -> None:
        """Begin a world anew; its agenda depends on its mission and `seed` only."""
        agenda = self._agendas[number] = Agenda(self._world.missions[number], seed)
        self.over[number] = agenda.over
        self._due[0] = 0

    @property
    def at_spots(self) -> Flags:
        """Where (W,) garbage comes about spots now."""
        return np.array([agenda is not None and agenda.at_spots for agenda in self._agendas])

    def came(self, number: int) -> int:
        """Return how many items have come into a world, those without room included: whatever robots do."""
        agenda = self._agendas[number]
        return agenda.came if agenda is not None else 0

    def apply_due(self) -> None:
        """Apply the events that are due at this tick in any world."""
        world = self._world
        if world.tick < self._due[0]:
            return
        due, ticks = NO_TICK, world.ticks
        for number, agenda in enumerate(self._agendas):
            if agenda is not None:
                if agenda.due <= ticks[number]:
                    agenda.run(number, world, self._site)
                    self.over[number] = agenda.over
                due = min(due, world.tick + agenda.due - int(ticks[number]))
        self._due[0] = due
