"""Typed configuration of the events of a mission: changes of team, garbage, stations and delivery.

An event happens at the beginning of the first control period that begins at its time or later. Events of the same time
happen in the order in which they are listed.
"""

from collections.abc import Iterator
from heapq import heapreplace
from math import inf
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.delivery import EVERYWHERE
from clean_swarm_env.config.types import ArrivalRate, Index, Items, Point, Pose, Robots, Spots
from selector.documents.errors import impossible
from selector.documents.fields import Closed, Name, Positive, Share

MOST_TIMES: Final = 100_000
"""Times that all events of a mission may happen together."""


class At(Closed):
    """The base class of events: their time."""

    at: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1e7)]
    """Time of the event in the mission [s]."""


class Again(At):
    """The base class of events that may happen again and again: phases."""

    every: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1e7)] = 0.0
    """Time after which the event happens again, until the mission ends; 0: it happens once [s]."""


class Join(At):
    """Robots join the team; their numbers follow the last one, in the order in which they join."""

    do: Literal["join"]
    """What happens."""
    robots: Robots = 1
    """Number of robots that join."""
    model: Name | Literal[""] = ""
    """Model of these robots, by its name; empty: the first of the mission."""
    places: tuple[Pose, ...] = ()
    """x [m], y [m] and heading [rad] of the first robots; the others begin at random free places."""

    @model_validator(mode="after")
    def _no_more_places_than_robots(self) -> Self:
        if len(self.places) > self.robots:
            raise impossible("places", f"at most {self.robots}, one for each robot", len(self.places))
        return self


class Remove(At):
    """Robots are taken away; their cargo lies where they were."""

    do: Literal["remove"]
    """What happens."""
    robots: Annotated[tuple[Index, ...], Field(min_length=1)]
    """Numbers of the robots, from 0."""


class Fail(At):
    """Robots fail and never recover: their bodies stay, do nothing and can be pushed; they drop their cargo."""

    do: Literal["fail"]
    """What happens."""
    robots: Annotated[tuple[Index, ...], Field(min_length=1)]
    """Numbers of the robots, from 0."""


class Land(At):
    """Garbage arrives, all at once."""

    do: Literal["land"]
    """What happens."""
    items: Annotated[Items, Field(ge=1)]
    """Number of items, about the spots of the garbage or at random places."""


class Respawn(Again):
    """The rate at which garbage keeps coming changes."""

    do: Literal["respawn"]
    """What happens."""
    rate: ArrivalRate
    """Items that arrive in a minute from now on, at random times [1/min]."""


class MoveSpots(Again):
    """The places about which garbage comes change."""

    do: Literal["move_spots"]
    """What happens."""
    spots: Spots
    """Their centres from now on; empty: garbage comes anywhere [m]."""


class MoveStations(Again):
    """The first stations of either kind move."""

    do: Literal["move_stations"]
    """What happens."""
    recycling: Point
    """Place of the recycling station from now on [m]."""
    dump: Point
    """Place of the dump station from now on [m]."""


class SetDelivery(Again):
    """The quality of the delivery of messages changes."""

    do: Literal["deliver"]
    """What happens."""
    reach: Positive = EVERYWHERE
    """Farthest receiver of a message from now on [m]."""
    loss: Share = 0.0
    """Probability that a receiver misses a message from now on [-]."""


Event = Annotated[
    Join | Remove | Fail | Land | Respawn | MoveSpots | MoveStations | SetDelivery, Field(discriminator="do")
]


def in_order(events: tuple[Event, ...]) -> list[tuple[int, Event]]:
    """Return the events in the order in which they happen, each with its place in the list."""
    return sorted(enumerate(events), key=lambda numbered: numbered[1].at)


class Calendar:
    """The events of a mission in the order in which they happen, some again and again, until a time [s].

    It holds the next time of each event only, however often they happen.
    """

    def __init__(self, events: tuple[Event, ...], until: float) -> None:
        self._events, self._until = events, until
        # A heap: next time, place in the list, and how often it has happened.
        self._next = sorted([(inf, len(events), 0), *((event.at, place, 0) for place, event in enumerate(events))])

    @property
    def at(self) -> float:
        """Time of the next one, infinity where none is left [s]."""
        return self._next[0][0]

    def pop(self) -> Event:
        """Return the next event, and go on to the one after it."""
        _, place, times = self._next[0]
        event = self._events[place]
        again = event.at + (times + 1) * event.every if isinstance(event, Again) and event.every > 0.0 else inf
        heapreplace(self._next, (again if again < self._until else inf, place, times + 1))
        return event


def happening(events: tuple[Event, ...], until: float) -> Iterator[tuple[float, Event]]:
    """Yield what happens before the time `until` [s], each with its time, in order; some events again and again."""
    calendar = Calendar(events, until)
    while calendar.at < inf:
        yield calendar.at, calendar.pop()


def join_time(events: tuple[Event, ...], robots: int, robot: int) -> float | None:
    """Return when a robot joins a team of `robots` at the start, or later if its place is not free [s]; None: never."""
    for _, event in in_order(events):
        if isinstance(event, Join):
            robots += event.robots
            if robot < robots:
                return event.at
    return None


def check_team(events: tuple[Event, ...], robots: int, fitting: int, room: str) -> None:
    """Raise the error for the first event that is impossible for a team of `robots` at the start.

    fitting: the largest number of robots for which there is room at a time, in the `room` that the message names.
    """
    working, bodies, numbers = set(range(robots)), robots, robots
    for place, event in in_order(events):
        if isinstance(event, Join):
            working |= set(range(numbers, numbers + event.robots))
            numbers, bodies = numbers + event.robots, bodies + event.robots
            if bodies > fitting:
                raise impossible(
                    f"events.{place}.robots", f"at most {fitting} solid robots {room}", f"{bodies} of them"
                )
        elif isinstance(event, Remove | Fail):
            for robot in event.robots:
                if robot not in working:
                    known = ", ".join(map(str, sorted(working)))
                    raise impossible(f"events.{place}.robots", f"robots at work then ({known})", robot)
                working.remove(robot)
            bodies -= len(event.robots) if isinstance(event, Remove) else 0
            if not working:
                raise impossible(f"events.{place}.robots", "a robot that stays at work", "none")
