"""The kernel of movement mechanisms: a row's query, the sum over the pairs that it sees, and the limits of speed.

Every formula has a kernel of its own: a copy of `move_rows` that calls what its mechanism makes of pairs.
"""

from collections.abc import Callable
from typing import Annotated, Final, NamedTuple, TypeAlias

import numpy as np

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.commands import Moved, open_moved
from selforg.compiler.decorators import part, template
from selforg.compiler.records import Handle, Written, opening
from selforg.gradients.pair import Own, Pair, own_of
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, keep_ahead, look_all_around
from selforg.gradients.store.records import Look, Margins, Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.randomness import next_direction

# How far beyond its reach a gradient can make a movement different from zero
NOT_AT_ALL = 0
OWN_GOAL_RADIUS = 1  # as far as Balch and Ge repulsion: they are zero where the clearance exceeds the diffusion
VIEW_DISTANCE = 2

# What walls do to a movement
WALLS_IGNORED, REPEL, REFLECT = 0, 1, 2
WALL_REACH: Final = 0.6
"""Distance of a wall within which it repels or reflects [m]; robots still reach an item in a corner."""
WALL_CONTACT: Final = 0.3
"""Distance within which it repels fully [m]."""

Signs: TypeAlias = tuple[int, int, int]
"""One number for each attraction: -1, 0, +1."""
ALL_IN_VIEW: Signs = (VIEW_DISTANCE, VIEW_DISTANCE, VIEW_DISTANCE)
ATTRACTIVE_AND_NEAR_REPULSIVE: Signs = (OWN_GOAL_RADIUS, NOT_AT_ALL, VIEW_DISTANCE)
BY_REPULSIVE: Signs = (1, 0, 0)  # which gradients in view make a mechanism active
BY_ANY: Signs = (1, 1, 1)


class Rule(NamedTuple):
    """The parameters of a `FormulaMechanism`, the random directions of a `DirectionStream`, and room for sums."""

    looks: Annotated[Ints, "3", READ]  # this and the next fields: see `FormulaMechanism`
    wakes: Annotated[Ints, "3", READ]
    by_own_reach: int
    alone: int
    least_poses: int
    random: int
    chooses: int
    walls: int
    sight_bits: int  # SEE_ bits
    view_distance: float  # [m]
    min_speed: float  # [m/s]
    max_speed: float  # [m/s]
    angle_xy: float  # view angle to either side of the heading in the x-y plane [rad]
    angle_yz: float  # likewise in the y-z plane
    directions: Annotated[Floats, "R BLOCK 3", READ]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "R", KEPT]  # next direction of each row
    low: Annotated[Flags, "1", derived(True)]  # set when a row has used half of its directions
    parameters: Annotated[Floats, "PARAMETER", READ]  # of the formula; each mechanism numbers its own
    boids: Annotated[Floats, "P BOID", SCRATCH]  # room for as many boids as pairs; columns BOID_
    velocity: Annotated[Floats, "3", SCRATCH]  # room for the own velocity [m/s]
    change: Annotated[Floats, "3", SCRATCH]  # room for a change of it [m/s2]
    total: Annotated[Floats, "3", SCRATCH]  # room for a sum


open_rule = opening(Rule)

Formula: TypeAlias = Callable[[Pair], float]
"""Length of a contribution [m or -]: towards the gradient if positive; negative infinity is full repulsion."""
Combination: TypeAlias = Callable[[int, int, Own, Handle[Sight], Handle[Rule], Handle[Poses], Handle[Store]], bool]
"""(row, number of pairs, own part, sight, rule, poses, store) -> whether it moves; adds to the sum."""


@part
def combined(
    row: int, found: int, own: Own, sight: Handle[Sight], rule: Handle[Rule], poses: Handle[Poses], store: Handle[Store]
) -> bool:
    """Stand for the `Combination` of a mechanism."""
    raise NotImplementedError


@template(combined)
def move_rows(
    now: float,
    rows: Ints,
    moved: Handle[Moved],
    sight: Handle[Sight],
    rule: Written[Rule],
    poses: Handle[Poses],
    store: Written[Store],
) -> int:
    """Write the movement of `rows` (R,); a step, see `selforg.program`.

    Returns how many rows are left, the last ones: because there are too few random directions or channels are new, or
    if the room for pairs is too short for the next one.
    """
    m, given, known, room = open_rule(rule), open_moved(moved), open_poses(poses).rows, len(open_sight(sight).pairs)
    if m.low[0] or len(open_store(store).rules) != open_sight(sight).known:
        return len(rows)
    looks, wakes = m.looks[0] + m.looks[1] + m.looks[2] > 0, m.wakes[0] + m.wakes[1] + m.wakes[2] > 0
    ahead = m.angle_xy < np.inf or m.angle_yz < np.inf
    for index in range(len(rows)):
        row, found, moves = int(rows[index]), 0, False
        m.total[:] = 0.0
        if known[row, c.ROW_POSES] >= m.least_poses:
            own = own_of(row, m.view_distance, poses)
            if looks:
                margins = margins_of(own.goal_radius, rule)
                found = gather(look_all_around(row, now, m.sight_bits, margins, 0, sight, poses), sight, poses, store)
            if found > room:
                return len(rows) - index
            if ahead:
                found = keep_ahead(row, found, m.angle_xy, m.angle_yz, sight, poses)
            if found > 0 or m.alone:
                moves = combined(row, found, own, sight, rule, poses, store)
            if m.walls == REPEL:
                moves = repelled_by_walls(row, own.reach, rule, poses) or moves
            if not moves and wakes:
                moves = gather(look_for_one(row, now, rule, poses), sight, poses, store) > 0
            if moves:
                finish(row, own.reach, rule)
                if m.walls == REFLECT:
                    reflect(row, rule, poses)
        given.active[row] = moves
        for axis in range(given.vectors.shape[1]):
            given.vectors[row, axis] = m.total[axis]
    return 0


@part
def margins_of(goal_radius: float, rule: Handle[Rule]) -> Margins:
    """Return the margins [m] within which a movement can be different from zero, for an own `goal_radius` [m]."""
    m = open_rule(rule)
    return (
        margin(m.looks[0], m.view_distance, goal_radius),
        margin(m.looks[1], m.view_distance, goal_radius),
        margin(m.looks[2], m.view_distance, goal_radius),
    )


@part
def margin(looks: int, view: float, goal_radius: float) -> float:
    """Return how far beyond its reach a gradient is looked at [m]."""
    if looks == NOT_AT_ALL:
        return -np.inf
    return min(view, goal_radius) if looks == OWN_GOAL_RADIUS else view


@part
def look_for_one(row: int, now: float, rule: Handle[Rule], poses: Handle[Poses]) -> Look:
    """Return the look of a row for any one gradient that makes it active though it adds nothing."""
    m, own = open_rule(rule), open_poses(poses).own
    margins = (
        m.view_distance if m.wakes[0] else -np.inf,
        m.view_distance if m.wakes[1] else -np.inf,
        m.view_distance if m.wakes[2] else -np.inf,
    )
    return Look(row, 0, 1, now, m.sight_bits, margins, own[row, 0, c.X], own[row, 0, c.Y], own[row, 0, c.Z])


@part
def finish(row: int, own_reach: float, rule: Written[Rule]) -> None:
    """Limit the sum: repulsions among robots to the own reach, all others to their speeds."""
    m = open_rule(rule)
    if m.by_own_reach:
        limit(m.total, 0.0, own_reach)
        return
    if m.random and m.total[0] == 0.0 and m.total[1] == 0.0 and m.total[2] == 0.0:
        x, y, z = next_direction(m.directions, m.cursor, m.low, row)
        m.total[0], m.total[1], m.total[2] = x * m.max_speed, y * m.max_speed, z * m.max_speed
    limit(m.total, m.min_speed, m.max_speed)


@part
def repelled_by_walls(row: int, own_reach: float, rule: Handle[Rule], poses: Handle[Poses]) -> bool:
    """Add the repulsions by the walls near a row, of Balch & Hybinette, to the sum; return whether there are any.

    A wall is a repulsive gradient at its nearest point. At WALL_CONTACT it counts as much as a robot that is touched.
    """
    p, total = open_poses(poses), open_rule(rule).total
    repelled = False
    for k in range(p.wall_counts[row]):
        x, y = p.wall_ways[row, k, 0], p.wall_ways[row, k, 1]
        distance = np.sqrt(x * x + y * y)
        if 0.0 < distance < WALL_REACH:
            length = own_reach * min((WALL_REACH - distance) / (WALL_REACH - WALL_CONTACT), 1.0)
            total[0], total[1] = total[0] - length * x / distance, total[1] - length * y / distance
            repelled = True
    return repelled


@part
def reflect(row: int, rule: Handle[Rule], poses: Handle[Poses]) -> None:
    """Turn a movement that leads into a wall within WALL_REACH away from it, at the same speed."""
    p, total = open_poses(poses), open_rule(rule).total
    for k in range(p.wall_counts[row]):
        x, y = p.wall_ways[row, k, 0], p.wall_ways[row, k, 1]
        squared = x * x + y * y
        into = total[0] * x + total[1] * y
        if 0.0 < squared < WALL_REACH * WALL_REACH and into > 0.0:
            total[0], total[1] = total[0] - 2.0 * into / squared * x, total[1] - 2.0 * into / squared * y


@part
def add(index: int, length: float, full: float, row: int, sight: Handle[Sight], rule: Written[Rule]) -> None:
    """Add a contribution of `length` along the offset of a pair to the sum; -inf becomes `full` [m] away.

    Where the centres coincide there is no offset, and the direction is random.
    """
    if length == 0.0:
        return
    m, pairs = open_rule(rule), open_sight(sight).pairs
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
def full_length(index: int, sight: Handle[Sight]) -> float:
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
