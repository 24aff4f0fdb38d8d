"""Random events of a family of scenarios."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from clean_swarm_env.config.starts import nearest_distance
from clean_swarm_env.config.types import ArrivalRate, Items, Point
from selector.documents.errors import impossible
from selector.documents.fields import Closed, Positive, Share

Change = Literal["join", "remove", "fail", "land", "respawn", "move_spots", "move_stations", "deliver"]
Span = tuple[ArrivalRate, ArrivalRate]
Changes = Annotated[int, Field(strict=True, ge=0, le=1000)]
"""Events of a scenario; more of them would hardly differ in time."""
SpotCount = Annotated[int, Field(strict=True, ge=0, le=100)]
"""Spots of garbage; see `types.Spots`."""
PlaceCount = Annotated[int, Field(strict=True, ge=1, le=100)]
"""Places of the stations of a kind; see `types.FurtherStations`."""
QUIET = 0.1
"""Share of the mission at its beginning and its end in which nothing changes [-]."""
STATION_GAP = 2.0
"""Least distance of the stations from each other [m]."""


class ChangesConfig(Closed):
    """Number, kinds and sizes of the events of a scenario."""

    number: tuple[Changes, Changes] = (0, 0)
    """Least and largest number of events."""
    kinds: tuple[Change, ...] = ()
    """Kinds of events, all equally likely."""
    items: tuple[Items, Items] = (5, 5)
    """Least and largest number of items that land at a time."""
    respawn: Span = (0.0, 6.0)
    """Least and largest rate at which garbage keeps coming after a change [1/min]."""
    reach: tuple[Positive, Positive] = (2.0, 6.0)
    """Least and largest range of messages after a change of the delivery [m]."""
    loss: tuple[Share, Share] = (0.0, 0.9)
    """Least and largest probability of a loss after a change of the delivery [-]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        for name in ("number", "items", "respawn", "reach", "loss"):
            least, most = getattr(self, name)
            if least > most:
                raise impossible(name, "the least before the largest", f"[{least:g}, {most:g}]")
        if self.number[1] > 0 and not self.kinds:
            raise impossible("kinds", "at least one kind of event", "none")
        return self

    @property
    def most_joining(self) -> int:
        """Largest number of robots that can join."""
        return self.number[1] if "join" in self.kinds else 0


def draw_events(
    changes: ChangesConfig,
    size: tuple[float, float],
    robots: int,
    spots: int,
    time_limit: float,
    rng: np.random.Generator,
) -> list[dict[str, Any]]:
    """Return the events of one scenario that begins with `robots` and `spots`, in the order of their times.

    Spots that move remain as many. An event that would leave fewer than two robots becomes a join if robots may join;
    otherwise it is left out.
    """
    number = int(rng.integers(changes.number[0], changes.number[1] + 1))
    times = np.sort(rng.uniform(QUIET, 1.0 - QUIET, size=number)) * time_limit
    working, numbered = list(range(robots)), robots
    events: list[dict[str, Any]] = []
    for time in times.tolist():
        kind = changes.kinds[int(rng.integers(len(changes.kinds)))]
        if kind in ("remove", "fail") and len(working) < 3:
            if "join" not in changes.kinds:
                continue
            kind = "join"
        event: dict[str, Any] = {"at": round(time, 3), "do": kind}
        if kind == "join":
            working.append(numbered)
            numbered += 1
        elif kind in ("remove", "fail"):
            event["robots"] = (working.pop(int(rng.integers(len(working)))),)
        elif kind == "move_spots":
            event["spots"] = random_spots(spots, size, rng)
        else:
            event |= _drawn(kind, changes, size, rng)
        events.append(event)
    return events


def _drawn(kind: str, changes: ChangesConfig, size: tuple[float, float], rng: np.random.Generator) -> dict[str, Any]:
    """Return the fields of an event that does not change the team."""
    if kind == "land":
        return {"items": int(rng.integers(changes.items[0], changes.items[1] + 1))}
    if kind == "respawn":
        return {"rate": float(rng.uniform(*changes.respawn))}
    if kind == "move_stations":
        recycling, dump = random_stations(2, size, rng)
        return {"recycling": recycling, "dump": dump}
    return {"reach": float(rng.uniform(*changes.reach)), "loss": float(rng.uniform(*changes.loss))}


def random_spots(number: int, size: tuple[float, float], rng: np.random.Generator) -> tuple[Point, ...]:
    """Return the centres of spots anywhere on the torus `size` [m]."""
    return tuple((x, y) for x, y in (rng.uniform(size=(number, 2)) * size).tolist())


def random_stations(number: int, size: tuple[float, float], rng: np.random.Generator) -> tuple[Point, ...]:
    """Return places of stations on the torus `size` [m], STATION_GAP or more apart where there is room."""
    gap = min(STATION_GAP, 0.3 * min(size), 0.5 * min(size) / np.sqrt(number))
    extent = np.array(size)
    places: list[Point] = []
    while len(places) < number:
        place = rng.uniform(size=2) * extent
        if nearest_distance(place, np.array(places).reshape(-1, 2), extent) >= gap:
            places.append((float(place[0]), float(place[1])))
    return tuple(places)
