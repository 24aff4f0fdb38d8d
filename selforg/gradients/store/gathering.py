"""Gathering: the gradients and poses that one row sees, written into a table of pairs.

A gradient is in view when the distance of the centres is at most its reach plus a margin [m]. The margin depends on
the sign of the gradient, because some formulas are zero beyond a shorter distance. Poses of teams of more than CROWD
robots lie in cells; in smaller teams all poses are looked at.
"""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.compiler.intrinsics import prefetch
from selforg.compiler.records import Handle, Written
from selforg.elementary import direction
from selforg.gradients.store import columns as c
from selforg.gradients.store.candidates import approach, keep_moving, keep_near, measure, renew
from selforg.gradients.store.linking import first_layer, space_of
from selforg.gradients.store.records import (
    MOST_CANDIDATES,
    Look,
    Margins,
    Poses,
    Sight,
    Store,
    open_poses,
    open_sight,
    open_store,
)
from selforg.grid import CELL_COLUMNS, axis_cells, bucket_of, cell_of, near_cells
from selforg.space import Space, half_of, shortest
from selforg.walls.segments import Walls, hides
from selforg.walls.ways import square_of, to_target, way_down

CROWD = 32  # robots of a team; docs/decisions/0019-crowd-cells.md
SHORTEST_WAY = 1e-12  # [m]
IN_CACHE = 4096  # gradients: so few lie in the cache anyway, and prefetching costs more than it saves


@inlined
def look_all_around(
    row: int, now: float, see: int, margins: Margins, begin: int, sight: Handle[Sight], poses: Handle[Poses]
) -> Look:
    """Return the look of a row from its newest pose at all within `margins`, written from the pair `begin` on."""
    own, pairs = open_poses(poses).own, open_sight(sight).pairs
    return Look(row, begin, len(pairs) + 1, now, see, margins, own[row, 0, c.X], own[row, 0, c.Y], own[row, 0, c.Z])


@part
def gather(look: Look, sight: Handle[Sight], poses: Handle[Poses], store: Written[Store]) -> int:
    """Write the gradients that a row sees into the pairs of `sight` from `look.first` on and return where it ends.

    Pairs beyond the end of the table are counted, not written; the caller then calls again with a longer table.
    """
    s, channels = open_store(store), open_sight(sight).channels
    found = look.first
    if look.sight_bits & c.SEE_MOVING and channels[0] == 1:
        found = gather_poses(look, sight, poses, store)
    if s.counters[c.COUNTER_USED] == 0:
        return found
    radius = max(look.margins[0], look.margins[1], look.margins[2])
    space = space_of(look.row, open_poses(poses).teams, store)
    for index in range(1, len(channels)):
        first = first_layer(int(channels[index]), space, store)
        for level in range(c.LEVELS):
            members = s.layers[first + level, c.LAYER_COUNT]
            looked_at = look.sight_bits & (c.SEE_MOVING if level == c.MOVING else c.SEE_STATIC)
            if members == 0 or found >= look.limit or looked_at == 0:
                continue
            cells = -1
            if level < c.UNBOUNDED:
                within = radius + s.bounds[level]
                stored = float(members + s.layers[first + level, c.LAYER_GONE])  # so looking changes no order
                cells = near_cells(look.x, look.y, look.z, within, s.cells, level, stored, s.window)
            found = gather_layer(first + level, cells, found, look, sight, poses, store)
    if open_poses(poses).aims.shape[1] > 0:
        turn_round_walls(look, min(found, len(open_sight(sight).pairs)), sight, poses, store)
    return found


@part
def turn_round_walls(look: Look, found: int, sight: Handle[Sight], poses: Handle[Poses], store: Handle[Store]) -> None:
    """Turn the offsets to the aims among the first `found` pairs into the ways round walls, of the same lengths."""
    p, s, pairs = open_poses(poses), open_store(store), open_sight(sight).pairs
    team, x, y = p.teams[look.row], look.x - p.corner[0], look.y - p.corner[1]
    for index in range(look.first, found):
        slot = int(pairs[index, c.PAIR_SLOT])
        if slot < 0 or pairs[index, c.PAIR_SIGN] <= 0.0:
            continue
        tx, ty = s.near[slot, c.X] - p.corner[0], s.near[slot, c.Y] - p.corner[1]
        line, column = square_of(tx, ty, p.room, p.pitch)
        for target in range(p.aims.shape[1]):
            number = p.aims[team, target]
            if number < 0 or p.aim_squares[number, 0] != line or p.aim_squares[number, 1] != column:
                continue
            _, _, straight = to_target(x, y, tx, ty, p.extent, p.room, p.pitch)
            if not straight:
                wx, wy = way_down(x, y, p.fields[number], p.room, p.pitch, p.extent)
                scale = pairs[index, c.PAIR_DISTANCE] / max(np.sqrt(wx * wx + wy * wy), SHORTEST_WAY)
                pairs[index, c.PAIR_DX], pairs[index, c.PAIR_DY] = scale * wx, scale * wy
            break


@inlined
def walls_of_poses(p: Poses) -> Walls:
    """Return the walls that poses know."""
    g = p.wall_grid
    return Walls(p.segments, p.cell_lists, p.listed, p.clear, g[0], g[1], g[2], g[3], int(g[4]), int(g[5]))


@part
def keep_in_view(count: int, look: Look, poses: Handle[Poses], store: Handle[Store]) -> int:
    """Keep of the first `count` candidates those that no wall hides from the row; return how many."""
    s, p = open_store(store), open_poses(poses)
    w, kept = walls_of_poses(p), 0
    for index in range(count):
        if hides(look.x, look.y, s.offsets_x[index], s.offsets_y[index], p.extent, w):
            continue
        s.candidates[kept], s.reaches[kept], s.distances[kept] = (
            s.candidates[index],
            s.reaches[index],
            s.distances[index],
        )
        s.offsets_x[kept], s.offsets_y[kept] = s.offsets_x[index], s.offsets_y[index]
        s.offsets_z[kept] = s.offsets_z[index]
        kept += 1
    return kept


@part
def gather_layer(
    layer: int, cells: int, found: int, look: Look, sight: Handle[Sight], poses: Handle[Poses], store: Written[Store]
) -> int:
    """Gather from the first `cells` of the window of a layer, or from its whole list if `cells` is negative.

    First only the links are followed. The beginning of the next cell is then known before the rows of the last one have
    been fetched, and the rows of all candidates are fetched at the same time.
    """
    s = open_store(store)
    moving = layer % c.LEVELS == c.MOVING
    newest_only = moving and look.sight_bits & c.SEE_HISTORY == 0
    skipped = look.row if moving and look.sight_bits & c.SKIP_OWN else -1  # rows are sources from 0 up
    visited, number, slot, cell = 0, max(cells, 0 if cells == 0 else 1), -1, 0
    # a caller that needs few pairs must not evaporate other gradients
    together = MOST_CANDIDATES if look.limit > len(open_sight(sight).pairs) else 1
    ahead = s.counters[c.COUNTER_USED] > IN_CACHE
    if ahead:
        look_ahead(layer, cells, store)
    while (slot >= 0 or visited < number) and found < look.limit:
        count = 0
        while count < together:
            if slot >= 0:
                s.candidates[count] = slot
                if ahead:
                    prefetch(s.near, slot)
                here = s.links[slot, c.LINK_CELL] == cell and s.links[slot, c.LINK_LAYER] == layer
                count += 1 if cells < 0 or here else 0
                slot = s.marks[slot, c.MARK_AFTER] if cells < 0 else s.links[slot, c.LINK_NEXT]
            elif visited < number:
                cell = int(s.window[visited])
                slot = s.layers[layer, c.LAYER_HEAD] if cells < 0 else s.buckets[bucket_of(layer, cell, s.buckets)]
                visited += 1
            else:
                break
        count = renew(count, look.now, store)
        if newest_only or skipped >= 0:
            count = keep_moving(count, newest_only, skipped, store)
        approach(count, look, store)
        measure(count, store)
        if s.hidden:
            count = keep_in_view(count, look, poses, store)
        found = keep_near(count, found, sight, store)
    return found


@part
def look_ahead(layer: int, cells: int, store: Handle[Store]) -> None:
    """Prefetch the first gradient of the first `cells` of a window; most of a cell lies next to its first."""
    s = open_store(store)
    for index in range(cells):
        slot = s.buckets[bucket_of(layer, int(s.window[index]), s.buckets)]
        if slot >= 0:
            prefetch(s.links, slot)
            prefetch(s.near, slot)


def make_pose_cells(space: Space, reach: float, sizes: Ints) -> Floats:
    """Return the grid (1, CELL_COLUMNS) for poses of one `reach` [m], of teams of some `sizes` (T,).

    A cell is wide enough for about one robot, because looking into empty cells costs more than looking at robots that
    are too far away.
    """
    width = max(reach, 0.1) if np.isfinite(reach) else 1.0
    width = max(width, float(np.prod(space.extent) / sizes.max()) ** (1.0 / space.dim))
    cells = np.zeros((1, CELL_COLUMNS))
    for axis, side in enumerate(space.padded_extent):
        cells[0, 2 * axis : 2 * axis + 2] = axis_cells(side, width, 1024.0 if side <= 0.0 else np.inf)
    return cells


@lean_kernel
def index_poses(poses: Handle[Poses]) -> None:
    """Write the largest reach of every team, and put the rows of large teams into cells."""
    p = open_poses(poses)
    crowded = False
    for team in range(len(p.reach)):
        p.reach[team] = 0.0
        crowded |= p.first[team + 1] - p.first[team] > CROWD
        for index in range(p.first[team], p.first[team + 1]):
            row = p.members[index]
            if p.rows[row, c.ROW_POSES] > 0:
                p.reach[team] = max(p.reach[team], p.own[row, 0, c.DIFFUSION] + p.own[row, 0, c.GOAL_RADIUS])
    if not crowded:
        return
    p.buckets[:] = -1
    for row in range(len(p.rows) - 1, -1, -1):  # backwards: a bucket then lists its rows in their order
        team = int(p.teams[row])
        if p.rows[row, c.ROW_POSES] == 0 or p.first[team + 1] - p.first[team] <= CROWD:
            continue
        cell = cell_of(p.own[row, 0, c.X], p.own[row, 0, c.Y], p.own[row, 0, c.Z], p.cells, 0)
        bucket = bucket_of(team, cell, p.buckets)
        p.links[row, 0] = p.buckets[bucket]
        p.links[row, 1] = cell
        p.buckets[bucket] = row


@part
def gather_poses(look: Look, sight: Handle[Sight], poses: Handle[Poses], store: Handle[Store]) -> int:
    """Gather the shared poses of the other rows of the team: the newest, or all that are remembered."""
    p, window, pairs = open_poses(poses), open_store(store).window, open_sight(sight).pairs
    row, history = look.row, look.sight_bits & c.SEE_HISTORY
    team = int(p.teams[row])
    begin, end = int(p.first[team]), int(p.first[team + 1])
    ex, ey, ez = p.extent[0], p.extent[1], p.extent[2]
    half_x, half_y, half_z = half_of(ex), half_of(ey), half_of(ez)
    found, cells = look.first, -1
    hearing = p.rows.shape[1] > c.ROW_HEARD
    if end - begin > CROWD and history == 0 and not hearing:  # cells know the newest poses only
        radius = max(look.margins[0], look.margins[1], look.margins[2]) + p.reach[team]
        cells = near_cells(look.x, look.y, look.z, radius, p.cells, 0, float(end - begin), window)
    for index in range(end - begin if cells < 0 else cells):
        cell = int(window[index]) if cells >= 0 else 0
        other = int(p.members[begin + index]) if cells < 0 else p.buckets[bucket_of(team, cell, p.buckets)]
        while other >= 0 and found < look.limit:
            here, other = other, (-1 if cells < 0 else p.links[other, 0])
            if here == row or (cells >= 0 and (p.links[here, 1] != cell or p.teams[here] != team)):
                continue
            newest = int(p.rows[row, c.ROW_HEARD + index]) if hearing else 0
            if newest < 0:
                continue
            known = p.rows[here, c.ROW_POSES]
            for age in range(newest, known if history else min(known, newest + 1)):
                sign, diffusion = p.own[here, age, c.POSE_SIGN], p.own[here, age, c.DIFFUSION]
                goal, margin = p.own[here, age, c.GOAL_RADIUS], look.margins[int(sign) + 1]
                dx = shortest(p.own[here, age, c.X] - look.x, ex, half_x)
                dy = shortest(p.own[here, age, c.Y] - look.y, ey, half_y)
                dz = shortest(p.own[here, age, c.Z] - look.z, ez, half_z)
                squared = dx * dx + dy * dy + dz * dz
                if margin == -np.inf or beyond(squared, margin + (diffusion + goal)):
                    continue
                distance = np.sqrt(squared)
                if distance > margin + (diffusion + goal):
                    continue
                if found < len(pairs):
                    pairs[found, c.PAIR_DX], pairs[found, c.PAIR_DY], pairs[found, c.PAIR_DZ] = dx, dy, dz
                    pairs[found, c.PAIR_DISTANCE], pairs[found, c.PAIR_SIGN] = distance, sign
                    pairs[found, c.PAIR_DIFFUSION], pairs[found, c.PAIR_GOAL_RADIUS] = diffusion, goal
                    pairs[found, c.PAIR_SLOT] = -1.0 - (here + len(p.rows) * age)
                found += 1
    return found


@part
def beyond(squared: float, reach: float) -> bool:
    """Return whether a squared distance [m2] is certainly longer than `reach` [m].

    This spares most candidates of a window the square root, which decides exactly for the others.
    """
    return reach < 0.0 or squared > reach * reach * 1.000000001


@lean_kernel
def keep_ahead(
    row: int, found: int, angle_xy: float, angle_yz: float, sight: Handle[Sight], poses: Handle[Poses]
) -> int:
    """Keep of the first `found` pairs those within the view angles [rad] of the own heading; return how many."""
    own, pairs = open_poses(poses).own, open_sight(sight).pairs
    x, y, z = own[row, 0, c.POSE_HEADING], own[row, 0, c.POSE_HEADING + 1], own[row, 0, c.POSE_HEADING + 2]
    kept = 0
    for index in range(found):
        xy = angle_between(x, y, pairs[index, c.PAIR_DX], pairs[index, c.PAIR_DY])
        yz = angle_between(y, z, pairs[index, c.PAIR_DY], pairs[index, c.PAIR_DZ])
        if xy <= angle_xy and yz <= angle_yz:
            for column in range(c.PAIR_COLUMNS):
                pairs[kept, column] = pairs[index, column]
            kept += 1
    return kept


@part
def angle_between(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the angle [rad] in [0, pi] between two plane vectors; a zero vector points along the first axis."""
    difference = abs(direction(ay, ax) - direction(by, bx))
    return min(difference, 2.0 * np.pi - difference)
