"""The blueprints of all mechanisms and of movement mechanisms, and the registry by which configurations find them.

`move` is called once per tick with the rows whose movement is asked for; it must not change the buffer. A mechanism
that deposits gradients does so in `deposit`, called after all movements of the tick are known.
"""

import sys
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, Self, TypedDict, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import SCRATCH, Flags, Floats, Ints
from selforg.commands import Moved
from selforg.compiler.records import Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.columns import SEE_MOVING, SEE_STATIC
from selforg.mechanisms.causes import Causes
from selforg.parameters import at_least
from selforg.plugins import Promises, are_numbers
from selforg.program import Rows, Step
from selforg.randomness import DirectionStream
from selforg.registry import Registry


class LookOptions(TypedDict, total=False):
    """What a mechanism looks at; see `Mechanism`."""

    channels: Iterable[str]
    view_distance: float | None
    moving: bool
    static: bool


class MoveOptions(LookOptions, total=False):
    """What a movement mechanism looks at, and the source of its random directions; see `MovementMechanism`."""

    directions: DirectionStream | None


class SpeedOptions(MoveOptions, total=False):
    """The options of a movement mechanism, and the lengths of its vectors [m/s]; see `FormulaMechanism`."""

    min_speed: float | None
    max_speed: float | None


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
        self._sight_bits = (SEE_MOVING if moving else 0) | (SEE_STATIC if static else 0)

    example: ClassVar[Mapping[str, Any]] = {}
    """Keyword arguments with which the contract tests build the class."""

    def weigh(self, now: float, rows: Ints, wishes: Floats, causes: Causes) -> None:  # noqa: B027  (of most: nobody)
        """Note because of whom it changes `wishes` (N, D) [m/s] of `rows` (K,), at the `now` [s] at which it did so."""

    @classmethod
    def variant(cls, name: str, says: str, **attributes: Any) -> type[Self]:  # noqa: ANN401  (those of the class)
        """Register and return a mechanism that differs from this one in class attributes only; `says` describes it.

        Example:
            >>> SlowPatrol = Patrol.variant("SlowPatrol", "Patrols at 0.3 m/s at least.", min_speed=0.3)

        Raises:
            AttributeError: the class has no attribute of such a name.

        """
        for attribute in attributes:
            getattr(cls, attribute)
        module = sys._getframe(1).f_globals["__name__"]  # copies and pickles find a class by its module
        return MECHANISMS.register(type(name, (cls,), {"__doc__": says, "__module__": module, **attributes}))


MECHANISMS: Registry[Mechanism] = Registry("mechanism", base=Mechanism)
"""The name of the class is the name by which configurations find a mechanism."""


class MovementMechanism(Mechanism):
    """Blueprint of a mechanism that says in which direction to move, how fast, and whether there is a reason to.

    Subclasses implement `move_into`.

    Example:
        >>> mechanism = RepulsionFernandez(poses, view_distance=2.0)
        >>> vectors, active = mechanism.move(now=0.2, rows=np.array([0, 3]))

    """

    promises: ClassVar[Promises] = {
        "move_into": (
            "finite vectors",
            lambda mechanism, _, now, rows, vectors, active: are_numbers(vectors[rows], len(rows), vectors.shape[1]),
            1,
        )
    }
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
        self._vectors = np.zeros((rows, dim))
        self._active = np.zeros(rows, dtype=np.bool_)

    @final
    def move(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> tuple[Floats, Flags]:
        """Return movements (R, D) [m/s] of `rows` (R,), each at most once (None: all), and whether there is one (R,).

        Without a movement the vector is zero. A movement may be zero too: gradients in view that cancel out. Movements
        of all rows are valid until the next call.
        """
        chosen = self.poses.chosen(rows)
        self.move_into(float(now), chosen, self._vectors, self._active)
        return (self._vectors, self._active) if rows is None else (self._vectors[chosen], self._active[chosen])

    @abstractmethod
    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Write the movement of `rows` (R,) into those rows of `vectors` (N, D) and `active` (N,), all robots'."""

    def moving(self, stage: int, rows: Rows, moved: Packed[Moved]) -> list[Step]:
        """Return the steps of a program that write the movement of `rows` into a record, as `move_into` does."""
        return [Step(stage, lambda now, rows: self.move_into(now, rows, *moved.record), rows)]
