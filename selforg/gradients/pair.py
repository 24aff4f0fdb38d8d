"""Pairs of a robot and one gradient that it sees: what every formula gets, and the potentials of Balch & Hybinette.

Infinity from a repulsion means "full": the robot is inside the goal area; mechanisms turn it into a finite vector
(docs/quirks.md, Q2).
"""

from typing import NamedTuple

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Words
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
def own_of(row: int, view_distance: float, poses: Words[Poses]) -> Own:
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
