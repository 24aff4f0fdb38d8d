"""Items that robots carry: how many a mission has at its start, and how many come."""

from __future__ import annotations

from typing import Any, Final, TypeAlias, TypeVar

from clean_swarm_env.config.events import Land, Respawn
from clean_swarm_env.config.types import ArrivalRate, Items, Length, Spots
from selector.documents.fields import Closed

Mission: TypeAlias = Any
"""A `MissionConfig`, which stands above this module."""
S = TypeVar("S", bound=Closed)
RANDOM_ITEMS: Final = 40
"""Default number of rows for items in a world in which they keep coming."""


class ItemsConfig(Closed):
    """The items of a task, which starts have the places of; a setting of this kind declares them.

    Where a task has them, starts say where robots and items are, and families draw how many there are.
    """

    count: Items = 10
    """Number of items at the start."""
    respawn: ArrivalRate = 0.0
    """Items that arrive in a minute, at random times and places; above 0 a mission lasts its time limit [1/min]."""
    capacity: Items = 0
    """Most items lying or carried at a time, further ones are lost; 0: as needed, at least 40 with respawn."""
    spots: Spots = ()
    """Centres of the places about which items lie and arrive, all equally likely; empty: anywhere [m]."""
    spot_radius: Length = 1.0
    """Distance from the centre of its spot within which an item comes, evenly over the disc [m]."""


NO_ITEMS: Final = ItemsConfig(count=0)
"""Those of tasks without any."""


def items_of(mission: Mission) -> ItemsConfig:
    """Return the items of a mission."""
    return next((value for _, value in mission.task if isinstance(value, ItemsConfig)), NO_ITEMS)


def expected_items(mission: Mission) -> int:
    """Return how many items there are at the start, or land by events."""
    return items_of(mission).count + sum(event.items for event in mission.events if isinstance(event, Land))


def items_keep_coming(mission: Mission) -> bool:
    """Return whether items keep coming at some time, so that only the time limit ends the mission."""
    rates = (event.rate for event in mission.events if isinstance(event, Respawn))
    return max(items_of(mission).respawn, *rates, 0.0) > 0.0


def item_rows(mission: Mission) -> int:
    """Return for how many items a world has rows."""
    least = RANDOM_ITEMS if items_keep_coming(mission) else 0
    return items_of(mission).capacity or max(expected_items(mission), least)


def with_items(settings: S, **changes: object) -> S:
    """Return the settings of a task with other items, if it has any."""
    own = {name: value for name, value in settings if isinstance(value, ItemsConfig)}
    return settings.model_copy(update={name: value.model_copy(update=changes) for name, value in own.items()})


def rows_only(settings: S, mission: Mission) -> S:
    """Return the settings of a task without items, but with as many rows for them as its mission needs."""
    return with_items(settings, **dict(NO_ITEMS) | {"capacity": item_rows(mission)})
