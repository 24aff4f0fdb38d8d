"""What a selector sees of each robot: named terms, all within [-1, 1], computed for all rows at once.

Directions are unit vectors in the robot's own frame (first component ahead, second to the left); distances are divided
by the longest way on the torus, or by the range within which the thing is seen, and are 1 where nothing is seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config import MissionConfig
from clean_swarm_env.garbage import NOTHING, nearest_lying
from clean_swarm_env.worlds import Worlds
from selforg.compiled import kernel
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Observations = NDArray[np.float32]

TERMS = (
    "garbage_seen",  # 1 if an item lies within sight
    "garbage_distance",  # to the nearest item, by the sight range; 1 if none is seen
    "garbage_ahead",
    "garbage_left",
    "carrying",
    "recycled",
    "recycling_distance",  # by half the torus' diagonal
    "recycling_ahead",
    "recycling_left",
    "dump_distance",  # by half the torus' diagonal
    "dump_ahead",
    "dump_left",
    "neighbours",  # share of the other robots within neighbour range
    "neighbour_distance",  # to the nearest, by the neighbour range; 1 if none is near
    "neighbour_ahead",
    "neighbour_left",
    "avoidance_length",  # of the held option's vector, by the reach of a pose; 1 if longer
    "speed",  # by the largest speed
    "turn_rate",  # by the largest turn rate
    "garbage_done",  # share of the items dumped of those that arrived
    "time_left",  # share of the time limit
)
NEIGHBOUR_RANGE = 2.5
"""Centre distance within which robots count as neighbours [m]: as far as the longest-sighted option looks."""


def names(options: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of the components of an observation: the terms, then one flag for each option held."""
    return (*TERMS, *(f"holds_{option}" for option in options))


class Observer:
    """Observations (R, F) of a batch of worlds; `width` is F."""

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self._mission: MissionConfig = worlds.mission
        self.names = names(worlds.coordinator.model.options)
        self.width = len(self.names)
        robots, garbage, extent = self._mission.robots, self._mission.garbage, worlds.extent
        sight = garbage.diffusion + garbage.goal_radius + garbage.view_distance
        reach = max(robots.pose_diffusion + robots.pose_goal_radius, 1e-9)
        self._scales = np.array(
            [
                sight,
                0.5 * float(np.hypot(*extent)),
                NEIGHBOUR_RANGE,
                reach,
                robots.max_speed,
                robots.max_turn_rate,
            ]
        )
        self._length_column = worlds.network.model.sensor_index.get("rep_len", -1)
        self._all = np.arange(worlds.worlds)

    def observe(self, observations: Observations, chosen: Ints | None = None) -> None:
        """Fill `observations` (R, F) with what is so now, of all worlds or of the `chosen` (K,)."""
        worlds, garbage, physics = self._worlds, self._worlds.garbage, self._worlds.physics
        share_done = garbage.done / np.maximum(garbage.arrived, 1)
        time_left = np.maximum(1.0 - worlds.ticks * worlds.period / self._mission.time_limit, 0.0)
        fill(
            self._all if chosen is None else chosen, physics.positions, physics.headings, worlds.drive.speed,
            worlds.drive.turn_rate, worlds.extent,
            worlds.stations, self._scales, physics.present, garbage.positions, garbage.stage, garbage.cargo,
            garbage.recycled, worlds.network.readings, self._length_column, share_done, time_left,
            worlds.coordinator.held, observations,
        )  # fmt: skip


@kernel
def point(
    x: float, y: float, heading: float, tx: float, ty: float, extent: Floats, scale: float, out: Observations, at: int
) -> None:
    """Write distance by `scale` (at most 1) and direction in the robot's frame of a point into out[at : at + 3]."""
    dx, dy = nearest_image(tx - x, extent[0]), nearest_image(ty - y, extent[1])
    length = np.sqrt(dx * dx + dy * dy)
    out[at] = min(length / scale, 1.0)
    ahead, left = 0.0, 0.0
    if length > 0.0:
        cosine, sine = np.cos(heading), np.sin(heading)
        ahead, left = (cosine * dx + sine * dy) / length, (cosine * dy - sine * dx) / length
    out[at + 1] = min(max(ahead, -1.0), 1.0)
    out[at + 2] = min(max(left, -1.0), 1.0)


@kernel
def nearest_neighbour(
    row: int, first: int, last: int, robots: Floats, present: Flags, extent: Floats
) -> tuple[int, int, int, float]:
    """Return how many others of the rows [first, last) are in range, how many are present, the nearest, its distance.

    The nearest one in range is -1 if there is none; the distance in [m].
    """
    count, others, best, shortest = 0, 0, -1, np.inf
    for other in range(first, last):
        if other == row or not present[other]:
            continue
        others += 1
        dx = nearest_image(robots[other, 0] - robots[row, 0], extent[0])
        dy = nearest_image(robots[other, 1] - robots[row, 1], extent[1])
        length = np.sqrt(dx * dx + dy * dy)
        if length <= NEIGHBOUR_RANGE:
            count += 1
            if length < shortest:
                best, shortest = other, length
    return count, others, best, shortest


@kernel
def fill(
    chosen: Ints, robots: Floats, headings: Floats, speed: Floats, turn_rate: Floats, extent: Floats, stations: Floats,
    scales: Floats, present: Flags, positions: Floats, stage: Ints, cargo: Ints, recycled: Ints, readings: Floats,
    length_column: int, share_done: Floats, time_left: Floats, held: Ints, out: Observations,
) -> None:  # fmt: skip
    """Fill `out` (R, F) of the worlds `chosen` (K,) in the order of TERMS.

    Robots that are not `present` (R,) see nothing.
    stations (W, 2, 2) [m]; scales (6,): sight, torus, neighbours, vector, speed, turn rate.
    """
    per_world = robots.shape[0] // positions.shape[0]
    for index in range(chosen.shape[0] * per_world):
        world = chosen[index // per_world]
        row = world * per_world + index % per_world
        x, y, heading = robots[row, 0], robots[row, 1], headings[row]
        seen = out[row]
        seen[:] = 0.0
        if not present[row]:
            continue
        item, near = nearest_lying(x, y, positions[world], stage[world], extent)
        seen[1] = 1.0
        if near <= scales[0]:
            seen[0] = 1.0
            point(x, y, heading, positions[world, item, 0], positions[world, item, 1], extent, scales[0], seen, 1)
        seen[4] = 1.0 if cargo[row] != NOTHING else 0.0
        seen[5] = float(recycled[row])
        point(x, y, heading, stations[world, 0, 0], stations[world, 0, 1], extent, scales[1], seen, 6)
        point(x, y, heading, stations[world, 1, 0], stations[world, 1, 1], extent, scales[1], seen, 9)
        first = world * per_world
        count, others, other, _ = nearest_neighbour(row, first, first + per_world, robots, present, extent)
        seen[13] = 1.0
        if other >= 0:
            seen[12] = count / others
            point(x, y, heading, robots[other, 0], robots[other, 1], extent, scales[2], seen, 13)
        if length_column >= 0:
            seen[16] = min(readings[row, length_column] / scales[3], 1.0)
        seen[17] = min(speed[row] / scales[4], 1.0)
        seen[18] = min(max(turn_rate[row] / scales[5], -1.0), 1.0)
        seen[19] = share_done[world]
        seen[20] = time_left[world]
        seen[21 + held[row]] = 1.0
