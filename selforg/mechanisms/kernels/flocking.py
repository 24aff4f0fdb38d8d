"""Flocking: the terms of Reynolds (1987) and Olfati-Saber (2006, doi:10.1109/TAC.2005.864190), and their kernel.

A boid is a row of a table, float64 (M, BOID_COLUMNS): its offset from the robot [m], its velocity [m/s] (Olfati-Saber)
or unit heading (Reynolds), its goal radius [m].
"""

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.compiler.decorators import kernel, part
from selforg.compiler.records import Recording, Words, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.mechanisms.kernels.flocking_terms import action, adjacency
from selforg.mechanisms.kernels.moving import Movements, limit, open_movements
from selforg.randomness import next_direction
from selforg.space import nearest_image

BOID_OFFSET = 0  # and the two columns after it [m]
BOID_VELOCITY = 3  # and the two columns after it [m/s], or a heading [-]
BOID_GOAL_RADIUS = 6  # [m]
BOID_COLUMNS = 7


class Flock(NamedTuple):
    """The parameters of a flocking rule, the random directions of a `DirectionStream`, and room for boids."""

    reynolds: int  # 1: Reynolds, 0: Olfati-Saber
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


FLOCK = Recording(Flock)
open_flock = FLOCK.open

SHORTEST_TIME = 1e-6
"""Least time [s] that two poses count as apart, so that no velocity becomes infinite."""


@kernel
def olfati_saber(
    count: int, velocity: Floats, avoidance_distance: float, gradient: Floats, consensus: Floats, flock: Words[Flock]
) -> None:
    """Add gradient term and velocity consensus over `count` boids to (3,) each; algorithm 1."""
    f = open_flock(flock)
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += f.boids[index, BOID_OFFSET + axis] ** 2
        pull = action(squared, f.epsilon, f.a, f.b, f.h, avoidance_distance, f.view_distance)
        weight = adjacency(squared, f.epsilon, f.h, f.view_distance)
        for axis in range(3):
            gradient[axis] += pull * f.boids[index, BOID_OFFSET + axis] / np.sqrt(1.0 + f.epsilon * squared)
            consensus[axis] += weight * (f.boids[index, BOID_VELOCITY + axis] - velocity[axis])


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


@kernel
def flock_rows(
    now: float,
    rows: Ints,
    places: Ints,
    movements: Words[Movements],
    sight: Words[Sight],
    flock: Written[Flock],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write the flocking movement of `rows` (R,) into the rows `places` (R,) of `movements`.

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    f, known, answers = open_flock(flock), open_poses(poses).rows, open_movements(movements)
    margins, room = (f.view_distance, f.view_distance, f.view_distance), len(open_sight(sight).pairs)
    for index in range(len(rows)):
        row, place = int(rows[index]), places[index]
        f.total[:] = 0.0
        answers.active[place] = known[row, c.ROW_POSES] >= (1 if f.reynolds else 2)
        if answers.active[place]:
            found = gather(look_all_around(row, now, f.see_bits, margins, 0, sight, poses), sight, poses, store)
            if found > room:
                return index
            if f.reynolds:
                move_reynolds(row, note_headings(found, sight, flock, poses, store), flock, poses)
            else:
                move_olfati_saber(row, note_velocities(found, sight, flock, poses, store), flock, poses)
            limit(f.total, 0.0, f.max_speed)
        for axis in range(answers.vectors.shape[1]):
            answers.vectors[place, axis] = f.total[axis]
    return len(rows)


@kernel
def move_reynolds(row: int, count: int, flock: Written[Flock], poses: Words[Poses]) -> None:
    """Add separation + cohesion + alignment to the sum."""
    own = open_poses(poses).own
    own_goal, reach = own[row, 0, c.GOAL_RADIUS], own[row, 0, c.DIFFUSION] + own[row, 0, c.GOAL_RADIUS]
    separation(count, own_goal, reach, row, flock)
    mean_difference(count, BOID_OFFSET, np.zeros(3), flock)
    mean_difference(count, BOID_VELOCITY, own[row, 0, c.POSE_HEADING : c.POSE_HEADING + 3], flock)


@kernel
def move_olfati_saber(row: int, count: int, flock: Words[Flock], poses: Words[Poses]) -> None:
    """Set the sum to own velocity + limited acceleration; the avoidance distance is the own reach."""
    p, f = open_poses(poses), open_flock(flock)
    velocity, gradient = np.zeros(3), np.zeros(3)
    elapsed = max(p.own[row, 0, c.POSE_STAMP] - p.own[row, 1, c.POSE_STAMP], SHORTEST_TIME)
    for axis in range(3):
        moved = nearest_image(p.own[row, 0, c.X + axis] - p.own[row, 1, c.X + axis], p.extent[axis])
        velocity[axis] = moved / elapsed
    reach = p.own[row, 0, c.DIFFUSION] + p.own[row, 0, c.GOAL_RADIUS]
    olfati_saber(count, velocity, reach, gradient, gradient, flock)
    limit(gradient, 0.0, f.max_acceleration)
    for axis in range(3):
        f.total[axis] = velocity[axis] + gradient[axis]


@part
def note_headings(
    found: int, sight: Words[Sight], flock: Words[Flock], poses: Words[Poses], store: Words[Store]
) -> int:
    """Write the first `found` pairs as boids with headings; return how many there are."""
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
    return found


@part
def note_velocities(
    found: int, sight: Words[Sight], flock: Words[Flock], poses: Words[Poses], store: Words[Store]
) -> int:
    """Write the sources that have two or more of the first `found` pairs as boids; return how many there are.

    The position is the newest one, the velocity that from the oldest to the newest one in view.
    """
    pairs, boids, extent = open_sight(sight).pairs, open_flock(flock).boids, open_poses(poses).extent
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
def spreader(slot: int, poses: Words[Poses], store: Words[Store]) -> tuple[int, int]:
    """Return what identifies the history to which a pair's `slot` belongs: layer (-1: shared poses) and source."""
    if slot >= 0:
        s = open_store(store)
        return int(s.links[slot, c.LINK_LAYER]), int(s.marks[slot, c.MARK_SOURCE])
    return -1, (-1 - slot) % len(open_poses(poses).own)


@part
def stamp_of(slot: int, poses: Words[Poses], store: Words[Store]) -> float:
    """Return when the gradient of a pair's `slot` was spread [s]."""
    if slot >= 0:
        return float(open_store(store).far[slot, c.FAR_STAMP])
    own = open_poses(poses).own
    return float(own[(-1 - slot) % len(own), (-1 - slot) // len(own), c.POSE_STAMP])
