"""Flocking of Olfati-Saber (2006), doi:10.1109/TAC.2005.864190, and the boids of both flockings.

A boid is a row of a table, float64 (M, BOID_COLUMNS): its offset from the robot [m], its velocity [m/s] (Olfati-Saber)
or unit heading (Reynolds), its goal radius [m].
"""

from typing import Unpack

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel, part
from selforg.compiler.records import Handle
from selforg.elementary import sine_cosine
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import Own
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.mechanisms.base import MECHANISMS, MoveOptions
from selforg.mechanisms.formula import NeighbourMechanism
from selforg.mechanisms.movement import Rule, limit, open_rule
from selforg.parameters import at_least, positive
from selforg.space import nearest_image

BOID_OFFSET = 0  # and the two columns after it [m]
BOID_VELOCITY = 3  # and the two columns after it [m/s], or a heading [-]
BOID_GOAL_RADIUS = 6  # [m]
BOID_COLUMNS = 7

STEEPNESS_A, STEEPNESS_B, EPSILON, BUMP_BEGIN, MAX_ACCELERATION = range(5)
"""Parameters of the formula."""

SHORTEST_TIME = 1e-6
"""Least time [s] that two poses count as apart, so that no velocity becomes infinite."""


@MECHANISMS.register
class Flocking(NeighbourMechanism):
    """Algorithm 1 of Olfati-Saber (2006), doi:10.1109/TAC.2005.864190, as intended (deviation Q6).

    a, b: steepness of the action function, 0 < a <= b; epsilon: of the sigma-norm; h: where the bump begins to fall,
    in (0, 1); max_acceleration [m/s2] caps the sum of both terms. Inactive until a row has spread two poses.
    """

    alone = True
    boid_columns = BOID_COLUMNS
    least_poses = 2
    sight_bits = c.SEE_MOVING | c.SKIP_OWN | c.SEE_HISTORY

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
        super().__init__(buffer, **options)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        if not 0.0 <= h < 1.0:
            raise ValueError(f"Flocking: h must lie in [0, 1), got {h!r}")
        positive(self, "view_distance", self.view_distance)
        steepness = positive(self, "a", a), positive(self, "b", b)
        highest = at_least(self, "max_acceleration", max_acceleration, 0.0)
        self.parameters = np.array([*steepness, positive(self, "epsilon", epsilon), h, highest])

    @staticmethod
    @part
    def combine(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Handle[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        """Set the sum to own velocity + limited acceleration; the avoidance distance is the own reach."""
        p, m = open_poses(poses), open_rule(rule)
        count = note_velocities(found, sight, rule, poses, store)
        elapsed = max(p.own[row, 0, c.POSE_STAMP] - p.own[row, 1, c.POSE_STAMP], SHORTEST_TIME)
        for axis in range(3):
            passed = nearest_image(p.own[row, 0, c.X + axis] - p.own[row, 1, c.X + axis], p.extent[axis])
            m.velocity[axis] = passed / elapsed
            m.change[axis] = 0.0
        olfati_saber(count, m.velocity, own.reach, m.change, m.change, rule)
        limit(m.change, 0.0, m.parameters[MAX_ACCELERATION])
        for axis in range(3):
            m.total[axis] = m.velocity[axis] + m.change[axis]
        return True


@kernel
def olfati_saber(
    count: int, velocity: Floats, avoidance_distance: float, gradient: Floats, consensus: Floats, rule: Handle[Rule]
) -> None:
    """Add gradient term and velocity consensus over `count` boids to (3,) each; algorithm 1."""
    m = open_rule(rule)
    a, b = m.parameters[STEEPNESS_A], m.parameters[STEEPNESS_B]
    epsilon, h = m.parameters[EPSILON], m.parameters[BUMP_BEGIN]
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += m.boids[index, BOID_OFFSET + axis] ** 2
        pull = action(squared, epsilon, a, b, h, avoidance_distance, m.view_distance)
        weight = adjacency(squared, epsilon, h, m.view_distance)
        for axis in range(3):
            gradient[axis] += pull * m.boids[index, BOID_OFFSET + axis] / np.sqrt(1.0 + epsilon * squared)
            consensus[axis] += weight * (m.boids[index, BOID_VELOCITY + axis] - velocity[axis])


@part
def sigma_norm(squared: float, epsilon: float) -> float:
    """Return the sigma-norm of a vector of squared length `squared` [m2], smooth at zero; Olfati-Saber (2006)."""
    return float((np.sqrt(1.0 + epsilon * squared) - 1.0) / epsilon)


@part
def bump(z: float, h: float) -> float:
    """Return the bump function: 1 below `h`, falling smoothly to 0 at 1."""
    if 0.0 <= z < h:
        return 1.0
    if h <= z <= 1.0:
        return 0.5 * (1.0 + sine_cosine(np.pi * (z - h) / (1.0 - h))[1])
    return 0.0


@part
def adjacency(squared: float, epsilon: float, h: float, view: float) -> float:
    """Return the spatial adjacency [-] of two boids at squared distance `squared` [m2]; `view` is their range [m]."""
    return bump(sigma_norm(squared, epsilon) / sigma_norm(view * view, epsilon), h)


@part
def action(
    squared: float, epsilon: float, a: float, b: float, h: float, avoidance_distance: float, view: float
) -> float:
    """Return the action function: negative closer than `avoidance_distance` [m], positive farther, 0 beyond `view`."""
    z = sigma_norm(squared, epsilon)
    c = abs(a - b) / np.sqrt(4.0 * a * b)
    shifted = z - sigma_norm(avoidance_distance * avoidance_distance, epsilon) + c
    pull = 0.5 * ((a + b) * shifted / np.sqrt(1.0 + shifted * shifted) + (a - b))
    return float(bump(z / sigma_norm(view * view, epsilon), h) * pull)


@part
def note_velocities(
    found: int, sight: Handle[Sight], rule: Handle[Rule], poses: Handle[Poses], store: Handle[Store]
) -> int:
    """Write the sources that have two or more of the first `found` pairs as boids; return how many there are.

    The position is the newest one, the velocity that from the oldest to the newest one in view.
    """
    pairs, boids, extent = open_sight(sight).pairs, open_rule(rule).boids, open_poses(poses).extent
    count = 0
    for index in range(found):
        slot = int(pairs[index, c.PAIR_SLOT])
        source, stamp = spreader(slot, poses, store), stamp_of(slot, poses, store)
        oldest, oldest_stamp, newest = index, stamp, True
        for other in range(found):
            other_slot = int(pairs[other, c.PAIR_SLOT])
            if other != index and spreader(other_slot, poses, store) == source:
                other_stamp = stamp_of(other_slot, poses, store)
                newest = newest and other_stamp < stamp
                if other_stamp < oldest_stamp:
                    oldest, oldest_stamp = other, other_stamp
        if not newest or oldest == index:
            continue
        for axis in range(3):
            delta = pairs[index, c.PAIR_DX + axis] - pairs[oldest, c.PAIR_DX + axis]
            moved = nearest_image(delta, extent[axis])
            boids[count, BOID_OFFSET + axis] = pairs[index, c.PAIR_DX + axis]
            boids[count, BOID_VELOCITY + axis] = moved / max(stamp - oldest_stamp, SHORTEST_TIME)
        boids[count, BOID_GOAL_RADIUS] = pairs[index, c.PAIR_GOAL_RADIUS]
        count += 1
    return count


@part
def spreader(slot: int, poses: Handle[Poses], store: Handle[Store]) -> tuple[int, int]:
    """Return what identifies the history to which a pair's `slot` belongs: layer (-1: shared poses) and source."""
    if slot >= 0:
        s = open_store(store)
        return int(s.links[slot, c.LINK_LAYER]), int(s.marks[slot, c.MARK_SOURCE])
    return -1, (-1 - slot) % len(open_poses(poses).own)


@part
def stamp_of(slot: int, poses: Handle[Poses], store: Handle[Store]) -> float:
    """Return when the gradient of a pair's `slot` was spread [s]."""
    if slot >= 0:
        return float(open_store(store).far[slot, c.FAR_STAMP])
    own = open_poses(poses).own
    return float(own[(-1 - slot) % len(own), (-1 - slot) // len(own), c.POSE_STAMP])
