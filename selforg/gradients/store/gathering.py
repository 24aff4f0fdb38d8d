"""Gathering: the gradients that one row sees, written into a table of pairs.

A gradient is in view when the distance of the centres is at most its reach plus a margin [m]. The margin depends on
the sign of the gradient: a formula that is zero beyond a shorter distance need not be fed from farther away.

The inner loops pass near, not tables: every table handed to a function that is not inlined costs some ten words.
"""

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import part
from selforg.compiler.prefetch import prefetch
from selforg.gradients.store.candidates import (
    MOST_CANDIDATES,
    Margins,
    approach,
    half,
    keep_moving,
    keep_near,
    measure,
    renew,
    shortest,
    store_of,
)
from selforg.gradients.store.columns import (
    AFTER,
    BOUND,
    CELL,
    COUNT,
    COUNTERS,
    DIFFUSION,
    DISTANCE,
    DX,
    DY,
    DZ,
    GOAL,
    HEAD,
    HEARD,
    LAYER,
    LEVELS,
    MOVING,
    NEXT,
    PAIR_DIFFUSION,
    PAIR_GOAL,
    POSE_SIGN,
    POSES,
    SEE_HISTORY,
    SEE_MOVING,
    SEE_STATIC,
    SIGN,
    SKIP_OWN,
    SLOT,
    TEAM,
    UNBOUNDED,
    USED,
    X,
    Y,
    Z,
)
from selforg.gradients.store.grid import bucket_of, layer_of, space_of, whole
from selforg.gradients.store.pose_cells import CROWD, poses_of
from selforg.gradients.store.windows import MOST_CELLS, near_cells

IN_CACHE = 4096  # gradients: so few are not worth asking for ahead


@part
def gather(
    row: int, margins: Margins, see: int, limit: int, now: float, channels: Ints, poses: Bundle, store: Bundle,
    pairs: Floats,
) -> int:  # fmt: skip
    """Write what `row` sees into `pairs` (P, PAIR_COLUMNS) and return how many there are.

    see: SEE_ bits; limit: stop once that many are found (P + 1: all); channels: (C + 1,) first 1 if the channel of the
    poses is among them, then the others. Beyond P pairs are counted, not written: the caller comes again with a longer
    table.
    """
    _, _, _, _, layers, _, grid, counters, _ = store_of(store)
    window = counters[COUNTERS : COUNTERS + MOST_CELLS]
    found = 0
    if see & SEE_MOVING and channels[0] == 1:
        found = gather_poses(row, margins, see, limit, poses, window, pairs)
    if counters[USED] == 0:
        return found
    radius = max(margins[0], margins[1], margins[2])
    own, rows, _, _, _, _, _, _, _ = poses_of(poses)
    x, y, z = own[row, 0, X], own[row, 0, Y], own[row, 0, Z]
    for index in range(1, len(channels)):
        first = layer_of(int(channels[index]), space_of(row, rows, counters), 0, counters)
        for level in range(LEVELS):
            members = whole(layers[first + level, COUNT])
            if members == 0 or found >= limit or see & (SEE_MOVING if level == MOVING else SEE_STATIC) == 0:
                continue
            cells = -1
            if level < UNBOUNDED:
                cells = near_cells(x, y, z, radius + grid[level, BOUND], grid, level, float(members), window)
            found = gather_layer(row, first + level, cells, margins, see, limit, now, x, y, z, store, pairs, found)
    return found


@part
def gather_layer(
    row: int, layer: int, cells: int, margins: Margins, see: int, limit: int, now: float, x: float, y: float,
    z: float, store: Bundle, pairs: Floats, found: int,
) -> int:  # fmt: skip
    """Gather from the first `cells` of the window of a layer, or from its whole list if `cells` is negative.

    First only the links are followed: where the next cell begins is then known without waiting for what lies in the
    last one, and the rows of all candidates are fetched at the same time.
    """
    near, links, _, marks, layers, buckets, _, counters, settings = store_of(store)
    window, candidates = counters[COUNTERS:], counters[COUNTERS + MOST_CELLS :]
    newest_only = layer % LEVELS == MOVING and see & SEE_HISTORY == 0
    skipped = row if layer % LEVELS == MOVING and see & SKIP_OWN else -1  # rows are sources from 0 up
    visited, number, slot, cell = 0, max(cells, 0 if cells == 0 else 1), -1, 0
    together = MOST_CANDIDATES if limit > len(pairs) else 1  # whoever needs few leaves the others as they are
    ahead = counters[USED] > IN_CACHE
    if ahead:
        look_ahead(layer, cells, near, links, buckets, window)
    while (slot >= 0 or visited < number) and found < limit:
        count = 0
        while count < together:
            if slot >= 0:
                candidates[count] = slot
                if ahead:
                    prefetch(near, slot)
                count += 1 if cells < 0 or (links[slot, CELL] == cell and links[slot, LAYER] == layer) else 0
                slot = whole(marks[slot, AFTER] if cells < 0 else links[slot, NEXT])
            elif visited < number:
                cell = int(window[visited])
                slot = whole(layers[layer, HEAD]) if cells < 0 else whole(buckets[bucket_of(layer, cell, buckets)])
                visited += 1
            else:
                break
        if newest_only or skipped >= 0:
            count = keep_moving(count, newest_only, skipped, marks, candidates)
        count = renew(count, now, store)
        approach(count, margins, x, y, z, near, links, candidates, settings)
        measure(count, settings)
        found = keep_near(count, near, links, candidates, settings, pairs, found)
    return found


@part
def look_ahead(layer: int, cells: int, near: Floats, links: Links, buckets: Links, window: Ints) -> None:
    """Ask for the first gradient of each of the first `cells` of a window; most of a cell lies next to its first."""
    for index in range(cells):
        slot = whole(buckets[bucket_of(layer, int(window[index]), buckets)])
        if slot >= 0:
            prefetch(links, slot)
            prefetch(near, slot)


@part
def gather_poses(row: int, margins: Margins, see: int, limit: int, poses: Bundle, window: Ints, pairs: Floats) -> int:
    """Gather the shared poses of the other rows of the team: the newest, or all that are remembered."""
    own, rows, first, members, reach, extent, grid, buckets, links = poses_of(poses)
    team = int(rows[row, TEAM])
    begin, end = int(first[team]), int(first[team + 1])
    x, y, z = own[row, 0, X], own[row, 0, Y], own[row, 0, Z]
    ex, ey, ez = extent[0], extent[1], extent[2]
    half_x, half_y, half_z = half(ex), half(ey), half(ez)
    found, cells = 0, -1
    hearing = rows.shape[1] > HEARD
    if end - begin > CROWD and see & SEE_HISTORY == 0 and not hearing:  # cells know the newest poses only
        radius = max(margins[0], margins[1], margins[2]) + reach[team]
        cells = near_cells(x, y, z, radius, grid, min(team, 0), float(end - begin), window)
    for index in range(end - begin if cells < 0 else cells):
        cell = int(window[index]) if cells >= 0 else 0
        other = int(members[begin + index]) if cells < 0 else whole(buckets[bucket_of(team, cell, buckets)])
        while other >= 0 and found < limit:
            here, other = other, (-1 if cells < 0 else whole(links[other, 0]))
            if here == row or (cells >= 0 and (links[here, 1] != cell or rows[here, TEAM] != team)):
                continue
            newest = int(rows[row, HEARD + index]) if hearing else 0
            if newest < 0:
                continue
            for age in range(newest, rows[here, POSES] if see & SEE_HISTORY else min(rows[here, POSES], newest + 1)):
                sign, diffusion, goal = own[here, age, POSE_SIGN], own[here, age, DIFFUSION], own[here, age, GOAL]
                margin = margins[int(sign) + 1]
                dx = shortest(own[here, age, X] - x, ex, half_x)
                dy = shortest(own[here, age, Y] - y, ey, half_y)
                dz = shortest(own[here, age, Z] - z, ez, half_z)
                squared = dx * dx + dy * dy + dz * dz
                if margin == -np.inf or beyond(squared, margin + (diffusion + goal)):
                    continue
                distance = np.sqrt(squared)
                if distance > margin + (diffusion + goal):
                    continue
                if found < len(pairs):
                    pairs[found, DX], pairs[found, DY], pairs[found, DZ], pairs[found, DISTANCE] = dx, dy, dz, distance
                    pairs[found, PAIR_DIFFUSION], pairs[found, PAIR_GOAL] = diffusion, goal
                    pairs[found, SIGN], pairs[found, SLOT] = sign, -1.0 - (here + len(rows) * age)
                found += 1
    return found


@part
def beyond(squared: float, reach: float) -> bool:
    """Tell whether a squared distance [m2] is certainly longer than `reach` [m].

    Most candidates of a window are: this spares them the square root, which then decides the border exactly.
    """
    return reach < 0.0 or squared > reach * reach * 1.000000001
