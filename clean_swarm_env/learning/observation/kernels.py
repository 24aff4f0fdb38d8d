"""All components of all observation terms of a row, compiled; `observation_terms` says what they mean.

Shapes: W worlds, N robots a world, R = W * N rows, A components in the order of `TERMS`, K neighbour ranges.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.terms import APPROACH, PATROL, TERMS, TO_DUMP, TO_RECYCLING
from clean_swarm_env.world.garbage import LYING, NOTHING
from clean_swarm_env.world.nearby import NOBODY, cell_at, cells_along, fill_cells, nearest_point
from selforg.compiler.decorators import kernel
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MARGIN = 1.0 + 1e-9  # by which cells are wider than what is in range, for rounding

# Places in `scales`
SIGHT, LONGEST, NEIGHBOURS, REACH, SPEED, TURN_RATE, STATION, CROWD, PATIENCE, SHARE = range(10)
# First components of the terms before `crowd`, whose components are as many as there are ranges
_SIZES = [len(names) for _, names in TERMS.values()]
GARBAGE, CARGO, PHASE, SITUATION, RECYCLING, DUMP, NEARNESS, TARGET, NEIGHBOUR, ENCOUNTER, CROWDING = (
    sum(_SIZES[:term]) for term in range(11)
)


@kernel
def way(x: float, y: float, heading: float, tx: float, ty: float, extent: Floats, scale: float, out: Floats) -> float:
    """Write distance by `scale` (at most 1) and direction in the robot's frame of a point; return the distance [m]."""
    dx, dy = nearest_image(tx - x, extent[0]), nearest_image(ty - y, extent[1])
    length = float(np.sqrt(dx * dx + dy * dy))
    out[0] = min(length / scale, 1.0)
    if length > 0.0:
        cosine, sine = np.cos(heading), np.sin(heading)
        out[1] = min(max((cosine * dx + sine * dy) / length, -1.0), 1.0)
        out[2] = min(max((cosine * dy - sine * dx) / length, -1.0), 1.0)
    return length


@kernel
def see_neighbours(
    row: int, first: int, team: int, robots: Floats, headings: Floats, velocities: Floats, present: Flags,
    cells: Ints, links: Ints, cargo: Ints, extent: Floats, scales: Floats, squares: Floats, seen: Floats,
) -> None:  # fmt: skip
    """Write the terms of the other ones of the `team` robots that are present in the world whose rows begin at `first`.

    cells, links (N,): of the world's robots, see `nearby`; squares (K,): of the neighbour ranges [m^2]; seen (A,): of
    the row.
    """
    ranges = squares.shape[0]
    best, shortest, carriers = -1, squares[ranges - 1], 0
    lines, columns = cells.shape
    line, column, walks = 0, 0, 1
    if lines > 0:
        line, column = cell_at(robots[row, 1], lines, extent[1]), cell_at(robots[row, 0], columns, extent[0])
        walks = 9
    for walk in range(walks):
        point = cells[(line + walk // 3 - 1) % lines, (column + walk % 3 - 1) % columns] if lines > 0 else 0
        while point != NOBODY:
            other = first + point
            point = links[point] if lines > 0 else (point + 1 if point + 1 < links.shape[0] else NOBODY)
            if other == row or not present[other]:
                continue
            dx = nearest_image(robots[other, 0] - robots[row, 0], extent[0])
            dy = nearest_image(robots[other, 1] - robots[row, 1], extent[1])
            square = dx * dx + dy * dy
            if square > squares[ranges - 1]:
                continue
            carriers += cargo[other] != NOTHING
            for k in range(ranges):
                seen[CROWDING + k] += square <= squares[k]
            if best < 0 or square < shortest or (square == shortest and other < best):
                best, shortest = other, square
    seen[NEIGHBOUR + 1] = 1.0
    if best >= 0:
        seen[NEIGHBOUR] = seen[CROWDING + ranges - 1] / (team - 1)
        meet(row, best, robots, headings, velocities, extent, scales, seen)
        seen[ENCOUNTER + 3] = 1.0 if cargo[best] != NOTHING else 0.0
    for k in range(ranges):
        seen[CROWDING + k] = min(seen[CROWDING + k] / scales[CROWD], 1.0)
    seen[CROWDING + ranges] = min(carriers / scales[CROWD], 1.0)


@kernel
def meet(
    row: int, other: int, robots: Floats, headings: Floats, velocities: Floats, extent: Floats, scales: Floats,
    seen: Floats,
) -> None:  # fmt: skip
    """Write where the nearest neighbour is, where it heads and how fast it comes closer."""
    x, y = robots[other, 0], robots[other, 1]
    length = way(robots[row, 0], robots[row, 1], headings[row], x, y, extent, scales[NEIGHBOURS], seen[NEIGHBOUR + 1 :])
    turned = headings[other] - headings[row]
    seen[ENCOUNTER], seen[ENCOUNTER + 1] = np.cos(turned), np.sin(turned)
    if length > 0.0:
        dx = nearest_image(x - robots[row, 0], extent[0]) / length
        dy = nearest_image(y - robots[row, 1], extent[1]) / length
        closing = (velocities[row, 0] - velocities[other, 0]) * dx + (velocities[row, 1] - velocities[other, 1]) * dy
        seen[ENCOUNTER + 2] = min(max(closing / (2.0 * scales[SPEED]), -1.0), 1.0)


@kernel
def see_task(
    x: float, y: float, heading: float, item: int, near: float, items: Floats, carrying: bool, recycled: bool,
    stations: Floats, extent: Floats, scales: Floats, seen: Floats,
) -> int:  # fmt: skip
    """Write the terms of garbage, cargo and stations (2, 2) [m] into `seen` (A,) and return the phase."""
    phase = PATROL
    seen[GARBAGE + 1] = 1.0
    if near <= scales[SIGHT]:
        phase = APPROACH
        seen[GARBAGE] = 1.0
        way(x, y, heading, items[item, 0], items[item, 1], extent, scales[SIGHT], seen[GARBAGE + 1 :])
    if carrying:
        phase = TO_DUMP if recycled else TO_RECYCLING
    seen[CARGO] = 1.0 if carrying else 0.0
    seen[CARGO + 1] = 1.0 if recycled else 0.0
    seen[PHASE + phase] = 1.0
    to_recycling = way(x, y, heading, stations[0, 0], stations[0, 1], extent, scales[LONGEST], seen[RECYCLING:])
    to_dump = way(x, y, heading, stations[1, 0], stations[1, 1], extent, scales[LONGEST], seen[DUMP:])
    near_station = min(to_recycling, to_dump) <= scales[STATION]
    seen[SITUATION + 2 * carrying + near_station] = 1.0
    seen[NEARNESS] = max(1.0 - to_recycling / scales[STATION], 0.0)
    seen[NEARNESS + 1] = max(1.0 - to_dump / scales[STATION], 0.0)
    seen[TARGET] = 1.0
    if carrying:
        goal = DUMP if recycled else RECYCLING
        for k in range(3):
            seen[TARGET + k] = seen[goal + k]
    return phase


@kernel
def see(
    chosen: Ints, robots: Floats, headings: Floats, velocities: Floats, present: Flags, speed: Floats,
    turn_rate: Floats, extent: Floats, stations: Floats, scales: Floats, squares: Floats, items: Floats, stage: Ints,
    cargo: Ints, recycled: Ints, done: Ints, arrived: Ints, ticks: Ints, limits: Ints, idle: Ints,
    readings: Floats, length_column: int, executing: Ints, avoiding: int, held: Ints, held_columns: Ints, phases: Ints,
    out: Floats,
) -> None:  # fmt: skip
    """Fill `out` (R, A) and `phases` (R,) for the worlds `chosen`; robots that are not `present` (R,) see nothing."""
    per_world = robots.shape[0] // items.shape[0]
    after_crowd = CROWDING + squares.shape[0] + 1
    count, apart = items.shape[1], np.sqrt(squares[-1]) * MARGIN
    robot_cells = np.empty(cells_along(per_world, apart, extent), np.int64)
    item_cells = np.empty(cells_along(count, scales[SIGHT] * MARGIN, extent), np.int64)
    robot_links, item_links = np.empty(per_world, np.int64), np.empty(count, np.int64)
    first, team, lying = 0, 0, stage[0] == LYING
    for index in range(chosen.shape[0] * per_world):
        world = chosen[index // per_world]
        row = world * per_world + index % per_world
        if index % per_world == 0:
            first, team, lying = row, 0, stage[world] == LYING
            for other in range(first, first + per_world):
                team += present[other]
            fill_cells(robots, first, present[first : first + per_world], extent, robot_cells, robot_links)
            fill_cells(items[world], 0, lying, extent, item_cells, item_links)
        seen = out[row]
        seen[:] = 0.0
        phases[row] = PATROL
        if not present[row]:
            continue
        x, y = robots[row, 0], robots[row, 1]
        _, item, near = nearest_point(
            x, y, -1, scales[SIGHT], items[world], 0, lying, extent, item_cells, item_links
        )  # fmt: skip
        phases[row] = see_task(
            x, y, headings[row], item, near, items[world], cargo[row] != NOTHING, recycled[row] == 1,
            stations[world], extent, scales, seen,
        )  # fmt: skip
        see_neighbours(
            row, first, team, robots, headings, velocities, present, robot_cells, robot_links, cargo, extent, scales,
            squares, seen,
        )  # fmt: skip
        rest = seen[after_crowd:]
        if length_column >= 0:
            rest[0] = min(readings[row, length_column] / scales[REACH], 1.0)
        if avoiding >= 0:
            rest[1] = float(executing[row, avoiding])
        rest[2] = min(speed[row] / scales[SPEED], 1.0)
        rest[3] = min(max(turn_rate[row] / scales[TURN_RATE], -1.0), 1.0)
        rest[4] = done[world] / max(arrived[world], 1)
        rest[5] = max(1.0 - ticks[world] / limits[world], 0.0)
        rest[6] = min(idle[row] / scales[PATIENCE], 1.0)
        rest[7] = min(team * scales[SHARE], 1.0)
        for k in range(held_columns.shape[0]):
            seen[held_columns[k] + held[row, k]] = 1.0
