"""Choosing one gradient among those a row sees: the single-gradient queries of the buffer.

Each rule gives a score; the highest wins, the first among equals. Scores of -inf are never chosen.
"""

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import kernel, lean_kernel, part
from selforg.gradients.store import columns as c
from selforg.potentials import attraction_balch, repulsion_balch

CHOOSE_NEAREST, CHOOSE_FARTHEST, CHOOSE_LEAST_REACH, CHOOSE_MOST_REACH, CHOOSE_STRONGEST = 0, 1, 2, 3, 4


@kernel
def choose(rule: int, pairs: Floats, found: int, own_goal: float) -> int:
    """Return the index of the chosen one of the first `found` pairs (P, PAIR_COLUMNS), -1 if there is none.

    own_goal: own goal radius [m].
    """
    best, chosen = -np.inf, -1
    for index in range(found):
        distance, goal = pairs[index, c.PAIR_DISTANCE], pairs[index, c.PAIR_GOAL_RADIUS]
        diffusion, sign = pairs[index, c.PAIR_DIFFUSION], pairs[index, c.PAIR_SIGN]
        value = score(rule, distance, distance - own_goal - goal, diffusion, goal, sign)
        if value > best:
            best, chosen = value, index
    return chosen


@lean_kernel
def choose_rows(
    rule: int, start: Ints, seen: Floats, goals: Floats, known: Flags, chosen: Floats, found: Flags
) -> None:
    """Write what each of R rows chooses into `chosen` (R, PAIR_COLUMNS), and whether there is anything into `found`.

    Row i sees seen[start[i]:start[i + 1]] (P, PAIR_COLUMNS); goals, known (R,): own goal radius [m], is there a pose?
    """
    for row in range(len(goals)):
        first = start[row]
        best = choose(rule, seen[first:], start[row + 1] - first, goals[row]) if known[row] else -1
        found[row] = best >= 0
        for column in range(chosen.shape[1]):
            chosen[row, column] = seen[first + best, column] if best >= 0 else 0.0


@part
def score(rule: int, distance: float, clearance: float, diffusion: float, goal: float, sign: float) -> float:
    """Return how well a gradient serves the rule; -inf excludes it. Lengths in [m]."""
    if rule == CHOOSE_STRONGEST:
        if sign <= 0.0:
            return repulsion_balch(clearance, diffusion)
        value = 1.0 - attraction_balch(clearance, diffusion, distance)
        return value if value > -1.0 else -np.inf
    if sign <= 0.0:
        return -np.inf
    if rule == CHOOSE_LEAST_REACH:
        return -(diffusion + goal)
    if rule == CHOOSE_MOST_REACH:
        return diffusion + goal if diffusion + goal > 0.0 else -np.inf
    attraction = attraction_balch(clearance, diffusion, distance)
    if rule == CHOOSE_NEAREST:
        return -attraction
    return attraction if attraction > 0.0 else -np.inf
