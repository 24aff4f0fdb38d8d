"""Spreading: gradients that robots carry or leave, with a value or without one."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
import numpy.typing as npt

from selforg.arrays import SCRATCH, Floats, Ints
from selforg.compiler.records import Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import check_fields
from selforg.gradients.rows import set_times
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Left
from selforg.gradients.store.storing import deposit_rows, has_listener
from selforg.mechanisms.base import MECHANISMS, Mechanism
from selforg.program import LEAVE, Program, Rows, Step


@dataclass(frozen=True)
class Carried:
    """A gradient to spread at the own pose.

    Attributes:
        channel: where it is heard.
        key: name of the value it carries, empty for none.
        attraction, diffusion [m], goal_radius [m], evaporation_factor [-], evaporation_period [s]: as in `Gradient`.
        moving: carried along (the newest counts) or left behind.

    """

    channel: str
    key: str = ""
    attraction: int = 1
    diffusion: float = 1.0
    goal_radius: float = 0.0
    evaporation_factor: float = 1.0
    evaporation_period: float = 0.0
    moving: bool = True

    def __post_init__(self) -> None:
        """Check every field."""
        check_fields(
            self.attraction,
            self.diffusion,
            self.goal_radius,
            self.evaporation_factor,
            self.evaporation_period,
            stamp=0.0,
        )


class Spreader:
    """Spreads one kind of gradient from the own pose of many rows at once."""

    _messages: Annotated[Floats, "1 MESSAGE", SCRATCH]
    _tags: Annotated[Ints, "1 TAG", SCRATCH]

    def __init__(self, buffer: SoBuffer, carried: Carried) -> None:
        self.carried, self._buffer = carried, buffer
        key = buffer.keys.code(carried.key) if carried.key else -1
        self._messages, self._tags = buffer.blank(1, carried.channel)
        self._messages[:, c.DIFFUSION], self._messages[:, c.GOAL_RADIUS] = carried.diffusion, carried.goal_radius
        far = self._messages[:, c.MESSAGE_FAR :]
        far[:, c.FAR_FACTOR], far[:, c.FAR_PERIOD] = carried.evaporation_factor, carried.evaporation_period
        tags = self._tags
        tags[:, c.TAG_SIGN], tags[:, c.TAG_MOVING], tags[:, c.TAG_KEY] = carried.attraction, carried.moving, key
        self._left = Packed(Left(self._messages, self._tags))

    def spread(self, now: float, rows: Ints, values: Floats | None = None, diffusions: Floats | None = None) -> None:
        """Spread from `rows` (R,) that know their pose; values (R,) to carry, diffusions (R,) [m] of their own."""
        if len(rows) == 0:
            return
        messages, tags = self._copies(now, rows)
        if values is not None:
            messages[:, c.MESSAGE_FAR + c.FAR_VALUE] = values
        if diffusions is not None:
            messages[:, c.DIFFUSION] = diffusions
        else:
            self._tell(now, rows)
        self._buffer.spread(messages, tags, now)

    def _copies(self, now: float, rows: Ints) -> tuple[Floats, Ints]:
        """Return messages and tags from `rows` (K,) that know their pose."""
        messages, tags = self.blank(len(rows))
        messages[:, c.X : c.X + 3] = self._buffer.poses.own[rows, 0, c.X : c.X + 3]
        set_times(messages, now)
        tags[:, c.TAG_SOURCE] = rows
        return messages, tags

    def _tell(self, now: float, rows: Ints, _: int = 1) -> None:
        """Tell whoever listens that `rows` (K,) leave it."""
        if self._buffer.on_deposit is not None and not self.carried.moving:
            self._buffer.on_deposit(rows, self._messages[0], self._tags[0])

    def blank(self, count: int) -> tuple[Floats, Ints]:
        """Return messages (count, MESSAGE) and tags (count, TAG) that say neither who spreads it nor when and where."""
        return np.repeat(self._messages, count, axis=0), np.repeat(self._tags, count, axis=0)

    def depositing(self, rows: Rows) -> list[Step]:
        """Return the steps of a program that leave it at the newest pose of each of `rows`; without a pose nothing."""
        buffer, table, poses = self._buffer, self._buffer.table, self._buffer.poses

        def make_room(now: float, rows: Ints, _: int) -> None:
            table.reserve(len(rows))
            deposit_rows(now, rows, self._left.handle, poses.packed.handle, table.packed.handle)

        def spread(now: float, rows: Ints) -> None:
            buffer.spread(*self._copies(now, rows[poses.known[rows]]), now)

        telling = Step(LEAVE, self._tell, rows, has_listener, (table.packed,))
        if buffer.shared and buffer.sent is None:
            return [telling, Step(LEAVE, make_room, rows, deposit_rows, (self._left, poses.packed, table.packed))]
        return [telling, Step(LEAVE, spread, rows)]


@MECHANISMS.register
class SpreadGradient(Mechanism):
    """Spreads a configured gradient at the robot; it neither moves nor decides.

    Attributes:
        spreader: gives the steps of a program that do as `spread` does.

    """

    example: ClassVar[Mapping[str, Any]] = {"carried": Carried("beacon")}

    def __init__(self, buffer: SoBuffer, *, carried: Carried) -> None:
        super().__init__(buffer)
        self.spreader = Spreader(buffer, carried)

    def spread(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> None:
        """Spread it from each of `rows` (R,) (None: all) that knows its pose, at `now` [s]."""
        chosen = Rows.of(self.poses.chosen(rows))
        Program(lambda: self.spreader.depositing(chosen)).run(float(now))
