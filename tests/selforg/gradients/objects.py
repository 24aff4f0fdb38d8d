"""Queries of the original for one row, with gradients as objects."""

from dataclasses import replace

import numpy as np

from selforg.components.sources import EVERYTHING_IN_VIEW, GoalSource
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.pair import Own, choose
from selforg.gradients.queries import ATTRACTIVE, CHOICES, EVERYTHING, Filter, Queries
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import keep_ahead


def objects(buffer: SoBuffer, pairs: np.ndarray) -> list[Gradient]:
    return [buffer.gradient_of(pair) for pair in pairs]


def chosen(buffer: SoBuffer, rule: str, now: float, look: Filter = EVERYTHING_IN_VIEW) -> list[Gradient]:
    """Return the gradient that `rule` chooses for row 0, in a list that is empty if there is none."""
    signs = EVERYTHING if rule == "strongest" else ATTRACTIVE
    pairs, poses = Queries(buffer).gather(now, [0], look, signs=signs).pairs, buffer.poses
    view = buffer.settings.view_distance if look.view_distance is None else look.view_distance
    goal_radius, diffusion = poses.own[0, 0, [c.GOAL_RADIUS, c.DIFFUSION]]
    best = choose(CHOICES[rule], pairs, len(pairs), Own(goal_radius, goal_radius + diffusion, view))
    target = GoalSource(buffer, rule, look)
    target.ask(now, np.arange(1))
    assert target.present[0] == (best >= 0)
    if best >= 0:
        dim = buffer.space.dim
        np.testing.assert_array_equal(target.offsets[0], pairs[best, c.PAIR_DX : c.PAIR_DX + dim])
    return objects(buffer, pairs[best : best + 1] if best >= 0 else [])


def neighbours(buffer: SoBuffer, now: float, look: Filter = EVERYTHING_IN_VIEW) -> list[Gradient]:
    """Return the newest moving gradient in view of row 0 of every other robot, per channel and source."""
    seen = Queries(buffer).gather(now, [0], replace(look, static=False, moving=True), own=False)
    return objects(buffer, seen.pairs)


def histories(buffer: SoBuffer, now: float, look: Filter = EVERYTHING_IN_VIEW, *, own: bool = False) -> list[Gradient]:
    """Return the stored moving gradients in view of row 0, the oldest first; `own`: also what it spread itself."""
    seen = Queries(buffer).gather(now, [0], replace(look, static=False, moving=True), own=own, histories=True)
    return sorted(objects(buffer, seen.pairs), key=lambda gradient: gradient.stamp)


def static_ahead(buffer: SoBuffer, now: float, angle_xy: float, angle_yz: float, look: Filter) -> list[Gradient]:
    """Return the static gradients in view of row 0 within the angles [rad] to either side of its heading."""
    queries = Queries(buffer)
    found = int(queries.gather(now, [0], replace(look, static=True, moving=False)).start[-1])
    sight = queries._room.sight(now, tuple(look.channels))
    kept = keep_ahead(0, found, angle_xy, angle_yz, sight, buffer.poses.packed.handle)
    return objects(buffer, queries._room.pairs[:kept])
