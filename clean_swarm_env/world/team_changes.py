"""The team of each world: robots that join during a mission, are taken away, or fail.

A robot at work has a row that is `working`. An absent robot has no pose, touches no robot, senses nothing and deposits
nothing. A robot that has failed is a body that decides nothing: it stands, can be pushed, counts in collisions and, if
the mission says so, still carries its pose gradient. No robot comes back: robots that join get rows never used before.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, NamedTuple

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import has_room
from clean_swarm_env.world.floor import Floor
from clean_swarm_env.world.minds import Minds
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.declared import make_arrays
from selforg.program import STARTING, Rows, Step
from selforg.registry import unknown

Place = tuple[float, float, float]
MOST_DRAWS: Final = 1_000
"""Draws for a free place before a robot that is to join has to wait."""


class AtWork(NamedTuple):
    """Robots at work, and those that decide in this tick."""

    working: Annotated[Flags, "R", READ]
    able: Annotated[Ints, "R", SCRATCH]  # rows that decide, the first `length`
    length: Annotated[Ints, "1", SCRATCH]


open_team = opening(AtWork)


class Team:
    """The robots of all worlds of a batch that are present and at work; see `Worlds` for the letters.

    Attributes:
        working: (R,) bool, robots that sense, decide and act; read only.
        joined: (W,) int64, rows of each world that have been used since its reset; read only.
        able: the rows that decide in this tick.
        packed: the record of `working` and `able`.
        task: is told about robots that come and go, by `lose` and `renew`.

    """

    working: Annotated[Flags, "R", KEPT]
    joined: Annotated[Ints, "W", KEPT]
    task: Any
    _radii: Annotated[Floats, "R", READ]  # [m]

    def __init__(self, mission: MissionConfig, floor: Floor, minds: Minds) -> None:
        self._mission, self._floor, self._minds = mission, floor, minds
        self._radii = np.tile(mission.of_each("radius"), floor.worlds)
        make_arrays(self, R=minds.rows, W=floor.worlds)
        self.able = Rows.of(np.arange(minds.rows))
        self.packed = Packed(AtWork(self.working, *self.able))

    def starting(self) -> Step:
        """Return the step that lets all robots at work decide in a tick; a later step of STARTING may list fewer."""
        rows = Rows.of(np.arange(len(self.working)))
        return Step(STARTING, list_working, rows, list_working, (self.packed,))

    def reset(self, world: int, places: Floats) -> None:
        """Put the first robots of a world at `places` (K, 3), x [m], y [m], heading [rad]; the others are absent."""
        floor, poses, count = self._floor, self._minds.poses, len(places)
        rows, padded = floor.rows_of(world), np.zeros((floor.robots, 3))
        padded[:count] = places
        floor.physics.place(world, padded[:, :2], padded[:, 2])
        for row in rows[count:].tolist():
            floor.physics.remove(row)
        poses.silence(rows[count:])
        poses.silence(rows[:count], False)
        self.joined[world] = count
        self.working[rows] = np.arange(floor.robots) < count
        self._renew(rows)

    def add(self, world: int, place: Place) -> int:
        """Add the next robot of a world at `place` (x [m], y [m], heading [rad]); return its row.

        Raises ValueError if the world has no more rows, or if another body is in the way.
        """
        floor, number = self._floor, int(self.joined[world])
        if number == floor.robots:
            raise ValueError(f"world {world}: expected at most {number} robots over the mission (robots.capacity)")
        row = self.next_row(world)
        if not self.is_free(row, np.array(place[:2])):
            raise ValueError(f"world {world}: another robot is at the place [{place[0]:g}, {place[1]:g}]")
        floor.physics.add(row, *place)
        self._minds.poses.silence([row], False)
        self.joined[world] += 1
        self.working[row] = True
        self._renew(np.array([row]))
        return row

    def next_row(self, world: int) -> int:
        """Return the row of the robot of a world that joins next, or the last row if no more can."""
        return world * self._floor.robots + min(int(self.joined[world]), self._floor.robots - 1)

    def remove(self, rows: Ints) -> None:
        """Take away the robots in `rows` (K,), which are at work; their cargo lies where they were."""
        self._lose(rows)
        for row in rows.tolist():
            self._floor.physics.remove(row)
        self._minds.poses.silence(rows)
        self._stop_working(rows)

    def fail(self, rows: Ints) -> None:
        """Make the robots in `rows` (K,), which are at work, fail permanently; bodies and cargo stay where they are."""
        self._lose(rows)
        if self._mission.robots.failed_pose == "unseen":
            self._minds.poses.silence(rows)
        self._stop_working(rows)

    def is_free(self, row: int, point: Floats) -> bool:
        """Return whether there is room for the robot of `row` at `point` (2,) [m].

        Robots that pass through others need only one among the walls.
        """
        floor = self._floor
        if not self._mission.is_free(point % floor.extent):
            return False
        if self._mission.world.contacts != "solid":
            return True
        rows = floor.rows_of(row // floor.robots)
        bodies = rows[floor.physics.present[rows] & (rows != row)]
        places = floor.physics.positions[bodies]
        return has_room(point % floor.extent, self._radii[row], places, self._radii[bodies], floor.extent)

    def free_place(self, world: int, rng: np.random.Generator) -> Place | None:
        """Return a random place (x [m], y [m], heading [rad]) free for the next robot, or None if none was found."""
        row = self.next_row(world)
        heading = float(rng.uniform(-np.pi, np.pi))
        for _ in range(MOST_DRAWS):
            point = rng.uniform(size=2) * self._floor.ground.land
            if self.is_free(row, point):
                return float(point[0]), float(point[1]), heading
        return None

    def _lose(self, rows: Ints) -> None:
        for row in rows.tolist():
            if not 0 <= row < len(self.working) or not self.working[row]:
                raise ValueError(unknown("robot at work", str(row), [str(r) for r in np.flatnonzero(self.working)]))
        self.task.lose(rows)

    def _stop_working(self, rows: Ints) -> None:
        self.working[rows] = False
        self._renew(rows)

    def _renew(self, rows: Ints) -> None:
        """Stop the drives of `rows` (K,), make them as new, and clear their networks and knowledge.

        Rows that do not work receive no more pheromones: over days their contents would fill the memory.
        """
        self._floor.drive.reset(rows)
        self.task.renew(rows)
        self._minds.reset_rows(rows)
        self._minds.poses.deafen(rows, ~self.working[rows])


@lean_kernel
def list_working(now: float, rows: Ints, team: Handle[AtWork]) -> int:
    """List those of `rows` (K,) that work; a step, see `selforg.program`."""
    t = open_team(team)
    t.length[0] = 0
    for row in rows:
        if t.working[row]:
            t.able[t.length[0]] = row
            t.length[0] += 1
    return 0
