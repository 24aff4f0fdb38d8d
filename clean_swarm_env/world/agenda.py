"""The events of missions: robots that join, are taken away or fail, the delivery of messages, and those of the task.

They depend only on the seed of the world, not on what robots do: all options that are compared get the same.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.config.events import Calendar, Event, Fail, Join, Remove, SetDelivery
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.clock import Clock, Ticks, open_ticks
from clean_swarm_env.world.mission_end import NO_TICK
from clean_swarm_env.world.staged import StagedTask
from clean_swarm_env.world.team_changes import Place, Team
from clean_swarm_env.world.view import TaskView
from selforg.arrays import KEPT, READ, Ints, derived
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.program import COMING, Rows, Step

OWN_STREAMS: Final = 0xFFFFFFFF
"""Spawn key of the streams of a world; the keys of its robots' streams are their numbers."""
TOLERANCE: Final = 1e-9
"""Share of a tick by which times of events may be rounded."""


class Agenda:
    """The events to come in one world.

    A robot that is to join waits until its place is free, and the events listed after it wait, too.

    Attributes:
        due: tick at which something happens next; call `run` then.

    """

    def __init__(self, mission: MissionConfig, seed: np.random.SeedSequence) -> None:
        *_, self._places = own_streams(seed)
        self._per_tick, self._calendar = mission.world.control_rate, Calendar(mission.events, mission.time_limit)
        self._joining: list[Place | None] = []
        self.due = 0

    def run(self, number: int, world: TaskView, task: StagedTask) -> None:
        """Apply the events due in the world of a `number`."""
        tick = int(world.ticks[number])
        task.come(number, tick)
        while (not self._joining or self._let_join(number, world.team)) and self._next_tick <= tick:
            self._apply(self._calendar.pop(), number, world, task)
        comes = task.come(number, tick)  # later or sooner than before these events
        self.due = tick + 1 if self._joining else min(self._next_tick, comes)

    @property
    def _next_tick(self) -> int:
        return ceil(min(self._calendar.at * self._per_tick - TOLERANCE, NO_TICK))

    def _let_join(self, world: int, team: Team) -> bool:
        """Add the robots that wait to the team; return whether none has to wait longer."""
        while self._joining:
            place = self._joining[0] or team.free_place(world, self._places)
            if place is None or not team.is_free(team.next_row(world), np.array(place[:2])):
                return False
            self._joining.pop(0)
            team.add(world, place)
        return True

    def _apply(self, event: Event, number: int, world: TaskView, task: StagedTask) -> None:
        team, first = world.team, number * world.robots
        if isinstance(event, Join):
            self._joining += [*event.places, *[None] * (event.robots - len(event.places))]
        elif isinstance(event, Remove | Fail):
            rows = first + np.array(event.robots)
            rows = rows[team.working[rows]]  # a person may have taken some away
            if len(rows):
                (team.remove if isinstance(event, Remove) else team.fail)(rows)
        elif isinstance(event, SetDelivery):
            world.minds.reception.set(number, event.reach, event.loss)
        else:
            task.happen(number, event)


class Awaited(NamedTuple):
    """When something happens next."""

    due: Annotated[Ints, "1", READ]  # tick of the batch at which something happens next in any world


open_awaited = opening(Awaited)


class Agendas:
    """The agendas of all worlds of a batch."""

    _agendas: Annotated[list[Agenda | None], "W", KEPT]
    _due: Annotated[Ints, "1", derived(0)]  # tick of the batch at which something happens next in any world

    def __init__(self, world: TaskView, task: StagedTask, clock: Clock) -> None:
        self._world, self._task, self._clock = world, task, clock
        self._agendas = [None] * world.worlds
        self._due = np.array([NO_TICK])

    def reset(self, number: int, seed: np.random.SeedSequence) -> None:
        """Begin a world anew; its agenda depends on its mission and `seed` only."""
        self._agendas[number] = Agenda(self._world.missions[number], seed)
        self._due[0] = 0

    def coming(self) -> Step:
        """Return the step that applies the events that are due at a tick in any world."""
        records = Packed(Awaited(self._due)), self._clock.packed
        return Step(COMING, lambda now, _, due: self.apply_due(), Rows.of(self._world.every_row), is_due, records)

    def apply_due(self) -> None:
        """Apply the events that are due at this tick in any world, and note when more are."""
        world, due = self._world, NO_TICK
        ticks = world.ticks
        for number, agenda in enumerate(self._agendas):
            if agenda is not None:
                if agenda.due <= ticks[number]:
                    agenda.run(number, world, self._task)
                due = min(due, world.tick + agenda.due - int(ticks[number]))
        self._due[0] = due


@lean_kernel
def is_due(now: float, rows: Ints, awaited: Handle[Awaited], ticks: Handle[Ticks]) -> int:
    """Return 1 if something happens at this tick; a step, see `selforg.program`."""
    return int(open_ticks(ticks).ticks[0] >= open_awaited(awaited).due[0])


def own_streams(seed: np.random.SeedSequence) -> list[np.random.Generator]:
    """Return the streams of a world: of arrivals, of what lands, and of the places of robots that join."""
    streams = np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, OWN_STREAMS)).spawn(3)
    return [np.random.default_rng(stream) for stream in streams]
