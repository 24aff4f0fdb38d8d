"""The blueprint of movement mechanisms, and the one that runs compiled rules.

`move` is called once per tick with the rows that want to know where this mechanism would take them; it must not change
the buffer. What a mechanism leaves behind it leaves in `deposit`, called after all movements of the tick are known.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.columns import PAIR_COLUMNS, SEE_MOVING, SEE_STATIC
from selforg.mechanisms.kernels.moving import WORKING_TABLES, move_rows
from selforg.mechanisms.kernels.rules import MAX_SPEED, MIN_SPEED, PARAMETERS, VIEW
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
        self._see = (SEE_MOVING if moving else 0) | (SEE_STATIC if static else 0)
        self._table_for = -1
        self._channel_table: Ints = np.zeros(1, dtype=np.int64)

    @classmethod
    def example(cls) -> dict[str, Any]:
        """Return the keyword arguments with which the contract tests build the class."""
        return {}

    def _channels_now(self) -> Ints:
        """Return the channel table, made anew when the buffer has heard of new channels."""
        if self._table_for != len(self.buffer.rules):  # one of each channel
            self._table_for = len(self.buffer.rules)
            self._channel_table = self.buffer.channel_table(self.channels)
        return self._channel_table


class MovementMechanism(Mechanism):
    """Blueprint of a mechanism that says in which direction to move, how fast, and whether there is a reason to.

    Subclasses implement `_move`. The arrays that `move` returns belong to the mechanism and hold until its next call.

    Example:
        >>> mechanism = RepulsionFernandez(poses, view_distance=2.0)
        >>> vectors, active = mechanism.move(now=0.2, rows=np.array([0, 3]))

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        directions: DirectionStream | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows, dim = self.poses.rows, self.poses.space.dim
        self.directions = DirectionStream.fixed(rows, dim) if directions is None else directions
        if len(self.directions.cursor) != rows:
            raise ValueError(
                f"{type(self).__name__}: directions must have {rows} rows, got {len(self.directions.cursor)}"
            )
        self._all_rows: Ints = np.arange(rows, dtype=np.int64)
        self._vectors: Floats = np.zeros((rows, dim))
        self._active: Flags = np.zeros(rows, dtype=np.bool_)

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
        self._pairs: Floats = np.empty((256, PAIR_COLUMNS))
        self._working: Bundle = ()
        self._working_with: Floats | None = None  # the table of pairs that is bundled

    def _move(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        self._write(now, rows, self._all_rows, vectors, active)

    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """As `MovementMechanism.move_into` does it, but written by the kernel."""
        self._write(now, rows, rows, vectors, active)

    def _write(self, now: float, rows: Ints, places: Ints, vectors: Floats, active: Flags) -> None:
        """Write the movement of `rows` (R,) into the rows `places` (R,) of `vectors` and `active`."""
        buffer, directions = self.buffer, self.directions
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        if directions.low:
            directions.refill()
        channels, done, all_of = self._channels_now(), 0, len(rows)
        while done < all_of:
            done, low = self._run(done, now, rows, places, channels, vectors, active)
            if low:
                directions.low = True
            if done < all_of:
                self._pairs = np.empty((2 * len(self._pairs), PAIR_COLUMNS))

    @abstractmethod
    def _run(
        self, begin: int, now: float, rows: Ints, places: Ints, channels: Ints, vectors: Floats, active: Flags
    ) -> tuple[int, bool]:
        """Write the movement of rows[begin:] as `_write` does.

        Returns how many rows are done, fewer than all if `_pairs` is too short, and whether some row's directions run
        low.
        """


class LimitedMechanism(CompiledMechanism):
    """What movement mechanisms share whose vectors are limited to [`min_speed`, `max_speed`]."""

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
        self._parameters: Floats = np.zeros(PARAMETERS + 3)  # and room for a sum
        self._parameters[[VIEW, MIN_SPEED, MAX_SPEED]] = self.view_distance, min_speed, max_speed


class RuleMechanism(LimitedMechanism):
    """A movement mechanism that runs one of the compiled rules of `selforg.mechanisms.kernels.rules`."""

    rule: int

    def _run(
        self, begin: int, now: float, rows: Ints, places: Ints, channels: Ints, vectors: Floats, active: Flags
    ) -> tuple[int, bool]:
        if self._working_with is not self._pairs:
            self._working_with = self._pairs
            self._working = WORKING_TABLES.bundle(
                self._parameters, self.directions.vectors, self.directions.cursor, self._pairs
            )
        return move_rows(
            begin, self.rule, now, self._see, rows, places, channels, self._working, self.poses.bundle,
            self.buffer.tables, vectors, active,
        )  # fmt: skip


def at_least(mechanism: object, name: str, value: float, lowest: float) -> float:
    """Return `value` if it is at least `lowest`; raises ValueError with mechanism and parameter otherwise (NaN too)."""
    if not value >= lowest:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be at least {lowest}, got {value!r}")
    return float(value)
