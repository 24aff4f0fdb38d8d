"""Flocking of Reynolds (1987), doi:10.1145/37401.37406."""

from typing import Unpack

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel, part
from selforg.compiler.records import Handle, Written
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import Own
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.mechanisms.base import MECHANISMS, MoveOptions
from selforg.mechanisms.flocking import BOID_COLUMNS, BOID_GOAL_RADIUS, BOID_OFFSET, BOID_VELOCITY
from selforg.mechanisms.formula import NeighbourMechanism
from selforg.mechanisms.movement import Rule, open_rule
from selforg.parameters import at_least, positive
from selforg.randomness import next_direction

SEPARATION = 0  # the only parameter of the formula


@MECHANISMS.register
class FlockingReynolds(NeighbourMechanism):
    """Separation + cohesion + alignment of Reynolds (1987), doi:10.1145/37401.37406, capped at max_speed.

    The terms are not normalised, and alignment is the plain difference of headings (Q30). separation: weight r of
    1 / (r * clearance) [1/m2].
    """

    alone = True
    boid_columns = BOID_COLUMNS

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        separation: float = 1.0,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, **options)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self.parameters = np.array([positive(self, "separation", separation)])

    @staticmethod
    @part
    def combine(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Written[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        """Add separation + cohesion + alignment to the sum."""
        newest, m = open_poses(poses).own, open_rule(rule)
        note_headings(found, sight, rule, poses, store)
        separation(found, own.goal_radius, own.reach, row, rule)
        m.velocity[:] = 0.0
        mean_difference(found, BOID_OFFSET, m.velocity, rule)
        mean_difference(found, BOID_VELOCITY, newest[row, 0, c.POSE_HEADING : c.POSE_HEADING + 3], rule)
        return True


@kernel
def separation(count: int, own_goal: float, full: float, row: int, rule: Written[Rule]) -> None:
    """Add to the sum unit vectors away from each of `count` boids, weighted by 1 / (r * clearance); Reynolds (1987).

    Overlapping boids count `full` [m] away (deviation Q12: the original draws from the positive octant).
    """
    m = open_rule(rule)
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += m.boids[index, BOID_OFFSET + axis] ** 2
        distance = np.sqrt(squared)
        clearance = distance - own_goal - m.boids[index, BOID_GOAL_RADIUS]
        weight = full
        if clearance > 0.0:
            weight = 1.0 / (m.parameters[SEPARATION] * clearance)
        if distance > 0.0:
            for axis in range(3):
                m.total[axis] -= weight * m.boids[index, BOID_OFFSET + axis] / distance
        else:
            x, y, z = next_direction(m.directions, m.cursor, m.low, row)
            m.total[0] += weight * x
            m.total[1] += weight * y
            m.total[2] += weight * z


@kernel
def mean_difference(count: int, column: int, own: Floats, rule: Handle[Rule]) -> None:
    """Add to the sum the mean of three columns of `count` boids minus `own` (3,): alignment or cohesion."""
    m = open_rule(rule)
    for axis in range(3):
        mean = 0.0
        for index in range(count):
            mean += m.boids[index, column + axis] / count
        if count > 0:
            m.total[axis] += mean - own[axis]


@part
def note_headings(
    found: int, sight: Handle[Sight], rule: Handle[Rule], poses: Handle[Poses], store: Handle[Store]
) -> None:
    """Write the first `found` pairs as boids with headings."""
    pairs, boids, own = open_sight(sight).pairs, open_rule(rule).boids, open_poses(poses).own
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
