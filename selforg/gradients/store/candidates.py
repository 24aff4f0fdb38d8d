"""Candidates: gradients of the cells around a row, of which some are in view.

They go through some passes of short loops, each without a branch that depends on what lies where, so that rows of the
store are fetched many at a time and distances are worked out several at a time. What a pass leaves for the next one
lies behind the counters and the settings of the store: nothing is allocated, and no further table is handed over.
"""

from collections.abc import Callable

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import inlined, part
from selforg.gradients.store.columns import (
    ATTRACTION,
    COUNTERS,
    DIFFUSION,
    DISTANCE,
    DUE,
    DX,
    DY,
    DZ,
    EXTENT,
    GOAL,
    MIN_DIFFUSION,
    PAIR_DIFFUSION,
    PAIR_GOAL,
    RANK,
    SETTINGS,
    SIGN,
    SLOT,
    SOURCE,
    X,
    Y,
    Z,
)
from selforg.gradients.store.evaporation import evaporate, evaporated_away
from selforg.gradients.store.grid import remove
from selforg.gradients.store.windows import MOST_CELLS

# near (M, NEAR_COLUMNS), links (M, LINK_COLUMNS), far (M, FAR_COLUMNS), marks (M, MARK_COLUMNS), layers (L,
# LAYER_COLUMNS), buckets, cells of each level (LEVELS, GRID_COLUMNS), counters (COUNTERS,) and behind them room for the
# cells of a window (MOST_CELLS,) and for candidates (2, MOST_CANDIDATES), settings (SETTINGS,) and behind them room for
# offset, reach and distance of candidates (5, MOST_CANDIDATES)
Store = tuple[Floats, Links, Floats, Links, Links, Links, Floats, Ints, Floats]
STORE_TABLES = Layout("f2", "l2", "f2", "l2", "l2", "l1", "f2", "i1", "f1")
store_of: Callable[[Bundle], Store] = STORE_TABLES.unbundle

MOST_CANDIDATES = 512  # gradients that are looked at together
# Room behind the settings: offset to each candidate, how far it reaches, distance [m]
OFFSETS_X, OFFSETS_Y, OFFSETS_Z, REACHES, DISTANCES = [SETTINGS + k * MOST_CANDIDATES for k in range(5)]

# margins [m] for gradients of attraction -1, 0, +1 (negative infinity: not looked at)
Margins = tuple[float, float, float]


@part
def keep_moving(count: int, newest_only: bool, skipped: int, marks: Links, candidates: Ints) -> int:
    """Keep of the first `count` candidates the newest of each source, or those of other sources than `skipped`."""
    kept = 0
    for index in range(count):
        here = candidates[index]
        if (newest_only and marks[here, RANK] != 0) or (skipped >= 0 and marks[here, SOURCE] == skipped):
            continue
        candidates[kept] = here
        kept += 1
    return kept


@part
def renew(count: int, now: float, store: Bundle) -> int:
    """Bring the first `count` candidates to `now` [s]; returns how many have not evaporated away."""
    near, links, far, marks, layers, buckets, _, counters, settings = store_of(store)
    candidates, due = counters[COUNTERS + MOST_CELLS :], counters[COUNTERS + MOST_CELLS + MOST_CANDIDATES :]
    number, gone = 0, 0
    for index in range(count):
        due[number] = index  # written where the next one goes, and kept if it is due
        number += 1 if now >= near[candidates[index], DUE] else 0
    for k in range(number):
        here = int(candidates[due[k]])
        evaporate(near, far, here, now)
        if evaporated_away(near, here, settings[MIN_DIFFUSION]):
            remove(here, links, marks, layers, buckets, counters)
            candidates[due[k]] = -1
            gone += 1
    if gone == 0:
        return count
    kept = 0
    for index in range(count):
        candidates[kept] = candidates[index]
        kept += 1 if candidates[index] >= 0 else 0
    return kept


@inlined
def approach(
    count: int, margins: Margins, x: float, y: float, z: float, near: Floats, links: Links, candidates: Ints,
    settings: Floats,
) -> None:  # fmt: skip
    """Note the offsets of the first `count` candidates from (x, y, z) and how far they reach [m].

    There is no branch that depends on what lies where: many of them are fetched at a time.
    """
    offsets_x, offsets_y, offsets_z = settings[OFFSETS_X:], settings[OFFSETS_Y:], settings[OFFSETS_Z:]
    reaches = settings[REACHES:]
    repulsive, neutral, attractive = margins
    for index in range(count):
        here = candidates[index]
        sign = links[here, ATTRACTION]
        margin = repulsive if sign < 0 else (attractive if sign > 0 else neutral)
        reach = margin + (near[here, DIFFUSION] + near[here, GOAL])
        offsets_x[index] = near[here, X] - x
        offsets_y[index] = near[here, Y] - y
        offsets_z[index] = near[here, Z] - z
        reaches[index] = reach if margin > -np.inf else -1.0


@inlined
def measure(count: int, settings: Floats) -> None:
    """Work out the shortest offsets and the distances [m] of the first `count` candidates, several at a time."""
    offsets_x, offsets_y, offsets_z = settings[OFFSETS_X:], settings[OFFSETS_Y:], settings[OFFSETS_Z:]
    distances = settings[DISTANCES:]
    ex, ey, ez = settings[EXTENT], settings[EXTENT + 1], settings[EXTENT + 2]
    half_x, half_y, half_z = half(ex), half(ey), half(ez)
    for index in range(count):
        dx = shortest(offsets_x[index], ex, half_x)
        dy = shortest(offsets_y[index], ey, half_y)
        dz = shortest(offsets_z[index], ez, half_z)
        offsets_x[index], offsets_y[index], offsets_z[index] = dx, dy, dz
        distances[index] = np.sqrt(dx * dx + dy * dy + dz * dz)


@inlined
def keep_near(
    count: int, near: Floats, links: Links, candidates: Ints, settings: Floats, pairs: Floats, found: int
) -> int:
    """Write those of the first `count` candidates that are within their reach behind the pairs `found`."""
    chosen = candidates[MOST_CANDIDATES:]
    offsets_x, offsets_y, offsets_z = settings[OFFSETS_X:], settings[OFFSETS_Y:], settings[OFFSETS_Z:]
    reaches, distances = settings[REACHES:], settings[DISTANCES:]
    kept = 0
    for index in range(count):
        chosen[kept] = index
        kept += 0 if distances[index] > reaches[index] else 1
    for k in range(min(kept, len(pairs) - found)):
        index = int(chosen[k])
        here = int(candidates[index])
        pair = found + k
        pairs[pair, DX], pairs[pair, DY], pairs[pair, DZ] = offsets_x[index], offsets_y[index], offsets_z[index]
        pairs[pair, DISTANCE] = distances[index]
        pairs[pair, PAIR_DIFFUSION], pairs[pair, PAIR_GOAL] = near[here, DIFFUSION], near[here, GOAL]
        pairs[pair, SIGN], pairs[pair, SLOT] = links[here, ATTRACTION], here
    return found + kept


@part
def half(extent: float) -> float:
    """Return half of a closed axis [m], infinity for an open one (extent 0)."""
    return 0.5 * extent if extent > 0.0 else np.inf


@part
def shortest(delta: float, extent: float, half_extent: float) -> float:
    """Return the shortest image of `delta` [m]; `nearest_image` with the question whether the axis is open answered."""
    if delta > half_extent:
        return delta - extent
    if delta < -half_extent:
        return delta + extent
    return delta
