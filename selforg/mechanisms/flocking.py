"""Flocking mechanisms."""

from typing import Unpack

import numpy as np

from selforg.arrays import Ints
from selforg.compiler.records import Packed, Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.columns import SEE_HISTORY, SEE_MOVING, SKIP_OWN
from selforg.gradients.store.records import Sight
from selforg.mechanisms.base import CompiledMechanism, at_least
from selforg.mechanisms.kernels.flocking import BOID_COLUMNS, FLOCK, Flock, flock_rows
from selforg.mechanisms.kernels.moving import Movements
from selforg.mechanisms.options import MoveOptions
from selforg.mechanisms.registry import MECHANISMS


class FlockMechanism(CompiledMechanism):
    """What both flockings share: they look at the neighbours' moving gradients, by default those of the poses."""

    reynolds: bool

    def __init__(self, buffer: SoBuffer | OwnPoses, *, max_speed: float = 1.0, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        super().__init__(buffer, **options)
        self._see_bits = SEE_MOVING | SKIP_OWN | (0 if self.reynolds else SEE_HISTORY)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self.separation = self.a = self.b = self.epsilon = 1.0
        self.h = self.max_acceleration = 0.0
        self._flock: Packed[Flock] | None = None

    def _packed(self) -> Packed[Flock]:
        """Return what the kernel takes of the mechanism, with room for as many boids as pairs."""
        return FLOCK.pack(
            Flock(
                reynolds=self.reynolds,
                see_bits=self._see_bits,
                view_distance=self.view_distance,
                max_speed=self.max_speed,
                separation=self.separation,
                epsilon=self.epsilon,
                a=self.a,
                b=self.b,
                h=self.h,
                max_acceleration=self.max_acceleration,
                directions=self.directions.vectors,
                cursor=self.directions.cursor,
                low=self.directions.low,
                boids=np.empty((len(self._room.pairs), BOID_COLUMNS)),
                total=np.zeros(3),
            )
        )

    def _run(self, now: float, rows: Ints, places: Ints, movements: Words[Movements], sight: Words[Sight]) -> int:
        if self._flock is None or len(self._flock.record.boids) < len(self._room.pairs):
            self._flock = self._packed()
        flock, poses, store = self._flock.words, self.poses.packed.words, self.buffer.table.packed.words
        return flock_rows(now, rows, places, movements, sight, flock, poses, store)


@MECHANISMS.register
class FlockingReynolds(FlockMechanism):
    """Separation + cohesion + alignment of Reynolds (1987), doi:10.1145/37401.37406, capped at max_speed.

    The terms are not normalised, and alignment is the plain difference of headings (Q30). separation: weight r of
    1 / (r * clearance) [1/m2].
    """

    reynolds = True

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        separation: float = 1.0,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, max_speed=max_speed, **options)
        self.separation = positive(self, "separation", separation)


@MECHANISMS.register
class Flocking(FlockMechanism):
    """Algorithm 1 of Olfati-Saber (2006), doi:10.1109/TAC.2005.864190, as intended (deviation Q6).

    a, b: steepness of the action function, 0 < a <= b; epsilon: of the sigma-norm; h: where the bump begins to fall,
    in (0, 1); max_acceleration [m/s2] caps the sum of both terms. Inactive until a row has spread two poses.
    """

    reynolds = False

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        a: float = 5.0,
        b: float = 5.0,
        epsilon: float = 0.1,
        h: float = 0.2,
        max_acceleration: float = 1.0,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, max_speed=max_speed, **options)
        if not 0.0 <= h < 1.0:
            raise ValueError(f"Flocking: h must lie in [0, 1), got {h!r}")
        positive(self, "view_distance", self.view_distance)
        self.a, self.b = positive(self, "a", a), positive(self, "b", b)
        self.epsilon, self.h = positive(self, "epsilon", epsilon), h
        self.max_acceleration = at_least(self, "max_acceleration", max_acceleration, 0.0)


def positive(mechanism: object, name: str, value: float) -> float:
    """Return `value` if it is positive and finite; raises ValueError with mechanism and parameter otherwise."""
    if not 0.0 < value < np.inf:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be positive and finite, got {value!r}")
    return float(value)
