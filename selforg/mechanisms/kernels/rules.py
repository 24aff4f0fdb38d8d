"""Movement rules: what one row makes of the pairs it sees. Small compiled functions, chosen by an integer.

One kernel for all rules, because compiling and loading a kernel is what costs; the rules themselves are short sums of
the potentials.
"""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import part
from selforg.gradients.choosing import NEAREST, choose
from selforg.gradients.store.columns import DISTANCE, DX, DY, DZ, PAIR_DIFFUSION, PAIR_GOAL, SIGN
from selforg.potentials import (
    attraction_balch,
    attraction_ge,
    repulsion_balch,
    repulsion_fernandez,
    repulsion_ge,
)
from selforg.randomness import take_direction

# Sums of one formula over all pairs
FERNANDEZ, REPULSION, COLLISION, FOLLOW_ALL, AVOID_ALL, EXPLOIT = 0, 1, 2, 3, 4, 5
# Rules that first choose one gradient
CHEMOTAXIS_BALCH, CHEMOTAXIS_GE, FOLLOW_ONE = 10, 11, 12
# A rule without gradients: a random direction
WANDER = 20

# Parameters of a rule, float64 (PARAMETERS,)
VIEW, MIN_SPEED, MAX_SPEED, CHOICE, RANDOM_IF_ZERO, ANGLE_XY, ANGLE_YZ = 0, 1, 2, 3, 4, 5, 6
PARAMETERS = 7

# vectors (N, block, 3) and cursor (N,) below are those of a DirectionStream


@part
def strength(
    rule: int, distance: float, diffusion: float, goal: float, sign: float, own_goal: float, own_reach: float,
    view: float,
) -> float:  # fmt: skip
    """Return the length [m or -] of a contribution: towards the gradient if positive, -inf is full repulsion."""
    if rule == FERNANDEZ:
        return -repulsion_fernandez(distance - goal, own_reach, distance) if distance - goal <= view else 0.0
    clearance = distance - own_goal - goal
    if rule == EXPLOIT:
        return attraction_ge(clearance, diffusion)
    if rule == FOLLOW_ALL and sign >= 0.0:
        return sign * attraction_balch(clearance, diffusion, distance)
    return -repulsion_balch(clearance, diffusion)


@part
def add(
    total: Floats, pairs: Floats, index: int, length: float, full: float, row: int, vectors: Floats, cursor: Ints
) -> None:
    """Add a contribution of `length` along the offset of a pair to `total` (3,); -inf becomes `full` [m] away.

    Where the centres coincide there is no offset, and the direction is random.
    """
    if length == 0.0:
        return
    if np.isinf(length):
        length = -full
    distance = pairs[index, DISTANCE]
    if distance > 0.0:
        scale = length / distance
        total[0] += scale * pairs[index, DX]
        total[1] += scale * pairs[index, DY]
        total[2] += scale * pairs[index, DZ]
    else:
        x, y, z = take_direction(vectors, cursor, row)
        total[0] += abs(length) * x
        total[1] += abs(length) * y
        total[2] += abs(length) * z


@part
def full_length(pairs: Floats, index: int) -> float:
    """Return the length [m] of full repulsion: the reach of the gradient, 1 where that is infinite (Q2)."""
    reach = pairs[index, PAIR_DIFFUSION] + pairs[index, PAIR_GOAL]
    return reach if np.isfinite(reach) else 1.0


@part
def sum_rule(
    rule: int, pairs: Floats, found: int, own_goal: float, own_reach: float, view: float, row: int,
    vectors: Floats, cursor: Ints, total: Floats,
) -> None:  # fmt: skip
    """Add up one formula over the first `found` pairs (P, PAIR_COLUMNS) into `total` (3,)."""
    by_own_reach = rule in (FERNANDEZ, REPULSION)
    x, y, z = 0.0, 0.0, 0.0
    for index in range(found):
        distance = pairs[index, DISTANCE]
        length = strength(
            rule, distance, pairs[index, PAIR_DIFFUSION], pairs[index, PAIR_GOAL], pairs[index, SIGN], own_goal,
            own_reach, view,
        )  # fmt: skip
        if distance > 0.0 and length > -np.inf:
            scale = length / distance
            x += scale * pairs[index, DX]
            y += scale * pairs[index, DY]
            z += scale * pairs[index, DZ]
        else:
            full = own_reach if by_own_reach else full_length(pairs, index)
            add(total, pairs, index, length, full, row, vectors, cursor)
    total[0] += x
    total[1] += y
    total[2] += z


@part
def follow_one(
    choice: int, pairs: Floats, found: int, own_goal: float, row: int, vectors: Floats, cursor: Ints, total: Floats
) -> bool:
    """Put the Balch vector of the gradient chosen by rule `choice` into `total` (3,); False if none is chosen."""
    chosen = choose(choice, pairs, found, own_goal)
    if chosen < 0 or pairs[chosen, SIGN] == 0.0:
        return False
    distance, diffusion = pairs[chosen, DISTANCE], pairs[chosen, PAIR_DIFFUSION]
    clearance = distance - own_goal - pairs[chosen, PAIR_GOAL]
    if pairs[chosen, SIGN] > 0.0:
        length = attraction_balch(clearance, diffusion, distance)
    else:
        length = -repulsion_balch(clearance, diffusion)
    add(total, pairs, chosen, length, full_length(pairs, chosen), row, vectors, cursor)
    return True


@part
def chemotaxis(
    ge: bool, pairs: Floats, found: int, own_goal: float, row: int, vectors: Floats, cursor: Ints, total: Floats
) -> bool:
    """Add attraction to the nearest attractive gradient and all repulsions into `total` (3,); False without any.

    Potentials of Ge & Cui if `ge`, of Balch & Hybinette otherwise and where there is no goal.
    """
    nearest = min(NEAREST, found)  # not a constant: Numba would compile all it is handed to once more
    goal = choose(nearest, pairs, found, own_goal)
    goal_clearance, contributions = 0.0, 0
    if goal >= 0:
        contributions, diffusion = 1, pairs[goal, PAIR_DIFFUSION]
        goal_clearance = pairs[goal, DISTANCE] - own_goal - pairs[goal, PAIR_GOAL]
        pull = attraction_balch(goal_clearance, diffusion, pairs[goal, DISTANCE])
        if ge:
            pull = attraction_ge(goal_clearance, diffusion)
        add(total, pairs, goal, pull, 0.0, row, vectors, cursor)
    for index in range(found):
        if pairs[index, SIGN] >= 0.0:
            continue
        contributions += 1
        clearance = pairs[index, DISTANCE] - own_goal - pairs[index, PAIR_GOAL]
        away, to_goal = repulsion_balch(clearance, pairs[index, PAIR_DIFFUSION]), 0.0
        if ge and goal >= 0:
            away, to_goal = repulsion_ge(clearance, pairs[index, PAIR_DIFFUSION], goal_clearance)
            if pairs[goal, DISTANCE] > 0.0:
                add(total, pairs, goal, to_goal, 0.0, row, vectors, cursor)
        add(total, pairs, index, -away, full_length(pairs, index), row, vectors, cursor)
    return contributions > 0


@part
def limit(total: Floats, lowest: float, highest: float) -> None:
    """Bring the length of `total` (3,) into [`lowest`, `highest`] in place; a zero vector stays zero."""
    # scaled by the largest component first: a square must not overflow
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
