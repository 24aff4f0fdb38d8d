"""Changes that a person makes by hand while a mission runs: what a recording holds of them, and how they are made.

A change is made at the beginning of a control period, before anybody decides. So a mission with the same changes at the
same periods has the same course, bit for bit. They are made in the first world of a batch.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from clean_swarm_env.config.types import Index
from clean_swarm_env.world.cleaning.cleaning_task import cleaning_of
from clean_swarm_env.world.cleaning.garbage import ABSENT, LYING
from clean_swarm_env.world.worlds import Worlds
from selector.documents.fields import Closed, Number, Share
from selforg.arrays import Floats

WORLD = 0
_Text = Annotated[str, Field(strict=True, max_length=200)]


class Change(Closed):
    """The base class of changes by hand."""

    tick: Annotated[int, Field(strict=True, ge=0)]
    """Control period at whose beginning the change is made."""

    def make(self, worlds: Worlds) -> None:
        """Change the world; ValueError, of one line, says what is impossible, and then nothing has changed."""


class _AtPlace(Change):
    """The base class of changes at a place."""

    x: Number
    """[m]."""
    y: Number
    """[m]."""

    def place(self, worlds: Worlds) -> Floats:
        """Return the place (2,) on the torus [m]."""
        return np.array([self.x, self.y]) % worlds.extent


class _OfRobot(Change):
    """The base class of changes of a robot."""

    robot: Index
    """Number of the robot."""

    def check_there(self, worlds: Worlds) -> None:
        """Raise ValueError unless the robot is there, at work or failed."""
        if self.robot >= worlds.robots or not worlds.physics.present[self.robot]:
            raise ValueError(f"robot {self.robot}: expected a robot that is there")

    def check_not_last(self, worlds: Worlds) -> None:
        """Raise ValueError if no robot but this one works."""
        working = worlds.team.working
        if working[self.robot] and working.sum() == 1:
            raise ValueError(f"robot {self.robot}: expected another robot at work, got the last one")


class PutRobot(_AtPlace, _OfRobot):
    """A robot is put at another place; it keeps its heading and all that it knows."""

    do: Literal["put_robot"]

    def make(self, worlds: Worlds) -> None:
        """Put the robot there, at rest."""
        self.check_there(worlds)
        place = self.place(worlds)
        x, y = place.tolist()
        if not worlds.team.is_free(WORLD, place, but=self.robot):
            raise ValueError(f"robot {self.robot}: another robot is at the place [{x:.2f}, {y:.2f}]")
        worlds.physics.remove(self.robot)
        worlds.physics.add(self.robot, x, y, float(worlds.physics.headings[self.robot]))


class AddRobot(_AtPlace):
    """A robot joins the team."""

    do: Literal["add_robot"]
    heading: Number = 0.0
    """[rad]."""

    def make(self, worlds: Worlds) -> None:
        """Add the robot at its place."""
        x, y = self.place(worlds).tolist()
        worlds.team.add(WORLD, (x, y, self.heading))


class RemoveRobot(_OfRobot):
    """A robot is taken away; its cargo lies where it was."""

    do: Literal["remove_robot"]

    def make(self, worlds: Worlds) -> None:
        """Take the robot away, at work or failed."""
        self.check_there(worlds)
        self.check_not_last(worlds)
        if worlds.team.working[self.robot]:
            worlds.team.remove(np.array([self.robot]))
        else:
            worlds.physics.remove(self.robot)
            worlds.minds.poses.silence([self.robot])


class FailRobot(_OfRobot):
    """A robot fails and does not recover."""

    do: Literal["fail_robot"]

    def make(self, worlds: Worlds) -> None:
        """Let the robot fail; its body stays."""
        self.check_there(worlds)
        if not worlds.team.working[self.robot]:
            raise ValueError(f"robot {self.robot}: expected a robot at work, got one that has failed")
        self.check_not_last(worlds)
        worlds.team.fail(np.array([self.robot]))


class AddItem(_AtPlace):
    """An item arrives."""

    do: Literal["add_item"]

    def make(self, worlds: Worlds) -> None:
        """Put the item at its place."""
        cleaning_of(worlds.task)
        place = self.place(worlds)
        if not worlds.garbage.arrive(WORLD, place):
            raise ValueError(f"an item more: expected at most {worlds.garbage.stage.shape[1]} lying or carried")
        worlds.minds.show_items(WORLD, place[None], worlds.now)


class _OfItem(Change):
    """The base class of changes of an item that lies."""

    item: Annotated[int, Field(strict=True, ge=0)]
    """Number of the item."""

    def lift(self, worlds: Worlds) -> None:
        """Take the item from where it lies; whoever looks sees it no more."""
        garbage, task = worlds.garbage, cleaning_of(worlds.task)
        if self.item >= garbage.stage.shape[1] or garbage.stage[WORLD, self.item] != LYING:
            raise ValueError(f"item {self.item}: expected an item that lies")
        here, place = np.array([WORLD]), garbage.positions[WORLD, [self.item]]
        garbage.stage[WORLD, self.item] = ABSENT
        task.hide_items(here, place)


class PutItem(_AtPlace, _OfItem):
    """An item that lies is put at another place."""

    do: Literal["put_item"]

    def make(self, worlds: Worlds) -> None:
        """Put the item there."""
        place = self.place(worlds)
        self.lift(worlds)
        worlds.garbage.positions[WORLD, self.item] = place
        worlds.garbage.stage[WORLD, self.item] = LYING
        worlds.minds.show_items(WORLD, place[None], worlds.now)


class RemoveItem(_OfItem):
    """An item that lies is taken away, as if it had never come."""

    do: Literal["remove_item"]

    def make(self, worlds: Worlds) -> None:
        """Take the item away."""
        self.lift(worlds)
        worlds.garbage.arrived[WORLD] -= 1


class SetLoss(Change):
    """The share of messages that get lost changes."""

    do: Literal["set_loss"]
    loss: Share
    """Probability that a receiver misses a message from now on [-]."""

    def make(self, worlds: Worlds) -> None:
        """Set the loss; the range stays."""
        reception = worlds.minds.reception
        reception.set(WORLD, float(reception.reaches[WORLD]), self.loss)


class HoldOption(Change):
    """Robots hold an option, whatever the strategy chooses."""

    do: Literal["hold_option"]
    robots: Annotated[tuple[Index, ...], Field(max_length=10_000)] = ()
    """Numbers of the robots; all if there is none."""
    option: _Text = ""
    """Name of the option; empty: the strategy chooses again."""


class FollowStrategy(Change):
    """Another strategy chooses the options of all robots from the next decision on."""

    do: Literal["follow_strategy"]
    strategy: _Text
    """The strategy, with the digest of its file if it has one."""


ByHand = Annotated[
    PutRobot
    | AddRobot
    | RemoveRobot
    | FailRobot
    | PutItem
    | AddItem
    | RemoveItem
    | SetLoss
    | HoldOption
    | FollowStrategy,
    Field(discriminator="do"),
]
