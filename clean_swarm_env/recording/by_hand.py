"""Changes that a person makes by hand while a mission runs: what a recording holds of them, and how they are made.

A change is made at the beginning of a control period, before anybody decides. So a mission with the same changes at the
same periods has the same course, bit for bit. They are made in the first world of a batch.

A function below is a change: its name is the change's `do`, its parameters after the worlds are its further keys. It
raises ValueError, of one line, for what is impossible, and then nothing has changed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from inspect import Parameter, signature
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field, create_model

from clean_swarm_env.config.types import Index
from clean_swarm_env.tasks.cleaning.garbage import ABSENT, LYING
from clean_swarm_env.tasks.cleaning.task import Cleaning, cleaning_of
from clean_swarm_env.world.worlds import Worlds
from selector.documents.fields import Closed, Number, Share
from selforg.arrays import Floats

WORLD = 0
Item = Annotated[int, Field(strict=True, ge=0)]
"""Number of an item."""
_Text = Annotated[str, Field(strict=True, max_length=200)]


class Change(Closed):
    """The base class of changes by hand."""

    do: str
    """Its name."""
    tick: Annotated[int, Field(strict=True, ge=0)]
    """Control period at whose beginning the change is made."""

    def make(self, worlds: Worlds) -> None:
        """Change the world; ValueError, of one line, says what is impossible, and then nothing has changed."""
        given = {name: value for name, value in self if name not in Change.model_fields}
        _MAKERS[self.do](worlds, **given)


class HoldOption(Change):
    """Let robots hold an option, whatever the strategy chooses."""

    do: Literal["hold_option"]
    robots: Annotated[tuple[Index, ...], Field(max_length=10_000)] = ()
    """Numbers of the robots; all if there is none."""
    option: _Text = ""
    """Name of the option; empty: the strategy chooses again."""


class FollowStrategy(Change):
    """Let another strategy choose the options of all robots from the next decision on."""

    do: Literal["follow_strategy"]
    strategy: _Text
    """The strategy, with the digest of its file if it has one."""


_KINDS: list[type[Change]] = [HoldOption, FollowStrategy]
_MAKERS: dict[str, Callable[..., None]] = {}


def _by_hand(make: Callable[..., None]) -> Callable[..., None]:
    """Register a function as a change by hand."""
    _, *given = signature(make, eval_str=True).parameters.values()
    keys: dict[str, Any] = {"do": Literal[make.__name__]}
    keys |= {p.name: (p.annotation, ... if p.default is Parameter.empty else p.default) for p in given}
    _KINDS.append(create_model(make.__name__, __base__=Change, __doc__=make.__doc__, **keys))
    _MAKERS[make.__name__] = make
    return make


@_by_hand
def put_robot(worlds: Worlds, robot: Index, x: Number, y: Number) -> None:
    """Put a robot at another place [m], at rest; it keeps its heading and all that it knows."""
    _check_there(worlds, robot)
    place = _place(worlds, x, y)
    x, y = place.tolist()
    if not worlds.team.is_free(robot, place):
        raise ValueError(f"robot {robot}: another robot is at the place [{x:.2f}, {y:.2f}]")
    worlds.physics.remove(robot)
    worlds.physics.add(robot, x, y, float(worlds.physics.headings[robot]))


@_by_hand
def add_robot(worlds: Worlds, x: Number, y: Number, heading: Number = 0.0) -> None:
    """Add a robot to the team, at a place [m] and with a heading [rad]."""
    x, y = _place(worlds, x, y).tolist()
    worlds.team.add(WORLD, (x, y, heading))


@_by_hand
def remove_robot(worlds: Worlds, robot: Index) -> None:
    """Take a robot away, at work or failed; its cargo lies where it was."""
    _check_there(worlds, robot)
    _check_not_last(worlds, robot)
    if worlds.team.working[robot]:
        worlds.team.remove(np.array([robot]))
    else:
        worlds.physics.remove(robot)
        worlds.minds.poses.silence([robot])


@_by_hand
def fail_robot(worlds: Worlds, robot: Index) -> None:
    """Let a robot fail for ever; its body stays."""
    _check_there(worlds, robot)
    if not worlds.team.working[robot]:
        raise ValueError(f"robot {robot}: expected a robot at work, got one that has failed")
    _check_not_last(worlds, robot)
    worlds.team.fail(np.array([robot]))


@_by_hand
def add_item(worlds: Worlds, x: Number, y: Number) -> None:
    """Put a new item at a place [m]."""
    task, place = cleaning_of(worlds.task), _place(worlds, x, y)
    if not task.garbage.arrive(WORLD, place):
        raise ValueError(f"an item more: expected at most {task.garbage.stage.shape[1]} lying or carried")
    task.site.show_items(WORLD, place[None])


@_by_hand
def put_item(worlds: Worlds, item: Item, x: Number, y: Number) -> None:
    """Put an item that lies at another place [m]."""
    place = _place(worlds, x, y)
    task = _lift(worlds, item)
    task.garbage.positions[WORLD, item] = place
    task.garbage.stage[WORLD, item] = LYING
    task.garbage.found[WORLD, item] = 0
    task.site.show_items(WORLD, place[None])


@_by_hand
def remove_item(worlds: Worlds, item: Item) -> None:
    """Take an item that lies away, as if it had never come."""
    _lift(worlds, item).garbage.arrived[WORLD] -= 1


@_by_hand
def set_loss(worlds: Worlds, loss: Share) -> None:
    """Set the probability that a receiver misses a message from now on; the range stays."""
    reception = worlds.minds.reception
    reception.set(WORLD, float(reception.reaches[WORLD]), loss)


def _place(worlds: Worlds, x: float, y: float) -> Floats:
    """Return the place (2,) on the torus [m]; ValueError where walls leave no room."""
    place = np.array([x, y]) % worlds.extent
    if not worlds.mission.is_free(place):
        raise ValueError(f"the place [{x:g}, {y:g}]: expected one that robots can reach among the walls")
    return place


def _check_there(worlds: Worlds, robot: int) -> None:
    """Raise ValueError unless a robot is there, at work or failed."""
    if robot >= worlds.robots or not worlds.physics.present[robot]:
        raise ValueError(f"robot {robot}: expected a robot that is there")


def _check_not_last(worlds: Worlds, robot: int) -> None:
    """Raise ValueError if no robot but this one works."""
    working = worlds.team.working
    if working[robot] and working.sum() == 1:
        raise ValueError(f"robot {robot}: expected another robot at work, got the last one")


def _lift(worlds: Worlds, item: int) -> Cleaning:
    """Take an item from where it lies, so that robots no longer see it; ValueError if none lies there."""
    task = cleaning_of(worlds.task)
    garbage = task.garbage
    if item >= garbage.stage.shape[1] or garbage.stage[WORLD, item] != LYING:
        raise ValueError(f"item {item}: expected an item that lies")
    here, place = np.array([WORLD]), garbage.positions[WORLD, [item]]
    garbage.stage[WORLD, item] = ABSENT
    task.site.hide_items(here, place)
    return task


if TYPE_CHECKING:
    ByHand = Change
else:
    ByHand = Annotated[reduce(or_, _KINDS), Field(discriminator="do")]
"""Any change, told by its `do`."""
