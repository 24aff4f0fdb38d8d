"""Changes that a person makes by hand while a mission runs: what a recording holds of them, and how they are made.

A change is made at the beginning of a control period, before anybody decides. So a mission with the same changes at the
same periods has the same course, bit for bit. They are made in the first world of a batch.

A function that `by_hand` registers is a change: its name is the change's `do`, and its parameters after the first are
its further keys. The first one is what it changes, by its type: `Worlds`, or the task that has such a change. It raises
ValueError, of one line, for what is impossible, and then nothing has changed. Those of robots and messages are below;
those of a task are in its own file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from inspect import Parameter, signature
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args

import numpy as np
from pydantic import Field, create_model

from clean_swarm_env.config.task_names import TASKS_HOME
from clean_swarm_env.config.types import Index
from clean_swarm_env.world.task import Task
from clean_swarm_env.world.view import TaskView
from clean_swarm_env.world.worlds import Worlds
from selector.documents.fields import Closed, Number, Share
from selforg.arrays import Floats
from selforg.registry import Registry

WORLD = 0
"""The world that is changed."""
Made = TypeVar("Made", bound=Callable[..., None])
_Text = Annotated[str, Field(strict=True, max_length=200)]


class Change(Closed):
    """The base class of changes by hand.

    Attributes:
        changes: what is changed: the worlds, or a task.
        maker: the function that changes it.

    """

    changes: ClassVar[type[Any]] = Worlds
    maker: ClassVar[Callable[..., None]]
    do: str
    """Its name."""
    tick: Annotated[int, Field(strict=True, ge=0)]
    """Control period at whose beginning the change is made."""

    def make(self, worlds: Worlds) -> None:
        """Change the world; ValueError, of one line, says what is impossible, and then nothing has changed."""
        changed = worlds if self.changes is Worlds else worlds.task
        if not isinstance(changed, self.changes):
            raise ValueError(f"{self.do}: expected the task {self.changes.name}, got {worlds.task.name}")
        self.maker(changed, **{name: value for name, value in self if name not in Change.model_fields})


CHANGES: Registry[Change] = Registry(
    "change by hand", lambda kind: str(get_args(kind.model_fields["do"].annotation)[0]), TASKS_HOME, Change
)
"""Kinds of changes by their `do`."""


@CHANGES.register
class HoldOption(Change):
    """Let robots hold an option, whatever the strategy chooses."""

    do: Literal["hold_option"]
    robots: Annotated[tuple[Index, ...], Field(max_length=10_000)] = ()
    """Numbers of the robots; all if there is none."""
    option: _Text = ""
    """Name of the option; empty: the strategy chooses again."""


@CHANGES.register
class FollowStrategy(Change):
    """Let another strategy choose the options of all robots from the next decision on."""

    do: Literal["follow_strategy"]
    strategy: _Text
    """The strategy, with the digest of its file if it has one."""


def by_hand(make: Made) -> Made:
    """Register a function as a change by hand, as a decorator; TypeError unless its first parameter has a type."""
    first, *given = signature(make, eval_str=True).parameters.values()
    if not (isinstance(first.annotation, type) and issubclass(first.annotation, Worlds | Task)):
        raise TypeError(f"{make.__name__}: expected a first parameter of the type Worlds or of a task, got {first}")
    for one in given:
        if one.annotation is Parameter.empty:
            raise TypeError(f"{make.__name__}: expected a type of the parameter {one.name}, got none")
    keys: dict[str, Any] = {"do": Literal[make.__name__]}
    keys |= {p.name: (p.annotation, ... if p.default is Parameter.empty else p.default) for p in given}
    kind = create_model(make.__name__, __base__=Change, __module__=make.__module__, __doc__=make.__doc__, **keys)
    kind.changes, kind.maker = first.annotation, staticmethod(make)
    CHANGES.register(kind)
    return make


def change_of(given: object) -> Change:
    """Return a change from its keys; ValueError if its `do` is unknown, or its other keys are not those of its kind."""
    import_module(TASKS_HOME)
    name = str(given.get("do", "")) if isinstance(given, Mapping) else ""
    if name not in CHANGES:
        raise ValueError(CHANGES.unknown(name))
    return CHANGES.find(name).model_validate(given)


def free_place(world: TaskView, x: float, y: float) -> Floats:
    """Return the place (2,) on the torus [m]; ValueError where walls leave no room."""
    place: Floats = np.array([x, y]) % world.ground.extent
    if not world.ground.is_free(place):
        raise ValueError(f"the place [{x:g}, {y:g}]: expected one that robots can reach among the walls")
    return place


@by_hand
def put_robot(worlds: Worlds, robot: Index, x: Number, y: Number) -> None:
    """Put a robot at another place [m], at rest; it keeps its heading and all that it knows."""
    _check_there(worlds, robot)
    place = free_place(worlds.world, x, y)
    x, y = place.tolist()
    if not worlds.team.is_free(robot, place):
        raise ValueError(f"robot {robot}: another robot is at the place [{x:.2f}, {y:.2f}]")
    worlds.physics.remove(robot)
    worlds.physics.add(robot, x, y, float(worlds.physics.headings[robot]))


@by_hand
def add_robot(worlds: Worlds, x: Number, y: Number, heading: Number = 0.0) -> None:
    """Add a robot to the team, at a place [m] and with a heading [rad]."""
    x, y = free_place(worlds.world, x, y).tolist()
    worlds.team.add(WORLD, (x, y, heading))


@by_hand
def remove_robot(worlds: Worlds, robot: Index) -> None:
    """Take a robot away, at work or failed; its cargo lies where it was."""
    _check_there(worlds, robot)
    _check_not_last(worlds, robot)
    if worlds.team.working[robot]:
        worlds.team.remove(np.array([robot]))
    else:
        worlds.physics.remove(robot)
        worlds.minds.poses.silence([robot])


@by_hand
def fail_robot(worlds: Worlds, robot: Index) -> None:
    """Let a robot fail for ever; its body stays."""
    _check_there(worlds, robot)
    if not worlds.team.working[robot]:
        raise ValueError(f"robot {robot}: expected a robot at work, got one that has failed")
    _check_not_last(worlds, robot)
    worlds.team.fail(np.array([robot]))


@by_hand
def set_loss(worlds: Worlds, loss: Share) -> None:
    """Set the probability that a receiver misses a message from now on; the range stays."""
    reception = worlds.minds.reception
    reception.set(WORLD, float(reception.reaches[WORLD]), loss)


def _check_there(worlds: Worlds, robot: int) -> None:
    """Raise ValueError unless a robot is there, at work or failed."""
    if robot >= worlds.robots or not worlds.physics.present[robot]:
        raise ValueError(f"robot {robot}: expected a robot that is there")


def _check_not_last(worlds: Worlds, robot: int) -> None:
    """Raise ValueError if no robot but this one works."""
    working = worlds.team.working
    if working[robot] and working.sum() == 1:
        raise ValueError(f"robot {robot}: expected another robot at work, got the last one")
