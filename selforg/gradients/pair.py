"""Pairs of a robot and one gradient that it sees: what every formula gets, and rules that choose one pair.

The potentials are those of Balch & Hybinette. A rule gives a score; the highest wins, the first among equals.
Infinity from a repulsion means "full": the robot is inside the goal area; mechanisms turn it into a finite vector
(docs/quirks.md, Q2).
"""

from typing import NamedTuple

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Handle
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses


class Own(NamedTuple):
    """The robot's part of a pair [m]."""

    goal_radius: float
    reach: float
    view_distance: float


class Pair(NamedTuple):
    """A robot and one gradient that it sees; made in compiled code, lengths in [m]."""

    distance: float  # of the centres
    clearance: float  # distance less both goal radii
    diffusion: float  # of the gradient: radius over which it weakens, may be infinite
    goal_radius: float  # of the gradient
    attraction: float  # of the gradient: -1, 0 or +1
    own_goal_radius: float  # of the robot's own pose
    own_reach: float  # diffusion and goal radius of the robot's own pose
    view_distance: float  # of the mechanism


@inlined
def own_of(row: int, view_distance: float, poses: Handle[Poses]) -> Own:
    """Return the part of a row in its pairs."""
    own = open_poses(poses).own
    goal_radius = own[row, 0, c.GOAL_RADIUS]
    return Own(goal_radius, own[row, 0, c.DIFFUSION] + goal_radius, view_distance)


@inlined
def pair_at(index: int, pairs: Floats, own: Own) -> Pair:
    """Return one of the `pairs` (P, PAIR_COLUMNS) of a row."""
    distance, goal_radius = pairs[index, c.PAIR_DISTANCE], pairs[index, c.PAIR_GOAL_RADIUS]
    return Pair(
        distance,
        distance - own.goal_radius - goal_radius,
        pairs[index, c.PAIR_DIFFUSION],
        goal_radius,
        pairs[index, c.PAIR_SIGN],
        own.goal_radius,
        own.reach,
        own.view_distance,
    )


@part
def attraction_balch(pair: Pair) -> float:
    """Return the attraction [-] of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042.

    Beyond the diffusion the original gives the raw offset, a length of the distance [m], not 1 (Q1).
    """
    if pair.clearance <= 0.0:
        return 0.0
    if pair.clearance <= pair.diffusion:
        return pair.clearance / pair.diffusion
    return pair.distance


@part
def repulsion_balch(pair: Pair) -> float:
    """Return the repulsion [-] of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042; infinite = full."""
    if pair.clearance <= 0.0 or np.isinf(pair.diffusion):
        return np.inf
    if pair.clearance <= pair.diffusion:
        return (pair.diffusion - pair.clearance) / pair.diffusion
    return 0.0


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
