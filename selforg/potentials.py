"""Potentials: how strongly one gradient attracts or repels one robot. Scalar, pure, one function each.

`clearance` [m] is the distance of the centres minus both goal radii, `diffusion` [m] the radius over which a gradient
weakens. Infinity from a repulsion means "full": the robot is inside the goal area; mechanisms turn it into a finite
vector (docs/quirks.md, Q2).
"""

import numpy as np

from selforg.compiler.decorators import kernel


@kernel
def attraction_balch(clearance: float, diffusion: float, distance: float) -> float:
    """Return the attraction [-] of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042.

    Beyond the diffusion the original gives the raw offset, a length of `distance` [m], not 1 (Q1).
    """
    if clearance <= 0.0:
        return 0.0
    if clearance <= diffusion:
        return clearance / diffusion
    return distance


@kernel
def repulsion_balch(clearance: float, diffusion: float) -> float:
    """Return the repulsion [-] of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042; infinite = full."""
    if clearance <= 0.0 or np.isinf(diffusion):
        return np.inf
    if clearance <= diffusion:
        return (diffusion - clearance) / diffusion
    return 0.0


@kernel
def attraction_ge(clearance: float, diffusion: float) -> float:
    """Return the attraction [m] of Ge & Cui (2000), doi:10.1109/70.880813."""
    if clearance <= 0.0:
        return 0.0
    if clearance <= diffusion:
        return clearance
    return diffusion if diffusion > 0.0 else 1.0


@kernel
def repulsion_ge(clearance: float, diffusion: float, goal_clearance: float) -> tuple[float, float]:
    """Return the repulsion of Ge & Cui (2000), doi:10.1109/70.880813: away from the obstacle, towards the goal.

    The part towards the goal does not depend on the distance of the goal, and inside the goal area
    (`goal_clearance` < 0) the first part attracts, as in the original (Q31). (infinite, 0) = full.
    """
    if clearance <= 0.0:
        return np.inf, 0.0
    if clearance > diffusion:
        return 0.0, 0.0
    steepness = 1.0 / clearance - 1.0 / diffusion
    return steepness * goal_clearance / clearance, 0.5 * steepness * steepness


@kernel
def repulsion_fernandez(clearance: float, own_reach: float, distance: float) -> float:
    """Return the repulsion [m] of Fernandez-Marquez et al. (2013), doi:10.1007/s11047-012-9324-y; infinite = full.

    `clearance` here leaves out the own goal radius. Negative, so attractive, beyond the own reach (Q5).
    """
    if clearance <= 0.0:
        return np.inf
    return distance * (own_reach - clearance) / clearance
