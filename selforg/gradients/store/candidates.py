"""Candidates: gradients of the cells around a row, of which some are in view.

They pass through several short loops. No branch in these loops depends on positions, so that the processor fetches
many rows of the store at a time and computes several distances at a time. Each loop writes its results into arrays of
the store for the next loop: nothing is allocated.
"""

import numpy as np

from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Handle, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.evaporation import still_there
from selforg.gradients.store.records import Look, Sight, Store, open_sight, open_store
from selforg.space import half_of, shortest


@part
def keep_moving(count: int, newest_only: bool, skipped: int, store: Handle[Store]) -> int:
    """Keep of the first `count` candidates the newest of each source, or those of other sources than `skipped`."""
    s = open_store(store)
    kept = 0
    for index in range(count):
        here = s.candidates[index]
        old = newest_only and s.marks[here, c.MARK_RANK] != 0
        if old or (skipped >= 0 and s.marks[here, c.MARK_SOURCE] == skipped):
            continue
        s.candidates[kept] = here
        kept += 1
    return kept


@part
def renew(count: int, now: float, store: Written[Store]) -> int:
    """Evaporate the first `count` candidates up to `now` [s] and keep those that are left; return how many."""
    s = open_store(store)
    number, gone = 0, 0
    for index in range(count):
        s.chosen[number] = index  # every index is written, and `number` grows if it is due: no branch
        number += 1 if now >= s.near[s.candidates[index], c.NEAR_DUE] else 0
    for k in range(number):
        if not still_there(int(s.candidates[s.chosen[k]]), now, store):
            s.candidates[s.chosen[k]] = -1
            gone += 1
    if gone == 0:
        return count
    kept = 0
    for index in range(count):
        s.candidates[kept] = s.candidates[index]
        kept += 1 if s.candidates[index] >= 0 else 0
    return kept


@inlined
def approach(count: int, look: Look, store: Handle[Store]) -> None:
    """Write the offsets of the first `count` candidates from the row, and how far they reach [m]."""
    s = open_store(store)
    repulsive, neutral, attractive = look.margins
    x, y, z = look.x, look.y, look.z
    for index in range(count):
        here = s.candidates[index]
        sign = s.links[here, c.LINK_SIGN]
        margin = repulsive if sign < 0 else (attractive if sign > 0 else neutral)
        reach = margin + (s.near[here, c.DIFFUSION] + s.near[here, c.GOAL_RADIUS])
        s.offsets_x[index] = s.near[here, c.X] - x
        s.offsets_y[index] = s.near[here, c.Y] - y
        s.offsets_z[index] = s.near[here, c.Z] - z
        s.reaches[index] = reach if margin > -np.inf else -1.0


@inlined
def measure(count: int, store: Handle[Store]) -> None:
    """Compute the shortest offsets and the distances [m] of the first `count` candidates."""
    s = open_store(store)
    ex, ey, ez = s.extent[0], s.extent[1], s.extent[2]
    half_x, half_y, half_z = half_of(ex), half_of(ey), half_of(ez)
    for index in range(count):
        dx = shortest(s.offsets_x[index], ex, half_x)
        dy = shortest(s.offsets_y[index], ey, half_y)
        dz = shortest(s.offsets_z[index], ez, half_z)
        s.offsets_x[index], s.offsets_y[index], s.offsets_z[index] = dx, dy, dz
        s.distances[index] = np.sqrt(dx * dx + dy * dy + dz * dz)


@inlined
def keep_near(count: int, found: int, sight: Handle[Sight], store: Handle[Store]) -> int:
    """Write the candidates (of the first `count`) that are in view after the first `found` pairs; return the end."""
    s, pairs = open_store(store), open_sight(sight).pairs
    kept = 0
    for index in range(count):
        s.chosen[kept] = index
        kept += 0 if s.distances[index] > s.reaches[index] else 1
    for k in range(min(kept, len(pairs) - found)):
        index, pair = int(s.chosen[k]), found + k
        here = int(s.candidates[index])
        pairs[pair, c.PAIR_DX], pairs[pair, c.PAIR_DY] = s.offsets_x[index], s.offsets_y[index]
        pairs[pair, c.PAIR_DZ], pairs[pair, c.PAIR_DISTANCE] = s.offsets_z[index], s.distances[index]
        pairs[pair, c.PAIR_DIFFUSION] = s.near[here, c.DIFFUSION]
        pairs[pair, c.PAIR_GOAL_RADIUS] = s.near[here, c.GOAL_RADIUS]
        pairs[pair, c.PAIR_SIGN], pairs[pair, c.PAIR_SLOT] = s.links[here, c.LINK_SIGN], here
    return found + kept
