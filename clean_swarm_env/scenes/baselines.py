"""Controllers without a mechanism: the baselines, and the errands that a mechanism is combined with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from clean_swarm_env.scenes.arena import BASELINES, CONTROL_PERIOD, Arena
from selforg.arrays import Floats
from selforg.commands import Commands
from selforg.elementary import unit_vectors


class Controller(ABC):
    """The base class of controllers: `command` is called once a control period, after poses are announced.

    Subclasses implement `_command`, which writes the commands of all rows into cleared commands.
    """

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self._commands = Commands.none(arena.rows, 2)

    @final
    def command(self) -> Commands:
        """Return the commands of all rows, which hold until the next call."""
        self._commands.commanded[:] = False
        self._commands.in_place[:] = False
        self._command(self._commands)
        return self._commands

    def with_errand(self, errand: Controller) -> Controller:
        """Return the controller of robots that are on an errand: the sum of both."""
        return Together(self, errand)

    @abstractmethod
    def _command(self, commands: Commands) -> None:
        """Command the robots; vectors of rows without a command may hold anything."""


class StandStill(Controller):
    """No robot moves."""

    def _command(self, commands: Commands) -> None:
        """Leave all robots without a command."""


class Wander(Controller):
    """A random walk: a new random direction every `every` seconds, at full speed."""

    def __init__(self, arena: Arena, every: float = 2.0) -> None:
        super().__init__(arena)
        self._ticks = max(round(every / CONTROL_PERIOD), 1)
        self._generators = arena.generators(BASELINES)

    def _command(self, commands: Commands) -> None:
        if self.arena.ticks % self._ticks == 0:
            angles = np.array([generator.uniform(-np.pi, np.pi) for generator in self._generators])
            commands.vectors[:] = along(angles, self.arena.body.max_speed)
        commands.commanded[:] = True


class GoStraight(Controller):
    """Each robot keeps its given direction (R,) [rad], at a speed [m/s], the full one unless given."""

    def __init__(self, arena: Arena, directions: Floats, speed: float | None = None) -> None:
        super().__init__(arena)
        self._commands.vectors[:] = along(directions, arena.body.max_speed if speed is None else speed)

    def _command(self, commands: Commands) -> None:
        commands.commanded[:] = True


class GoTo(Controller):
    """Each robot goes straight to its own place (R, 2) [m] and stops within `near` [m] of it."""

    def __init__(self, arena: Arena, places: Floats, near: float) -> None:
        super().__init__(arena)
        self._places, self._near = places, near

    def _command(self, commands: Commands) -> None:
        offsets = self.arena.ground.offsets(self.arena.positions, self._places)
        away = np.linalg.norm(offsets, axis=1, keepdims=True)
        unit = offsets / np.maximum(away, 1e-12)
        commands.vectors[:] = np.where(away > self._near, self.arena.body.max_speed * unit, 0.0)
        commands.commanded[:] = True


class Instead(Controller):
    """One controller, and another one for robots that the first does not command."""

    def __init__(self, first: Controller, otherwise: Controller) -> None:
        super().__init__(first.arena)
        self._first, self._otherwise = first, otherwise

    def _command(self, commands: Commands) -> None:
        other, own = self._otherwise.command(), self._first.command()
        commands.vectors[:] = np.where(own.commanded[:, None], own.vectors, other.vectors)
        commands.in_place[:] = np.where(own.commanded, own.in_place, other.in_place)
        commands.commanded[:] = own.commanded | other.commanded


class Together(Controller):
    """The sum of the vectors of two controllers, as of motor schemas: avoidance bends the way of an errand.

    The drive limits the sum. No robot turns in place.
    """

    def __init__(self, first: Controller, second: Controller) -> None:
        super().__init__(first.arena)
        self._parts = first, second

    def _command(self, commands: Commands) -> None:
        commands.vectors[:] = 0.0
        for part in self._parts:
            wanted = part.command()
            commands.vectors[wanted.commanded] += wanted.vectors[wanted.commanded]
            commands.commanded[:] |= wanted.commanded


def along(angles: Floats, length: float) -> Floats:
    """Return vectors (K, 2) of a length along angles (K,) [rad]."""
    return length * np.stack(unit_vectors(angles), axis=1)
