"""Movement commands of robots: behaviours write them, steering changes them, and a drive follows them."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import SCRATCH, Flags, Floats
from selforg.compiler.records import Packed, opening


class Commanded(NamedTuple):
    """The commands of all robots in one tick."""

    vectors: Annotated[
        Floats, "R D", SCRATCH
    ]  # direction and speed [m/s]; of a robot that turns in place, the direction only
    commanded: Annotated[
        Flags, "R", SCRATCH
    ]  # whether there is a command; a zero vector commands the robot to stand still
    in_place: Annotated[Flags, "R", SCRATCH]  # whether the robot turns without moving


class Moved(NamedTuple):
    """Movements of all rows, where mechanisms write them."""

    vectors: Annotated[Floats, "R D", SCRATCH]  # [m/s]
    active: Annotated[Flags, "R", SCRATCH]  # whether there is a movement


open_commanded, open_moved = opening(Commanded), opening(Moved)


class Commands:
    """The owner of the commands of N robots in one tick, none at first; see `Commanded`.

    Attributes:
        wishes: (N, D) [m/s] what was commanded before any mechanism steered, for explanations.

    """

    wishes: Annotated[Floats, "N D", SCRATCH]

    def __init__(self, rows: int, dim: int) -> None:
        self.wishes = np.zeros((rows, dim))
        no_flags = np.zeros(rows, dtype=np.bool_)
        self.packed = Packed(Commanded(np.zeros((rows, dim)), no_flags, no_flags.copy()))
        self.vectors, self.commanded, self.in_place = self.packed.record

    def clear(self) -> None:
        """Take all commands back."""
        for array in self.packed.record:
            array[:] = 0

    def add(self, vectors: Floats) -> None:
        """Add `vectors` (N, D) [m/s] to the movements; a zero vector changes nothing, others end turning in place."""
        rows = np.flatnonzero(vectors.any(axis=1))
        moving = self.commanded[rows] & ~self.in_place[rows]
        self.vectors[rows] = np.where(moving[:, None], self.vectors[rows], 0.0) + vectors[rows]
        self.commanded[rows], self.in_place[rows] = True, False
