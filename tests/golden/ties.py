"""Ties (B9): gradients in view that a query for a single one finds equally good, to the last bit."""

from selforg.gradients.choosing import score
from selforg.gradients.gradient import Gradient
from selforg.gradients.queries import ATTRACTIVE, CHOICES, EVERYTHING, Filter, Queries
from selforg.gradients.store import columns as c
from tests.golden.scene import Scene


def equally_good(scene: Scene, rule: str, now: float, look: Filter) -> list[Gradient]:
    """Return the gradients of the highest score, all those that may be chosen by `rule`."""
    pairs = Queries(scene.buffer).gather(now, [0], look, signs=EVERYTHING if rule == "strongest" else ATTRACTIVE).pairs
    own_goal = scene.poses.own[0, 0, c.GOAL_RADIUS]
    scores = []
    for pair in pairs:
        distance, diffusion, goal = pair[c.PAIR_DISTANCE], pair[c.PAIR_DIFFUSION], pair[c.PAIR_GOAL_RADIUS]
        scores.append(score(CHOICES[rule], distance, distance - own_goal - goal, diffusion, goal, pair[c.PAIR_SIGN]))
    return [scene.buffer.gradient_of(p) for p, s in zip(pairs, scores, strict=True) if -float("inf") < s == max(scores)]
