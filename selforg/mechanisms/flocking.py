"""Flocking mechanisms."""

from typing import Unpack

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.columns import SEE_HISTORY, SEE_MOVING, SKIP_OWN
from selforg.mechanisms.base import CompiledMechanism, at_least
from selforg.mechanisms.kernels.flocking import (
    BOID_COLUMNS,
    EPSILON,
    FLOCK_PARAMETERS,
    MAX_ACCELERATION,
    MAX_SPEED,
    SEPARATION,
    VIEW,
    A,
    B,
    H,
    flock_rows,
)
from selforg.mechanisms.options import MoveOptions
from selforg.mechanisms.registry import MECHANISMS


class FlockMechanism(CompiledMechanism):
    """What both flockings share: they look at the neighbours' moving gradients, by default those of the poses."""

    reynolds: bool

    def __init__(self, buffer: SoBuffer | OwnPoses, *, max_speed: float = 1.0, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        super().__init__(buffer, **options)
        self._see = SEE_MOVING | SKIP_OWN | (0 if self.reynolds else SEE_HISTORY)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self._parameters: Floats = np.zeros(FLOCK_PARAMETERS)
        self._parameters[[VIEW, MAX_SPEED]] = self.view_distance, self.max_speed
        self._boids: Floats = np.empty((0, BOID_COLUMNS))

    def _run(
        self, begin: int, now: float, rows: Ints, places: Ints, channels: Ints, vectors: Floats, active: Flags
    ) -> tuple[int, bool]:
        directions = self.directions
        if len(self._boids) < len(self._pairs):
            self._boids = np.empty((len(self._pairs), BOID_COLUMNS))
        return flock_rows(
            begin, self.reynolds, now, self._see, rows, places, channels, self._parameters, self.poses.bundle,
            self.buffer.tables, directions.vectors, directions.cursor, self._pairs, self._boids, vectors, active,
        )  # fmt: skip


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
        self._parameters[SEPARATION] = positive(self, "separation", separation)


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
        self._parameters[[A, B, EPSILON]] = (
            positive(self, "a", a), positive(self, "b", b), positive(self, "epsilon", epsilon),
        )  # fmt: skip
        self._parameters[[H, MAX_ACCELERATION]] = h, at_least(self, "max_acceleration", max_acceleration, 0.0)


def positive(mechanism: object, name: str, value: float) -> float:
    """Return `value` if it is positive and finite; raises ValueError with mechanism and parameter otherwise."""
    if not 0.0 < value < np.inf:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be positive and finite, got {value!r}")
    return float(value)
