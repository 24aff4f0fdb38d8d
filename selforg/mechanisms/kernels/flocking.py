"""Flocking: the terms of Reynolds (1987) and Olfati-Saber (2006, doi:10.1109/TAC.2005.864190), and their kernel.

A boid is a row of a table, float64 (M, BOID_COLUMNS): its offset from the robot [m], its velocity [m/s] (Olfati-Saber)
or unit heading (Reynolds), its goal radius [m].
"""

import numpy as np

from selforg.arrays import Flags, Floats, Ints, Links
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import kernel, part
from selforg.gradients.store.candidates import store_of
from selforg.gradients.store.columns import (
    DIFFUSION,
    DX,
    GOAL,
    HX,
    LAYER,
    PAIR_GOAL,
    PHX,
    POSE_STAMP,
    POSES,
    SLOT,
    SOURCE,
    STAMP,
    X,
)
from selforg.gradients.store.gathering import gather
from selforg.gradients.store.pose_cells import poses_of
from selforg.mechanisms.kernels.rules import limit
from selforg.randomness import take_direction
from selforg.space import nearest_image

OFFSET, VELOCITY, BOID_GOAL = 0, 3, 6
BOID_COLUMNS = 7

# Parameters, float64 (FLOCK_PARAMETERS,)
VIEW, MAX_SPEED, SEPARATION, EPSILON, A, B, H, MAX_ACCELERATION = 0, 1, 2, 3, 4, 5, 6, 7
FLOCK_PARAMETERS = 8

SHORTEST_TIME = 1e-6
"""Two poses count as at least so far apart in time [s]: stamps may differ by less than a velocity can bear."""


@kernel
def sigma_norm(squared: float, epsilon: float) -> float:
    """Return the sigma-norm of a vector of squared length `squared` [m2], smooth at zero; Olfati-Saber (2006)."""
    return float((np.sqrt(1.0 + epsilon * squared) - 1.0) / epsilon)


@kernel
def bump(z: float, h: float) -> float:
    """Return the bump function: 1 below `h`, falling smoothly to 0 at 1."""
    if 0.0 <= z < h:
        return 1.0
    if h <= z <= 1.0:
        return float(0.5 * (1.0 + np.cos(np.pi * (z - h) / (1.0 - h))))
    return 0.0


@kernel
def adjacency(squared: float, epsilon: float, h: float, view: float) -> float:
    """Return the spatial adjacency [-] of two boids at squared distance `squared` [m2]; `view` is their range [m]."""
    return bump(sigma_norm(squared, epsilon) / sigma_norm(view * view, epsilon), h)


@kernel
def action(
    squared: float, epsilon: float, a: float, b: float, h: float, avoidance_distance: float, view: float
) -> float:
    """Return the action function: negative closer than `avoidance_distance` [m], positive farther, 0 beyond `view`."""
    z = sigma_norm(squared, epsilon)
    c = abs(a - b) / np.sqrt(4.0 * a * b)
    shifted = z - sigma_norm(avoidance_distance * avoidance_distance, epsilon) + c
    pull = 0.5 * ((a + b) * shifted / np.sqrt(1.0 + shifted * shifted) + (a - b))
    return float(bump(z / sigma_norm(view * view, epsilon), h) * pull)


@kernel
def olfati_saber(
    boids: Floats, count: int, velocity: Floats, parameters: Floats, avoidance_distance: float, gradient: Floats,
    consensus: Floats,
) -> None:  # fmt: skip
    """Add gradient term and velocity consensus over `boids` (M, BOID_COLUMNS) to (3,) each; algorithm 1."""
    epsilon, h, view = parameters[EPSILON], parameters[H], parameters[VIEW]
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += boids[index, OFFSET + axis] ** 2
        pull = action(squared, epsilon, parameters[A], parameters[B], h, avoidance_distance, view)
        weight = adjacency(squared, epsilon, h, view)
        for axis in range(3):
            gradient[axis] += pull * boids[index, OFFSET + axis] / np.sqrt(1.0 + epsilon * squared)
            consensus[axis] += weight * (boids[index, VELOCITY + axis] - velocity[axis])


@kernel
def separation(
    boids: Floats, count: int, own_goal: float, r: float, full: float, row: int, drawn: Floats, cursor: Ints,
    total: Floats,
) -> None:  # fmt: skip
    """Add to `total` (3,) unit vectors away from each boid, weighted by 1 / (r * clearance); Reynolds (1987).

    Overlapping boids count `full` [m] away (deviation Q12: the original draws from the positive octant).
    """
    for index in range(count):
        squared = 0.0
        for axis in range(3):
            squared += boids[index, OFFSET + axis] ** 2
        distance = np.sqrt(squared)
        clearance = distance - own_goal - boids[index, BOID_GOAL]
        weight = full
        if clearance > 0.0:
            weight = 1.0 / (r * clearance)
        if distance > 0.0:
            for axis in range(3):
                total[axis] -= weight * boids[index, OFFSET + axis] / distance
        else:
            x, y, z = take_direction(drawn, cursor, row)
            total[0], total[1], total[2] = total[0] + weight * x, total[1] + weight * y, total[2] + weight * z


@kernel
def mean_difference(boids: Floats, count: int, column: int, own: Floats, total: Floats) -> None:
    """Add to `total` (3,) the mean of three columns of the boids minus `own` (3,): alignment or cohesion."""
    for axis in range(3):
        mean = 0.0
        for index in range(count):
            mean += boids[index, column + axis] / count
        if count > 0:
            total[axis] += mean - own[axis]


@kernel
def flock_rows(
    begin: int, reynolds: bool, now: float, see: int, rows: Ints, places: Ints, channels: Ints, parameters: Floats,
    poses: Bundle, store: Bundle, drawn: Floats, cursor: Ints, pairs: Floats, boids: Floats, vectors: Floats,
    active: Flags,
) -> tuple[int, bool]:  # fmt: skip
    """Write the flocking movement of rows[begin:] (R,) into the rows `places` (R,) of `vectors` and `active`.

    boids: room for as many as `pairs`. Returns how many rows are done, fewer than R if `pairs` is too short, and
    whether some row's directions run low.
    """
    pose_tables, tables = poses_of(poses), store_of(store)
    own, known, extent = pose_tables[0], pose_tables[1], pose_tables[5]
    links, far, marks = tables[1], tables[2], tables[3]
    view, low = parameters[VIEW], False
    for index in range(begin, len(rows)):
        row = int(rows[index])
        total = np.zeros(3)
        place = places[index]
        active[place] = known[row, POSES] >= (1 if reynolds else 2)
        if active[place]:
            found = gather(row, (view, view, view), see, len(pairs) + 1, now, channels, poses, store, pairs)
            if found > len(pairs):
                return index, low
            if reynolds:
                count = note_headings(pairs, found, own, far, boids)
                move_reynolds(row, boids, count, parameters, own, drawn, cursor, total)
            else:
                count = note_velocities(pairs, found, own, links, far, marks, extent, boids)
                move_olfati_saber(row, boids, count, parameters, own, extent, total)
            limit(total, 0.0, parameters[MAX_SPEED])
        for axis in range(vectors.shape[1]):
            vectors[place, axis] = total[axis]
        low |= 2 * cursor[row] >= drawn.shape[1]
    return len(rows), low


@kernel
def move_reynolds(
    row: int, boids: Floats, count: int, parameters: Floats, own: Floats, drawn: Floats, cursor: Ints, total: Floats
) -> None:
    """Put separation + cohesion + alignment into `total` (3,)."""
    own_goal, reach = own[row, 0, GOAL], own[row, 0, DIFFUSION] + own[row, 0, GOAL]
    separation(boids, count, own_goal, parameters[SEPARATION], reach, row, drawn, cursor, total)
    mean_difference(boids, count, OFFSET, np.zeros(3), total)
    mean_difference(boids, count, VELOCITY, own[row, 0, PHX : PHX + 3], total)


@kernel
def move_olfati_saber(
    row: int, boids: Floats, count: int, parameters: Floats, own: Floats, extent: Floats, total: Floats
) -> None:
    """Put own velocity + limited acceleration into `total` (3,); the avoidance distance is the own reach."""
    velocity, gradient = np.zeros(3), np.zeros(3)
    elapsed = max(own[row, 0, POSE_STAMP] - own[row, 1, POSE_STAMP], SHORTEST_TIME)
    for axis in range(3):
        velocity[axis] = nearest_image(own[row, 0, X + axis] - own[row, 1, X + axis], extent[axis]) / elapsed
    reach = own[row, 0, DIFFUSION] + own[row, 0, GOAL]
    olfati_saber(boids, count, velocity, parameters, reach, gradient, gradient)
    limit(gradient, 0.0, parameters[MAX_ACCELERATION])
    for axis in range(3):
        total[axis] = velocity[axis] + gradient[axis]


@part
def note_headings(pairs: Floats, found: int, own: Floats, far: Floats, boids: Floats) -> int:
    """Make boids (M, BOID_COLUMNS) with headings of the first `found` pairs; return how many."""
    rows = len(own)
    for index in range(found):
        slot = int(pairs[index, SLOT])
        for axis in range(3):
            boids[index, OFFSET + axis] = pairs[index, DX + axis]
            if slot >= 0:
                boids[index, VELOCITY + axis] = far[slot, HX + axis]
            else:
                boids[index, VELOCITY + axis] = own[(-1 - slot) % rows, (-1 - slot) // rows, PHX + axis]
        boids[index, BOID_GOAL] = pairs[index, PAIR_GOAL]
    return found


@part
def note_velocities(
    pairs: Floats, found: int, own: Floats, links: Links, far: Floats, marks: Links, extent: Floats, boids: Floats
) -> int:
    """Make boids (M, BOID_COLUMNS) of the sources with two or more of the first `found` pairs; return how many.

    Position: the newest; velocity: from the oldest to the newest that is in view.
    """
    count = 0
    for index in range(found):
        source, stamp = spreader(pairs, index, own, links, marks), stamp_of(pairs, index, own, far)
        oldest, oldest_stamp, newest = index, stamp, True
        for other in range(found):
            if other != index and spreader(pairs, other, own, links, marks) == source:
                other_stamp = stamp_of(pairs, other, own, far)
                newest = newest and other_stamp < stamp
                if other_stamp < oldest_stamp:
                    oldest, oldest_stamp = other, other_stamp
        if not newest or oldest == index:
            continue
        for axis in range(3):
            moved = nearest_image(pairs[index, DX + axis] - pairs[oldest, DX + axis], extent[axis])
            boids[count, OFFSET + axis] = pairs[index, DX + axis]
            boids[count, VELOCITY + axis] = moved / max(stamp - oldest_stamp, SHORTEST_TIME)
        boids[count, BOID_GOAL] = pairs[index, PAIR_GOAL]
        count += 1
    return count


@part
def spreader(pairs: Floats, index: int, own: Floats, links: Links, marks: Links) -> tuple[int, int]:
    """Return what tells the histories of a pair's table apart: layer (-1: shared poses) and source."""
    slot = int(pairs[index, SLOT])
    if slot >= 0:
        return int(links[slot, LAYER]), int(marks[slot, SOURCE])
    return -1, (-1 - slot) % len(own)


@part
def stamp_of(pairs: Floats, index: int, own: Floats, far: Floats) -> float:
    """Return when the gradient of a pair was spread [s]."""
    slot = int(pairs[index, SLOT])
    if slot >= 0:
        return float(far[slot, STAMP])
    return float(own[(-1 - slot) % len(own), (-1 - slot) // len(own), POSE_STAMP])
