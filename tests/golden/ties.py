"""Ties (B9): gradients in view that a query for a single one finds equally good, to the last bit."""

from selforg.gradients.gradient import Gradient
from selforg.gradients.pair import Own, pair_at, score
from selforg.gradients.queries import ATTRACTIVE, CHOICES, EVERYTHING, Filter, Queries
from selforg.gradients.store import columns as c
from tests.golden.scene import Scene


def equally_good(scene: Scene, rule: str, now: float, look: Filter) -> list[Gradient]:
    """Return the gradients of the highest score, all those that may be chosen by `rule`."""
    pairs = Queries(scene.buffer).gather(now, [0], look, signs=EVERYTHING if rule == "strongest" else ATTRACTIVE).pairs
    own = Own(scene.poses.own[0, 0, c.GOAL_RADIUS], reach=0.0, view_distance=0.0)
    scores = [score(CHOICES[rule], pair_at(index, pairs, own)) for index in range(len(pairs))]
    return [scene.buffer.gradient_of(p) for p, s in zip(pairs, scores, strict=True) if -float("inf") < s == max(scores)]
