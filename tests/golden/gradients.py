"""Replays gradients.json: the four potentials as vectors."""

import numpy as np

from selforg.gradients.pair import Pair, attraction_balch, repulsion_balch
from selforg.mechanisms.chemotaxis import attraction_ge, repulsion_ge
from tests.golden.case import Case, difference


def replay(case: Case) -> str | None:
    """Return how the vector differs from the original's, None if it agrees."""
    inputs, name = case.inputs, case.inputs["function"]
    own, gradient = inputs["pose"], inputs["gradient"]
    offset, diffusion = np.subtract(gradient["p"], own["p"]), gradient["diffusion"]
    distance = float(np.sqrt(offset @ offset))
    clearance = distance - own["goal_radius"] - gradient["goal_radius"]
    pair = Pair(distance, clearance, diffusion, 0.0, 0.0, 0.0, own_reach=0.0, view_distance=np.inf)
    towards = unit(offset)
    if name == "attractive_balch":
        vector = attraction_balch(pair) * towards
    elif name == "attractive_ge":
        vector = attraction_ge(pair) * towards
    elif name == "repulsive_balch":
        vector = full_or(repulsion_balch(pair), -towards)
    else:
        goal = np.subtract(inputs["goal"]["p"], own["p"])
        goal_clearance = float(np.sqrt(goal @ goal)) - own["goal_radius"] - inputs["goal"]["goal_radius"]
        away, to_goal = repulsion_ge(pair, goal_clearance)
        vector = full_or(away, -towards) + to_goal * unit(goal)
    return difference(case.expected["vector"], vector.tolist(), name)


def unit(offset: np.ndarray) -> np.ndarray:
    """Return the unit vector (3,) of an offset, zero for a zero one."""
    length = np.sqrt(offset @ offset)
    return offset / length if length > 0 else np.zeros(3)


def full_or(length: float, direction: np.ndarray) -> np.ndarray:
    """Return `length` along a direction; infinite as the original has it: its sign, zero components positive (Q2)."""
    if np.isinf(length):
        return np.where(direction < 0, -np.inf, np.inf)
    return length * direction
