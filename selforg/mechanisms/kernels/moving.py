"""How a row moves: the records of a movement, what the row looks at, sums over what it sees, and the limits of speed.

The movement rules, which sum what a row sees, are in `rules`.
"""

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Recording, Words, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, keep_ahead, look_all_around
from selforg.gradients.store.records import Look, Margins, Poses, Sight, Store, open_poses, open_sight
from selforg.randomness import next_direction

NO_ROOM = -1

# How far beyond its reach a gradient can make a rule different from zero
NOT_AT_ALL = 0
OWN_GOAL_RADIUS = 1  # as far as Balch and Ge repulsion: they are zero where the clearance exceeds the diffusion
VIEW_DISTANCE = 2


class Movements(NamedTuple):
    """The arrays to which a mechanism writes its answers."""

    vectors: Annotated[Floats, "K D", SCRATCH]  # [m/s], zero without a movement
    active: Annotated[Flags, "K", SCRATCH]  # whether there is a movement


class Steering(NamedTuple):
    """A movement rule with its parameters, the random directions of a `DirectionStream`, and room for a sum."""

    combination: int  # this and the next fields: see `MovementRule`
    formula: int
    looks_repulsive: int
    looks_neutral: int
    looks_attractive: int
    wakes_repulsive: int
    wakes_neutral: int
    wakes_attractive: int
    by_own_reach: int
    random: int
    ahead: int
    chooses: int
    see_bits: int  # SEE_ bits
    view_distance: float  # [m]
    min_speed: float  # [m/s]
    max_speed: float  # [m/s]
    angle_xy: float  # view angle to either side of the heading in the x-y plane [rad]
    angle_yz: float  # likewise in the y-z plane
    directions: Annotated[Floats, "N BLOCK 3", READ]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "N", KEPT]  # next direction of each row
    low: Annotated[Flags, "1", derived(True)]  # set when a row has used half of its directions
    total: Annotated[Floats, "3", SCRATCH]  # room for a sum


MOVEMENTS, STEERING = Recording(Movements), Recording(Steering)
open_movements, open_steering = MOVEMENTS.open, STEERING.open


class Own(NamedTuple):
    """The radii of the row that moves [m]; made in compiled code."""

    goal_radius: float
    reach: float


@inlined
def move_row(
    row: int,
    now: float,
    combination: Callable[..., bool],
    sight: Words[Sight],
    steering: Written[Steering],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write the movement of a row into the sum; `combination` takes a number, then what a `Combination` takes.

    Returns 1 if there is a movement, 0 if there is none, NO_ROOM if the room for pairs is too short.
    """
    m, p = open_steering(steering), open_poses(poses)
    m.total[:] = 0.0
    if p.rows[row, c.ROW_POSES] == 0:
        return 0
    goal_radius = p.own[row, 0, c.GOAL_RADIUS]
    own = Own(goal_radius, p.own[row, 0, c.DIFFUSION] + goal_radius)
    looks = m.looks_repulsive + m.looks_neutral + m.looks_attractive > 0
    found, moves = 0, False
    if looks:
        margins = margins_of(goal_radius, steering)
        found = gather(look_all_around(row, now, m.see_bits, margins, 0, sight, poses), sight, poses, store)
    if found > len(open_sight(sight).pairs):
        return NO_ROOM
    if m.ahead:
        found = keep_ahead(row, found, m.angle_xy, m.angle_yz, sight, poses)
    if found > 0 or not looks:
        moves = combination(m.combination, row, found, own, sight, steering)
    if not moves and m.wakes_repulsive + m.wakes_neutral + m.wakes_attractive > 0:
        moves = gather(look_for_one(row, now, steering, poses), sight, poses, store) > 0
    if moves:
        finish(row, own.reach, steering)
    return 1 if moves else 0


@inlined
def write_answer(place: int, moves: int, movements: Words[Movements], steering: Words[Steering]) -> None:
    """Write the sum into row `place` of `movements`, and whether it is a movement."""
    answers, total = open_movements(movements), open_steering(steering).total
    answers.active[place] = moves > 0
    for axis in range(answers.vectors.shape[1]):
        answers.vectors[place, axis] = total[axis]


@part
def margins_of(goal_radius: float, steering: Words[Steering]) -> Margins:
    """Return the margins [m] within which the rule can be different from zero, for an own `goal_radius` [m]."""
    m = open_steering(steering)
    return (
        margin(m.looks_repulsive, m.view_distance, goal_radius),
        margin(m.looks_neutral, m.view_distance, goal_radius),
        margin(m.looks_attractive, m.view_distance, goal_radius),
    )


@part
def margin(looks: int, view: float, goal_radius: float) -> float:
    """Return how far beyond its reach a gradient is looked at [m]."""
    if looks == NOT_AT_ALL:
        return -np.inf
    return min(view, goal_radius) if looks == OWN_GOAL_RADIUS else view


@part
def look_for_one(row: int, now: float, steering: Words[Steering], poses: Words[Poses]) -> Look:
    """Return the look of a row for any one gradient that makes the rule active though it adds nothing."""
    m, own = open_steering(steering), open_poses(poses).own
    margins = (
        m.view_distance if m.wakes_repulsive else -np.inf,
        m.view_distance if m.wakes_neutral else -np.inf,
        m.view_distance if m.wakes_attractive else -np.inf,
    )
    return Look(row, 0, 1, now, m.see_bits, margins, own[row, 0, c.X], own[row, 0, c.Y], own[row, 0, c.Z])


@part
def finish(row: int, own_reach: float, steering: Written[Steering]) -> None:
    """Limit the sum: repulsions among robots to the own reach, all others to their speeds."""
    m = open_steering(steering)
    if m.by_own_reach:
        limit(m.total, 0.0, own_reach)
        return
    if m.random and m.total[0] == 0.0 and m.total[1] == 0.0 and m.total[2] == 0.0:
        x, y, z = next_direction(m.directions, m.cursor, m.low, row)
        m.total[0], m.total[1], m.total[2] = x * m.max_speed, y * m.max_speed, z * m.max_speed
    limit(m.total, m.min_speed, m.max_speed)


@part
def add(index: int, length: float, full: float, row: int, sight: Words[Sight], steering: Written[Steering]) -> None:
    """Add a contribution of `length` along the offset of a pair to the sum; -inf becomes `full` [m] away.

    Where the centres coincide there is no offset, and the direction is random.
    """
    if length == 0.0:
        return
    m, pairs = open_steering(steering), open_sight(sight).pairs
    if np.isinf(length):
        length = -full
    distance = pairs[index, c.PAIR_DISTANCE]
    if distance > 0.0:
        scale = length / distance
        m.total[0] += scale * pairs[index, c.PAIR_DX]
        m.total[1] += scale * pairs[index, c.PAIR_DY]
        m.total[2] += scale * pairs[index, c.PAIR_DZ]
    else:
        x, y, z = next_direction(m.directions, m.cursor, m.low, row)
        m.total[0] += abs(length) * x
        m.total[1] += abs(length) * y
        m.total[2] += abs(length) * z


@part
def full_length(index: int, sight: Words[Sight]) -> float:
    """Return the length [m] of full repulsion: the reach of the gradient, 1 where that is infinite (Q2)."""
    pairs = open_sight(sight).pairs
    reach = pairs[index, c.PAIR_DIFFUSION] + pairs[index, c.PAIR_GOAL_RADIUS]
    return reach if np.isfinite(reach) else 1.0


@part
def limit(total: Floats, lowest: float, highest: float) -> None:
    """Bring the length of `total` (3,) into [`lowest`, `highest`] in place; a zero vector stays zero."""
    # components are divided by the largest one first, so that no square overflows
    largest = max(abs(total[0]), abs(total[1]), abs(total[2]))
    if largest == 0.0:
        return
    x, y, z = total[0] / largest, total[1] / largest, total[2] / largest
    unit_length = np.sqrt(x * x + y * y + z * z)
    length = largest * unit_length
    wanted = min(max(length, lowest), highest)
    if wanted != length:
        scale = wanted / unit_length
        total[0], total[1], total[2] = x * scale, y * scale, z * scale
