"""The scalar functions of Olfati-Saber (2006), doi:10.1109/TAC.2005.864190: what two boids are to each other."""

import numpy as np

from selforg.compiler.decorators import kernel
from selforg.elementary import sine_cosine


@kernel
def sigma_norm(squared: float, epsilon: float) -> float:
    """Return the sigma-norm of a vector of squared length `squared` [m2], smooth at zero; Olfati-Saber (2006)."""
    return float((np.sqrt(1.0 + epsilon * squared) - 1.0) / epsilon)


@kernel
def bump(z: float, h: float) -> float:
    """Return the bump function: 1 below `h`, falling smoothly to 0 at 1."""
    if 0.0 <= z < h:
        return 1.0
    if h <= z <= 1.0:
        return 0.5 * (1.0 + sine_cosine(np.pi * (z - h) / (1.0 - h))[1])
    return 0.0


@kernel
def adjacency(squared: float, epsilon: float, h: float, view: float) -> float:
    """Return the spatial adjacency [-] of two boids at squared distance `squared` [m2]; `view` is their range [m]."""
    return bump(sigma_norm(squared, epsilon) / sigma_norm(view * view, epsilon), h)


@kernel
def action(
    squared: float, epsilon: float, a: float, b: float, h: float, avoidance_distance: float, view: float
) -> float:
    """Return the action function: negative closer than `avoidance_distance` [m], positive farther, 0 beyond `view`."""
    z = sigma_norm(squared, epsilon)
    c = abs(a - b) / np.sqrt(4.0 * a * b)
    shifted = z - sigma_norm(avoidance_distance * avoidance_distance, epsilon) + c
    pull = 0.5 * ((a + b) * shifted / np.sqrt(1.0 + shifted * shifted) + (a - b))
    return float(bump(z / sigma_norm(view * view, epsilon), h) * pull)
