"""What steering mechanisms share: their blueprint, and the other robots as a robot knows them.

An other is a row of a table, float64 (M, OTHER_COLUMNS), by the poses that the robot received. Its velocity is that
between the last two of them; its place is the last one, carried on with that velocity for as long as the pose is old.
"""

from abc import abstractmethod
from typing import Any, Unpack

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import part
from selforg.compiler.records import Handle, Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.base import LookOptions, Mechanism
from selforg.space import nearest_image

OTHER_X, OTHER_Y = 0, 1  # offset from the robot [m]
OTHER_VX, OTHER_VY = 2, 3  # velocity [m/s], zero after a single pose
OTHER_COSINE, OTHER_SINE = 4, 5  # heading, both zero if there is none
OTHER_ROW = 6  # its row, NO_ROW of a wall
NO_ROW = -1
OTHER_COLUMNS = 7


class SteeringMechanism(Mechanism):
    """Blueprint of a mechanism that changes the commands of robots in the plane.

    It looks at the poses of the team: those whose gradients reach within `view_distance` [m] of the robot, as far as
    the robot received them; some also look at gradients of the buffer. Subclasses implement `steer`.

    Example:
        >>> mechanism = PredictiveSteering(poses, view_distance=1.0)
        >>> mechanism.steer(0.2, np.array([0, 3]), commands.packed.handle)

    """

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[LookOptions]) -> None:
        super().__init__(buffer, **options)
        if self.poses.space.dim != 2:
            raise ValueError(f"{type(self).__name__}: expected a space of 2 dimensions, got {self.poses.space.dim}")

    @abstractmethod
    def steer(self, now: float, rows: Ints, commands: Handle[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]; rows without a command stay without one."""

    def steering(self, commands: Packed[Commanded]) -> tuple[Any, ...]:
        """Return the kernel of a step that does as `steer` does, and its records; nothing if there is none."""
        return ()

    def reset(self, rows: Ints) -> None:
        """Forget what `rows` (K,) did; most mechanisms remember nothing."""


@part
def speed_to_change(row: int, commands: Handle[Commanded], poses: Handle[Poses]) -> float:
    """Return the speed [m/s] that is commanded to a row; 0 where none moves it, or it has no pose of its own."""
    m = open_commanded(commands)
    x, y = m.vectors[row, 0], m.vectors[row, 1]
    moves = m.commanded[row] and not m.in_place[row] and open_poses(poses).rows[row, c.ROW_POSES] > 0
    return float(np.sqrt(x * x + y * y)) if moves else 0.0


@part
def note_others(row: int, now: float, view: float, others: Floats, poses: Handle[Poses]) -> int:
    """Write the other robots of the team whose gradients reach within `view` [m] of a row; return how many there are.

    What never reached the row, or is forgotten, is not known to it.
    """
    p = open_poses(poses)
    team = p.teams[row]
    begin, members = p.first[team], p.first[team + 1] - p.first[team]
    hearing, room = p.rows.shape[1] > c.ROW_HEARD, (p.rows.shape[1] - c.ROW_HEARD) // 2
    x, y, count = p.own[row, 0, c.X], p.own[row, 0, c.Y], 0
    for index in range(members):
        other = p.members[begin + index]
        last = p.rows[row, c.ROW_HEARD + index] if hearing else 0
        before = p.rows[row, c.ROW_HEARD + room + index] if hearing else 1
        known = p.rows[other, c.ROW_POSES]
        if other == row or last < 0 or last >= known:
            continue
        dx = nearest_image(p.own[other, last, c.X] - x, p.extent[0])
        dy = nearest_image(p.own[other, last, c.Y] - y, p.extent[1])
        reach = view + p.own[other, last, c.DIFFUSION] + p.own[other, last, c.GOAL_RADIUS]
        if dx * dx + dy * dy > reach * reach:
            continue
        vx, vy = 0.0, 0.0
        if 0 <= before < known:
            elapsed = p.own[other, last, c.POSE_STAMP] - p.own[other, before, c.POSE_STAMP]
            vx = nearest_image(p.own[other, last, c.X] - p.own[other, before, c.X], p.extent[0]) / elapsed
            vy = nearest_image(p.own[other, last, c.Y] - p.own[other, before, c.Y], p.extent[1]) / elapsed
        age = now - p.own[other, last, c.POSE_STAMP]
        others[count, OTHER_X], others[count, OTHER_Y] = dx + vx * age, dy + vy * age
        others[count, OTHER_VX], others[count, OTHER_VY] = vx, vy
        others[count, OTHER_COSINE] = p.own[other, last, c.POSE_HEADING]
        others[count, OTHER_SINE] = p.own[other, last, c.POSE_HEADING + 1]
        others[count, OTHER_ROW] = other
        count += 1
    return count


@part
def note_near_walls(row: int, count: int, beyond: float, others: Floats, poses: Handle[Poses]) -> int:
    """Write the walls near a row after `count` others, as robots `beyond` [m] behind them; return the sum."""
    p = open_poses(poses)
    for k in range(p.wall_counts[row]):
        x, y = p.wall_ways[row, k, 0], p.wall_ways[row, k, 1]
        distance = np.sqrt(x * x + y * y)
        if distance == 0.0:
            continue
        scale = (distance + beyond) / distance
        others[count, :] = 0.0
        others[count, OTHER_X], others[count, OTHER_Y], others[count, OTHER_ROW] = scale * x, scale * y, NO_ROW
        count += 1
    return count


@part
def own_velocity(row: int, poses: Handle[Poses]) -> tuple[float, float]:
    """Return the velocity of a row between its last two poses [m/s], zero after a single one."""
    p = open_poses(poses)
    if p.rows[row, c.ROW_POSES] < 2:
        return 0.0, 0.0
    elapsed = p.own[row, 0, c.POSE_STAMP] - p.own[row, 1, c.POSE_STAMP]
    x = nearest_image(p.own[row, 0, c.X] - p.own[row, 1, c.X], p.extent[0]) / elapsed
    y = nearest_image(p.own[row, 0, c.Y] - p.own[row, 1, c.Y], p.extent[1]) / elapsed
    return x, y
