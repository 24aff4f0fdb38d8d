"""Who belongs to the team of each world: robots that join during a mission, are taken away, or fail.

A robot that works has a row at work; one that is absent is nowhere: it has no pose, touches nobody, senses nothing and
leaves nothing. A robot that has failed is a body without a mind: it stands, can be pushed, counts in collisions and, if
the mission says so, still carries its pose gradient. Who is gone stays gone: robots that join get rows never used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.starts import START_GAP, nearest_distance
from clean_swarm_env.world.littering import drop_cargo
from selforg.registry import unknown

if TYPE_CHECKING:
    from clean_swarm_env.world.worlds import Worlds

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Place = tuple[float, float, float]
MAX_TRIES: Final = 1_000
"""Draws for a free place before a robot that wants to join has to wait."""


class Team:
    """The robots of all worlds of a batch that are there and at work; see `Worlds` for the letters.

    Attributes:
        working: (R,) bool, robots that sense, decide and act; read only.
        joined: (W,) int64, rows of each world that have been used since its reset; read only.
        at_work: (K,) the rows that work, or None if all do.

    """

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self.working = np.zeros(worlds.rows, dtype=np.bool_)
        self.joined: Ints = np.zeros(worlds.worlds, dtype=np.int64)
        self.at_work: Ints | None = None

    def begin(self, world: int, places: Floats) -> None:
        """Let the first robots of a world begin at `places` (K, 3), x [m], y [m], heading [rad]; others are absent."""
        worlds, count = self._worlds, len(places)
        rows, padded = worlds.rows_of(world), np.zeros((worlds.robots, 3))
        padded[:count] = places
        worlds.physics.place(world, padded[:, :2], padded[:, 2])
        for row in rows[count:].tolist():
            worlds.physics.remove(row)
        worlds.poses.silence(rows[count:])
        worlds.poses.silence(rows[:count], False)
        self.joined[world] = count
        self.working[rows] = np.arange(worlds.robots) < count
        self._begin_anew(rows)

    def add(self, world: int, place: Place) -> int:
        """Let the next robot of a world begin at `place` (x [m], y [m], heading [rad]); return its row.

        Raises ValueError if the world has no more rows, or if another body is in the way.
        """
        worlds, number = self._worlds, int(self.joined[world])
        if number == worlds.robots:
            raise ValueError(f"world {world}: expected at most {number} robots over the mission (robots.capacity)")
        if not self.is_free(world, np.array(place[:2])):
            raise ValueError(f"world {world}: another robot is at the place [{place[0]:g}, {place[1]:g}]")
        row = world * worlds.robots + number
        worlds.physics.add(row, *place)
        worlds.poses.silence([row], False)
        self.joined[world] += 1
        self.working[row] = True
        self._begin_anew(np.array([row]))
        return row

    def remove(self, rows: Ints) -> None:
        """Take the robots in `rows` (K,) away; what they carry lies where they were. They must be at work."""
        self._drop_cargo(rows)
        for row in rows.tolist():
            self._worlds.physics.remove(row)
        self._worlds.poses.silence(rows)
        self._stop_working(rows)

    def fail(self, rows: Ints) -> None:
        """Let the robots in `rows` (K,) fail: their bodies stay, what they carry lies there. They must be at work."""
        self._drop_cargo(rows)
        if self._worlds.mission.robots.failed_pose == "unseen":
            self._worlds.poses.silence(rows)
        self._stop_working(rows)

    def is_free(self, world: int, point: Floats) -> bool:
        """Tell whether a robot finds room at `point` (2,) [m]; robots that drive through each other always do."""
        worlds = self._worlds
        if worlds.mission.world.contacts != "solid":
            return True
        rows = worlds.rows_of(world)
        bodies = worlds.physics.positions[rows[worlds.physics.present[rows]]]
        apart = 2.0 * worlds.mission.robots.radius + START_GAP
        return nearest_distance(point % worlds.extent, bodies, worlds.extent) >= apart

    def free_place(self, world: int, rng: np.random.Generator) -> Place | None:
        """Return a random free place (x [m], y [m], heading [rad]), or None if none was found."""
        heading = float(rng.uniform(-np.pi, np.pi))
        for _ in range(MAX_TRIES):
            point = rng.uniform(size=2) * self._worlds.extent
            if self.is_free(world, point):
                return float(point[0]), float(point[1]), heading
        return None

    def _drop_cargo(self, rows: Ints) -> None:
        for row in rows.tolist():
            if not 0 <= row < len(self.working) or not self.working[row]:
                raise ValueError(unknown("robot at work", str(row), [str(r) for r in np.flatnonzero(self.working)]))
        for row in rows.tolist():
            drop_cargo(self._worlds, row)

    def _stop_working(self, rows: Ints) -> None:
        self.working[rows] = False
        self._begin_anew(rows)

    def _begin_anew(self, rows: Ints) -> None:
        """Let the minds of `rows` (K,) forget everything."""
        self._worlds.begin_anew(rows)
        self.at_work = None if self.working.all() else np.flatnonzero(self.working)
