"""Events of the worlds: those of their missions, and the items that arrive.

Both depend only on the seed of the world, not on what robots do: all options that are compared get the same.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.config.events import Event, Fail, Join, Land, MoveSpots, MoveStations, Remove, Respawn, in_order
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import Places
from clean_swarm_env.physics.clock import Clock
from clean_swarm_env.world.cleaning.garbage import NO_TICK, Arrivals
from clean_swarm_env.world.floor import Floor
from clean_swarm_env.world.minds import Minds
from clean_swarm_env.world.team_changes import Place, Team
from selforg.arrays import KEPT, Flags, Floats, Ints, derived

OWN_STREAMS: Final = 0xFFFFFFFF
"""Spawn key of the streams of a world; the keys of its robots' streams are their numbers."""
TOLERANCE: Final = 1e-9
"""Share of a tick by which times of events may be rounded."""


class Affected(NamedTuple):
    """The parts of the worlds that events change."""

    floor: Floor
    minds: Minds
    team: Team
    clock: Clock

    def land(self, world: int, positions: Floats) -> int:
        """Put items at `positions` (M, 2) [m]; they are lost if there is no room for more. Return their number."""
        for position in positions:
            if self.floor.garbage.arrive(world, position):
                self.minds.show_items(world, position[None], self.clock.now)
        return len(positions)


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
        self._arrivals = Arrivals(arriving, mission.garbage.respawn, 60.0 * per_tick)
        self._events: list[tuple[int, Event]] = [
            (ceil(event.at * per_tick - TOLERANCE), event) for _, event in in_order(mission.events)
        ]
        self._joining: list[Place | None] = []
        self._landing = mission.items_expected - mission.garbage.count
        self.came = mission.garbage.count
        self._ends = not mission.continuous
        self._find_due(0)

    def run(self, world: int, affected: Affected) -> None:
        """Apply the events due in `world`."""
        tick = int(affected.clock.ticks[world])
        for places in self._arrivals.until(tick, self._garbage):
            self.came += affected.land(world, places)
        while (
            (not self._joining or self._let_join(world, affected.team)) and self._events and self._events[0][0] <= tick
        ):
            self._apply(self._events.pop(0)[1], world, affected)
        self._find_due(tick)

    @property
    def over(self) -> bool:
        """Whether no more garbage will come."""
        return self._ends and self._landing == 0

    def _find_due(self, tick: int) -> None:
        next_event = self._events[0][0] if self._events else NO_TICK
        self.due = tick + 1 if self._joining else min(next_event, self._arrivals.due)

    def _let_join(self, world: int, team: Team) -> bool:
        """Add the robots that wait to the team; return whether none has to wait longer."""
        while self._joining:
            place = self._joining[0] or team.free_place(world, self._places)
            if place is None or not team.is_free(world, np.array(place[:2])):
                return False
            self._joining.pop(0)
            team.add(world, place)
        return True

    def _apply(self, event: Event, world: int, affected: Affected) -> None:
        floor, minds, team, clock = affected
        tick, first = int(clock.ticks[world]), world * floor.robots
        if isinstance(event, Join):
            self._joining += [*event.places, *[None] * (event.robots - len(event.places))]
        elif isinstance(event, Remove | Fail):
            rows = first + np.array(event.robots)
            rows = rows[team.working[rows]]  # a person may have taken some away
            if len(rows):
                (team.remove if isinstance(event, Remove) else team.fail)(rows)
        elif isinstance(event, Land):
            self.came += affected.land(world, self._garbage.draw(event.items, self._landings))
            self._landing -= event.items
        elif isinstance(event, Respawn):
            self._arrivals.set_rate(event.rate, tick)
        elif isinstance(event, MoveSpots):
            self._garbage = self._garbage.at(event.spots)
        elif isinstance(event, MoveStations):
            floor.stations[world, :2] = event.recycling, event.dump
            minds.show_stations(world, floor.stations[world], clock.now)
        else:
            minds.reception.set(world, event.reach, event.loss)


class Agendas:
    """The agendas of all worlds of a batch.

    Attributes:
        over: (W,) bool, worlds into which no more garbage will come.

    """

    over: Annotated[Flags, "W", KEPT]
    _agendas: Annotated[list[Agenda | None], "W", KEPT]
    _due: Annotated[Ints, "1", derived(0)]  # tick of the batch at which something happens next in any world

    def __init__(self, affected: Affected) -> None:
        self._affected = affected
        self._agendas = [None] * affected.floor.worlds
        self._due = np.array([NO_TICK])
        self.over = np.zeros(affected.floor.worlds, dtype=np.bool_)

    def reset(self, world: int, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        """Reset a world; its agenda depends on `mission` and `seed` only."""
        agenda = self._agendas[world] = Agenda(mission, seed)
        self.over[world] = agenda.over
        self._due[0] = 0

    def of(self, world: int) -> Agenda | None:
        """Return the agenda of a world, None before its first reset."""
        return self._agendas[world]

    def apply_due(self) -> None:
        """Apply the events that are due at this tick in any world."""
        clock = self._affected.clock
        if clock.tick < self._due[0]:
            return
        due = NO_TICK
        for world, agenda in enumerate(self._agendas):
            if agenda is not None:
                if agenda.due <= clock.ticks[world]:
                    agenda.run(world, self._affected)
                    self.over[world] = agenda.over
                due = min(due, clock.tick + agenda.due - int(clock.ticks[world]))
        self._due[0] = due
