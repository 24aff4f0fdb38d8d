"""The blueprint of movement mechanisms, and the one that runs compiled rules.

`move` is called once per tick with the rows whose movement is asked for; it must not change the buffer. A mechanism
that deposits gradients does so in `deposit`, called after all movements of the tick are known.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.records import Packed, Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair_room import PairRoom
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.columns import SEE_MOVING, SEE_STATIC
from selforg.gradients.store.records import Sight
from selforg.mechanisms.kernels.moving import MOVEMENTS, STEERING, Movements, Steering
from selforg.mechanisms.kernels.rules import MovementRule, move_rows, wander
from selforg.mechanisms.options import LookOptions, MoveOptions
from selforg.randomness import DirectionStream


class Mechanism(ABC):  # noqa: B024  (each kind of mechanism has an abstract method of its own)
    """What all mechanisms share: whose gradients they look at, on which channels and how far."""

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        channels: Iterable[str] = (),
        view_distance: float | None = None,
        moving: bool = True,
        static: bool = True,
    ) -> None:
        if isinstance(buffer, OwnPoses):
            buffer = SoBuffer(BufferSettings(), buffer.space, buffer)
        view = buffer.settings.view_distance if view_distance is None else view_distance
        self.view_distance = at_least(self, "view_distance", view, 0.0)
        self.buffer = buffer
        self.poses = buffer.poses
        self.channels = tuple(channels)
        self._see_bits = (SEE_MOVING if moving else 0) | (SEE_STATIC if static else 0)

    example: ClassVar[Mapping[str, Any]] = {}
    """Keyword arguments with which the contract tests build the class."""


class MovementMechanism(Mechanism):
    """Blueprint of a mechanism that says in which direction to move, how fast, and whether there is a reason to.

    Subclasses implement `_move`. The arrays that `move` returns belong to the mechanism and hold until its next call.

    Example:
        >>> mechanism = RepulsionFernandez(poses, view_distance=2.0)
        >>> vectors, active = mechanism.move(now=0.2, rows=np.array([0, 3]))

    """

    _all_rows: Annotated[Ints, "N", READ]
    _vectors: Annotated[Floats, "N D", SCRATCH]
    _active: Annotated[Flags, "N", SCRATCH]

    def __init__(
        self, buffer: SoBuffer | OwnPoses, *, directions: DirectionStream | None = None, **options: Unpack[LookOptions]
    ) -> None:
        super().__init__(buffer, **options)
        rows, dim = self.poses.rows, self.poses.space.dim
        self.directions = DirectionStream.fixed(rows, dim) if directions is None else directions
        if len(self.directions.cursor) != rows:
            raise ValueError(
                f"{type(self).__name__}: directions must have {rows} rows, got {len(self.directions.cursor)}"
            )
        self._all_rows = np.arange(rows, dtype=np.int64)
        self._vectors = np.zeros((rows, dim))
        self._active = np.zeros(rows, dtype=np.bool_)

    @final
    def move(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> tuple[Floats, Flags]:
        """Return movements (R, D) [m/s] of `rows` (R,), each at most once (None: all), and whether there is one (R,).

        Without a movement the vector is zero. A movement may be zero too: gradients in view that cancel out.
        """
        chosen, vectors, active = self._all_rows, self._vectors, self._active
        if rows is not None:
            chosen = np.ascontiguousarray(rows, dtype=np.int64)
            vectors, active = vectors[: len(chosen)], active[: len(chosen)]
        self._move(float(now), chosen, vectors, active)
        return vectors, active

    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Write the movement of `rows` (R,) into those rows of `vectors` (N, D) and `active` (N,), all robots'."""
        vectors[rows], active[rows] = self.move(now, rows)

    @abstractmethod
    def _move(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Write the movement of `rows` (R,) into `vectors` (R, D) and `active` (R,); called by `move` only."""


class CompiledMechanism(MovementMechanism):
    """What movement mechanisms share that run a kernel over rows: random directions, and room for what rows see.

    Subclasses implement `_run`, called until all rows are done.
    """

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[MoveOptions]) -> None:
        super().__init__(buffer, **options)
        self._room = PairRoom(self.buffer)
        self._answers = MOVEMENTS.pack(Movements(self._vectors, self._active))
        self._given = self._answers  # the arrays that `move_into` got last

    def _move(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        self._write(now, rows, self._all_rows, self._answers.words)  # `vectors`, `active` are the beginning of these

    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Do what `MovementMechanism.move_into` does; here the kernel writes the result."""
        last = self._given.record
        if last.vectors is not vectors or last.active is not active:
            self._given = MOVEMENTS.pack(Movements(vectors, active))
        self._write(now, rows, rows, self._given.words)

    def _write(self, now: float, rows: Ints, places: Ints, movements: Words[Movements]) -> None:
        """Write the movement of `rows` (R,) into the rows `places` (R,) of `movements`."""
        if self.directions.low[0]:
            self.directions.refill()
        done = self._run(now, rows, places, movements, self._room.sight(now, self.channels))
        while done < len(rows):
            rows, places = rows[done:], places[done:]
            done = self._run(now, rows, places, movements, self._room.double())

    @abstractmethod
    def _run(self, now: float, rows: Ints, places: Ints, movements: Words[Movements], sight: Words[Sight]) -> int:
        """Write the movement of `rows` as `_write` does.

        Returns how many rows are done, fewer than all if the room for pairs is too short for the next one.
        """


class LimitedMechanism(CompiledMechanism):
    """What movement mechanisms share whose vectors are limited to [`min_speed`, `max_speed`].

    Attributes:
        rule: the movement rule.
        angle_xy, angle_yz: view angles [rad] to either side of the heading, for rules that look ahead.

    """

    rule: MovementRule = wander

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        min_speed: float = 0.1,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, **options)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self.min_speed = at_least(self, "min_speed", min_speed, 0.0)
        self.angle_xy, self.angle_yz = np.inf, np.inf

    @cached_property
    def _steering(self) -> Packed[Steering]:
        """What kernels take of the mechanism, packed when it moves for the first time."""
        rule, directions = self.rule, self.directions
        return STEERING.pack(
            Steering(
                *rule[:2],  # Steering begins with the fields of a MovementRule
                *rule.looks,
                *rule.wakes,
                *rule[4:],
                see_bits=self._see_bits,
                view_distance=self.view_distance,
                min_speed=self.min_speed,
                max_speed=self.max_speed,
                angle_xy=self.angle_xy,
                angle_yz=self.angle_yz,
                directions=directions.vectors,
                cursor=directions.cursor,
                low=directions.low,
                total=np.zeros(3),
            )
        )


class RuleMechanism(LimitedMechanism):
    """A movement mechanism that runs one of the compiled rules of `selforg.mechanisms.kernels.rules`."""

    def _run(self, now: float, rows: Ints, places: Ints, movements: Words[Movements], sight: Words[Sight]) -> int:
        steering, poses, store = self._steering.words, self.poses.packed.words, self.buffer.table.packed.words
        return move_rows(now, rows, places, movements, sight, steering, poses, store)


def at_least(mechanism: object, name: str, value: float, lowest: float) -> float:
    """Return `value` if it is at least `lowest`; raises ValueError with mechanism and parameter otherwise (NaN too)."""
    if not value >= lowest:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be at least {lowest}, got {value!r}")
    return float(value)
