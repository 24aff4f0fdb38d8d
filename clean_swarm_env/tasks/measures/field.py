"""The potential of a field of gradients, of which the Balch and Hybinette forces are the slope.

The force towards an attractive gradient is clearance / diffusion. The force away from a repulsive one is
(diffusion - clearance) / diffusion (doi:10.1109/ROBOT.2000.844042). Their integrals along the way are the heights.
"""

from dataclasses import dataclass

import numpy as np

from clean_swarm_env.world.ground import Ground
from selforg.arrays import Floats


@dataclass(frozen=True)
class Field:
    """Gradients of W worlds, M in each.

    Attributes:
        places: (W, M, 2) [m].
        attraction: (M,) +1 or -1.
        diffusion: (M,) [m].
        goal_radius: (M,) [m].

    """

    places: Floats
    attraction: Floats
    diffusion: Floats
    goal_radius: Floats


def height(field: Field, positions: Floats, own_goal: float | Floats, ground: Ground) -> Floats:
    """Return how high robots at positions (W, N, 2) [m] stand (W, N) [m]: 0 is the top of an attractive gradient.

    own_goal: goal radius of all robots, or (N, 1) of each [m]. Beyond the diffusion of an attractive gradient the slope
    is 1.
    """
    distances = ground.distances(positions[:, :, None], field.places[:, None])
    clearance = np.maximum(distances - own_goal - field.goal_radius, 0.0)
    inside = np.minimum(clearance, field.diffusion)
    hollow = inside**2 / (2.0 * field.diffusion) + (clearance - inside)
    hill = (field.diffusion - inside) ** 2 / (2.0 * field.diffusion)
    total: Floats = np.where(field.attraction > 0, -hollow, -hill).sum(axis=2)
    return total
