"""Boids: what both flocking mechanisms share.

A boid is a row of a table, float64 (M, BOID_COLUMNS): its offset from the robot [m], its velocity [m/s] (Olfati-Saber)
or unit heading (Reynolds), its goal radius [m].
"""

from collections.abc import Callable
from typing import Annotated, ClassVar, NamedTuple, TypeAlias, Unpack

import numpy as np

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.compiler.decorators import template
from selforg.compiler.records import Packed, Recording, Words, Written
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight
from selforg.mechanisms.base import MoveOptions, at_least
from selforg.mechanisms.formula import KernelMechanism
from selforg.mechanisms.movement import limit

BOID_OFFSET = 0  # and the two columns after it [m]
BOID_VELOCITY = 3  # and the two columns after it [m/s], or a heading [-]
BOID_GOAL_RADIUS = 6  # [m]
BOID_COLUMNS = 7


class Flock(NamedTuple):
    """The parameters of a flocking rule, the random directions of a `DirectionStream`, and room for boids."""

    least_poses: int  # that a row must have spread
    see_bits: int  # SEE_ bits
    view_distance: float  # [m]
    max_speed: float  # [m/s]
    separation: float  # weight r of Reynolds' separation
    epsilon: float  # of the sigma-norm
    a: float  # steepness of the action function
    b: float
    h: float  # where the bump begins to fall
    max_acceleration: float  # [m/s2]
    directions: Annotated[Floats, "N BLOCK 3", READ]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "N", KEPT]  # next direction of each row
    low: Annotated[Flags, "1", derived(True)]  # set when a row has used half of its directions
    boids: Annotated[Floats, "P BOID", SCRATCH]  # room for as many boids as pairs; columns BOID_
    total: Annotated[Floats, "3", SCRATCH]  # room for a sum
    own: Annotated[Floats, "3", SCRATCH]  # room for what boids are compared with
    change: Annotated[Floats, "3", SCRATCH]  # room for a change of the velocity [m/s2]


FLOCK = Recording(Flock)
open_flock = FLOCK.open

FlockTerm: TypeAlias = Callable[[int, int, Words[Sight], Words[Flock], Words[Poses], Words[Store]], None]
"""(row, number of pairs, sight, flock, poses, store); adds to the sum."""


def moved(
    row: int, found: int, sight: Words[Sight], flock: Words[Flock], poses: Words[Poses], store: Words[Store]
) -> None:
    """Stand for the `FlockTerm` of a mechanism."""
    raise NotImplementedError


class FlockMechanism(KernelMechanism):
    """What both flockings share: they look at the neighbours' moving gradients, by default those of the poses.

    Attributes:
        term: what makes a movement of pairs, compiled with `part`.
        least_poses: number of poses that a row must have spread.

    """

    term = staticmethod(moved)
    least_poses: ClassVar[int] = 1
    see_bits: ClassVar[int] = c.SEE_MOVING | c.SKIP_OWN

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls._kernel = staticmethod(flock_rows.of(cls.term))

    def __init__(self, buffer: SoBuffer | OwnPoses, *, max_speed: float = 1.0, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        super().__init__(buffer, **options)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self.separation = self.a = self.b = self.epsilon = 1.0
        self.h = self.max_acceleration = 0.0
        self._flock: Packed[Flock] | None = None

    @property
    def _packed(self) -> Packed[Flock]:
        """The record of the mechanism, with room for as many boids as pairs."""
        if self._flock is None or len(self._flock.record.boids) < len(self._room.pairs):
            self._flock = FLOCK.pack(
                Flock(
                    least_poses=self.least_poses,
                    see_bits=self.see_bits,
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
                    own=np.zeros(3),
                    change=np.zeros(3),
                )
            )
        return self._flock


@template(moved)
def flock_rows(
    now: float,
    rows: Ints,
    vectors: Floats,
    active: Flags,
    sight: Words[Sight],
    flock: Words[Flock],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write the flocking movement of `rows` (R,) into those rows of `vectors` (N, D) and `active` (N,).

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    f, known = open_flock(flock), open_poses(poses).rows
    margins, room = (f.view_distance, f.view_distance, f.view_distance), len(open_sight(sight).pairs)
    for index in range(len(rows)):
        row = int(rows[index])
        f.total[:] = 0.0
        active[row] = known[row, c.ROW_POSES] >= f.least_poses
        if active[row]:
            found = gather(look_all_around(row, now, f.see_bits, margins, 0, sight, poses), sight, poses, store)
            if found > room:
                return index
            moved(row, found, sight, flock, poses, store)
            limit(f.total, 0.0, f.max_speed)
        for axis in range(vectors.shape[1]):
            vectors[row, axis] = f.total[axis]
    return len(rows)


def positive(mechanism: object, name: str, value: float) -> float:
    """Return `value` if it is positive and finite; raises ValueError with mechanism and parameter otherwise."""
    if not 0.0 < value < np.inf:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be positive and finite, got {value!r}")
    return float(value)
