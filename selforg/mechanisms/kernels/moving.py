"""The kernel that moves rows: gather, apply the rule, limit - for any number of rows in one call."""

from collections.abc import Callable

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import lean_kernel, part
from selforg.gradients.choosing import STRONGEST
from selforg.gradients.store.candidates import Margins
from selforg.gradients.store.columns import (
    DIFFUSION,
    DX,
    DY,
    DZ,
    GOAL,
    PAIR_COLUMNS,
    PHX,
    PHY,
    PHZ,
    POSES,
)
from selforg.gradients.store.gathering import gather
from selforg.gradients.store.pose_cells import poses_of
from selforg.mechanisms.kernels.rules import (
    ANGLE_XY,
    ANGLE_YZ,
    AVOID_ALL,
    CHEMOTAXIS_BALCH,
    CHEMOTAXIS_GE,
    CHOICE,
    COLLISION,
    EXPLOIT,
    FERNANDEZ,
    FOLLOW_ALL,
    FOLLOW_ONE,
    MAX_SPEED,
    MIN_SPEED,
    PARAMETERS,
    RANDOM_IF_ZERO,
    REPULSION,
    VIEW,
    WANDER,
    chemotaxis,
    follow_one,
    limit,
    sum_rule,
)
from selforg.randomness import take_direction

# Rules that are fed from less than the view, so that finding nothing does not mean that nothing is in view
NARROWED = (COLLISION, FOLLOW_ALL, AVOID_ALL, CHEMOTAXIS_BALCH, CHEMOTAXIS_GE)


# parameters of the rule and room for a sum (3,) behind them, a DirectionStream: drawn (N, block, 3) and cursor (N,),
# room for pairs (P, PAIR_COLUMNS)
Working = tuple[Floats, Floats, Ints, Floats]
WORKING_TABLES = Layout("f1", "f3", "i1", "f2")
working_of: Callable[[Bundle], Working] = WORKING_TABLES.unbundle


@lean_kernel
def move_rows(
    begin: int, rule: int, now: float, see: int, rows: Ints, places: Ints, channels: Ints, working: Bundle,
    poses: Bundle, store: Bundle, vectors: Floats, active: Flags,
) -> tuple[int, bool]:  # fmt: skip
    """Write the movement of rows[begin:] (R,) into the rows `places` (R,) of `vectors` (K, D) and `active` (K,).

    Returns how many rows are done - fewer than R if the room for pairs is too short for the next one - and whether some
    row's directions run low.
    """
    parameters, drawn, cursor, pairs = working_of(working)
    low = False
    any_one = min(1, len(pairs))  # not a constant: Numba would compile all it is handed to once more
    total = parameters[PARAMETERS:]
    own, known, _, _, _, _, _, _, _ = poses_of(poses)
    for index in range(begin, len(rows)):
        row, place = int(rows[index]), places[index]
        total[:] = 0.0
        active[place] = False
        if known[row, POSES] > 0:
            own_goal, own_reach = own[row, 0, GOAL], own[row, 0, DIFFUSION] + own[row, 0, GOAL]
            margins, moves = support(rule, parameters, own_goal), False
            found = 0
            if rule != WANDER:
                found = gather(row, margins, see, len(pairs) + 1, now, channels, poses, store, pairs)
            if found > len(pairs):
                return index, low
            if rule == EXPLOIT:
                found = keep_ahead(own, row, pairs, found, parameters[ANGLE_XY], parameters[ANGLE_YZ])
            if found > 0:
                moves = apply(rule, row, pairs, found, parameters, own_goal, own_reach, drawn, cursor, total)
            if not moves and rule in NARROWED:
                moves = gather(row, whole_view(rule, parameters), see, any_one, now, channels, poses, store, pairs) > 0
            moves = moves or rule == WANDER
            if moves:
                finish(rule, row, parameters, own_reach, drawn, cursor, total)
            active[place] = moves
        for axis in range(vectors.shape[1]):
            vectors[place, axis] = total[axis]
        low |= 2 * cursor[row] >= drawn.shape[1]
    return len(rows), low


@part
def support(rule: int, parameters: Floats, own_goal: float) -> Margins:
    """Return the margins [m] within which the rule can be different from zero, for signs -1, 0, +1.

    Balch and Ge repulsion are zero where the clearance exceeds the diffusion: beyond reach + own goal radius.
    """
    view = parameters[VIEW]
    repulsion = min(view, own_goal)
    if rule in (FERNANDEZ, REPULSION, EXPLOIT):
        return view, view, view
    if rule == FOLLOW_ONE:
        return (view, view, view) if int(parameters[CHOICE]) == STRONGEST else (-np.inf, -np.inf, view)
    if rule == AVOID_ALL:
        return repulsion, repulsion, repulsion
    return repulsion, -np.inf, (-np.inf if rule == COLLISION else view)


@part
def whole_view(rule: int, parameters: Floats) -> Margins:
    """Return the margins [m] of everything that makes the rule active, even if it adds nothing; signs -1, 0, +1."""
    view = parameters[VIEW]
    return (view, view, view) if rule == AVOID_ALL else (view, -np.inf, -np.inf)


@part
def apply(
    rule: int, row: int, pairs: Floats, found: int, parameters: Floats, own_goal: float, own_reach: float,
    drawn: Floats, cursor: Ints, total: Floats,
) -> bool:  # fmt: skip
    """Put the rule's sum over the first `found` pairs into `total` (3,); False if no gradient contributes."""
    if rule in (CHEMOTAXIS_BALCH, CHEMOTAXIS_GE):
        return chemotaxis(rule == CHEMOTAXIS_GE, pairs, found, own_goal, row, drawn, cursor, total)
    if rule == FOLLOW_ONE:
        return follow_one(int(parameters[CHOICE]), pairs, found, own_goal, row, drawn, cursor, total)
    sum_rule(rule, pairs, found, own_goal, own_reach, parameters[VIEW], row, drawn, cursor, total)
    return True


@part
def finish(
    rule: int, row: int, parameters: Floats, own_reach: float, drawn: Floats, cursor: Ints, total: Floats
) -> None:
    """Limit the sum in `total` (3,): repulsions among robots to the own reach, all others to their speeds."""
    if rule in (FERNANDEZ, REPULSION):
        limit(total, 0.0, own_reach)
        return
    random = rule == WANDER or parameters[RANDOM_IF_ZERO] > 0.0
    if random and total[0] == 0.0 and total[1] == 0.0 and total[2] == 0.0:
        x, y, z = take_direction(drawn, cursor, row)
        total[0], total[1], total[2] = x * parameters[MAX_SPEED], y * parameters[MAX_SPEED], z * parameters[MAX_SPEED]
    limit(total, parameters[MIN_SPEED], parameters[MAX_SPEED])


@part
def keep_ahead(own: Floats, row: int, pairs: Floats, found: int, angle_xy: float, angle_yz: float) -> int:
    """Keep the pairs whose offset lies within the view angles [rad] of the own heading; return how many."""
    kept = 0
    for index in range(found):
        xy = angle_between(own[row, 0, PHX], own[row, 0, PHY], pairs[index, DX], pairs[index, DY])
        yz = angle_between(own[row, 0, PHY], own[row, 0, PHZ], pairs[index, DY], pairs[index, DZ])
        if xy <= angle_xy and yz <= angle_yz:
            for column in range(PAIR_COLUMNS):
                pairs[kept, column] = pairs[index, column]
            kept += 1
    return kept


@part
def angle_between(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the angle [rad] in [0, pi] between two plane vectors; a zero vector points along the first axis."""
    difference = float(abs(np.arctan2(ay, ax) - np.arctan2(by, bx)))
    return min(difference, 2.0 * np.pi - difference)
