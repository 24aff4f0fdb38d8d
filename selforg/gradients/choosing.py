"""Choosing one gradient among those a row sees: the single-gradient queries of the buffer.

Each rule gives a score; the highest wins, the first among equals. Scores of -inf are never chosen.
"""

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Words
from selforg.gradients.pair import Own, Pair, attraction_balch, own_of, pair_at, repulsion_balch
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses

CHOOSE_NEAREST, CHOOSE_FARTHEST, CHOOSE_LEAST_REACH, CHOOSE_MOST_REACH, CHOOSE_STRONGEST = 0, 1, 2, 3, 4


@part
def choose(rule: int, pairs: Floats, found: int, own: Own) -> int:
    """Return the index of the chosen one of the first `found` pairs (P, PAIR_COLUMNS), -1 if there is none."""
    best, chosen = -np.inf, -1
    for index in range(found):
        value = score(rule, pair_at(index, pairs, own))
        if value > best:
            best, chosen = value, index
    return chosen


@lean_kernel
def choose_rows(
    rule: int, view: float, rows: Ints, start: Ints, seen: Floats, chosen: Floats, found: Flags, poses: Words[Poses]
) -> None:
    """Write what each of `rows` (R,) chooses into `chosen` (R, PAIR_COLUMNS), and whether there is anything in `found`.

    Row i of them sees seen[start[i]:start[i + 1]] (P, PAIR_COLUMNS), with a view distance of `view` [m].
    """
    known = open_poses(poses).rows
    for index in range(len(rows)):
        row, first, best = rows[index], start[index], -1
        if known[row, c.ROW_POSES] > 0:
            best = choose(rule, seen[first:], start[index + 1] - first, own_of(row, view, poses))
        found[index] = best >= 0
        for column in range(chosen.shape[1]):
            chosen[index, column] = seen[first + best, column] if best >= 0 else 0.0


@part
def score(rule: int, pair: Pair) -> float:
    """Return how well a gradient serves the rule; -inf excludes it."""
    reach = pair.diffusion + pair.goal_radius
    if rule == CHOOSE_STRONGEST:
        if pair.attraction <= 0.0:
            return repulsion_balch(pair)
        value = 1.0 - attraction_balch(pair)
        return value if value > -1.0 else -np.inf
    if pair.attraction <= 0.0:
        return -np.inf
    if rule == CHOOSE_LEAST_REACH:
        return -reach
    if rule == CHOOSE_MOST_REACH:
        return reach if reach > 0.0 else -np.inf
    attraction = attraction_balch(pair)
    if rule == CHOOSE_NEAREST:
        return -attraction
    return attraction if attraction > 0.0 else -np.inf
