"""Flocking of Reynolds (1987), doi:10.1145/37401.37406."""

from typing import Unpack

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel, part
from selforg.compiler.records import Words, Written
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.mechanisms.base import MECHANISMS, MoveOptions
from selforg.mechanisms.boids import (
    BOID_GOAL_RADIUS,
    BOID_OFFSET,
    BOID_VELOCITY,
    Flock,
    FlockMechanism,
    open_flock,
    positive,
)
from selforg.randomness import next_direction


@MECHANISMS.register
class FlockingReynolds(FlockMechanism):
    """Separation + cohesion + alignment of Reynolds (1987), doi:10.1145/37401.37406, capped at max_speed.

    The terms are not normalised, and alignment is the plain difference of headings (Q30). separation: weight r of
    1 / (r * clearance) [1/m2].
    """

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

    @staticmethod
    @part
    def term(
        row: int, found: int, sight: Words[Sight], flock: Written[Flock], poses: Words[Poses], store: Words[Store]
    ) -> None:
        """Add separation + cohesion + alignment to the sum."""
        own, f = open_poses(poses).own, open_flock(flock)
        note_headings(found, sight, flock, poses, store)
        own_goal, reach = own[row, 0, c.GOAL_RADIUS], own[row, 0, c.DIFFUSION] + own[row, 0, c.GOAL_RADIUS]
        separation(found, own_goal, reach, row, flock)
        f.own[:] = 0.0
        mean_difference(found, BOID_OFFSET, f.own, flock)
        mean_difference(found, BOID_VELOCITY, own[row, 0, c.POSE_HEADING : c.POSE_HEADING + 3], flock)


@kernel
def separation(count: int, own_goal: float, full: float, row: int, flock: Written[Flock]) -> None:
    """Add to the sum unit vectors away from each of `count` boids, weighted by 1 / (r * clearance); Reynolds (1987).

    Overlapping boids count `full` [m] away (deviation Q12: the original draws from the positive octant).
    """
    f = open_flock(flock)
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += f.boids[index, BOID_OFFSET + axis] ** 2
        distance = np.sqrt(squared)
        clearance = distance - own_goal - f.boids[index, BOID_GOAL_RADIUS]
        weight = full
        if clearance > 0.0:
            weight = 1.0 / (f.separation * clearance)
        if distance > 0.0:
            for axis in range(3):
                f.total[axis] -= weight * f.boids[index, BOID_OFFSET + axis] / distance
        else:
            x, y, z = next_direction(f.directions, f.cursor, f.low, row)
            f.total[0] += weight * x
            f.total[1] += weight * y
            f.total[2] += weight * z


@kernel
def mean_difference(count: int, column: int, own: Floats, flock: Words[Flock]) -> None:
    """Add to the sum the mean of three columns of `count` boids minus `own` (3,): alignment or cohesion."""
    f = open_flock(flock)
    for axis in range(3):
        mean = 0.0
        for index in range(count):
            mean += f.boids[index, column + axis] / count
        if count > 0:
            f.total[axis] += mean - own[axis]


@part
def note_headings(
    found: int, sight: Words[Sight], flock: Words[Flock], poses: Words[Poses], store: Words[Store]
) -> None:
    """Write the first `found` pairs as boids with headings."""
    pairs, boids, own = open_sight(sight).pairs, open_flock(flock).boids, open_poses(poses).own
    far, rows = open_store(store).far, len(own)
    for index in range(found):
        slot = int(pairs[index, c.PAIR_SLOT])
        for axis in range(3):
            boids[index, BOID_OFFSET + axis] = pairs[index, c.PAIR_DX + axis]
            if slot >= 0:
                boids[index, BOID_VELOCITY + axis] = far[slot, c.FAR_HEADING + axis]
            else:
                shared = own[(-1 - slot) % rows, (-1 - slot) // rows, c.POSE_HEADING + axis]
                boids[index, BOID_VELOCITY + axis] = shared
        boids[index, BOID_GOAL_RADIUS] = pairs[index, c.PAIR_GOAL_RADIUS]
