"""Optimal reciprocal collision avoidance: half-planes of velocities, and the linear programs over them.

Van den Berg, Guy, Lin & Manocha (2011), doi:10.1007/978-3-642-19457-3_1; equation and section numbers are theirs. A
half-plane is a row of a table, float64 (M, LINE_COLUMNS): a point on its border, and the unit normal into it.
"""

from typing import Annotated, Any, NamedTuple, Unpack

import numpy as np

from selforg.arrays import SCRATCH, Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import kernel, lean_kernel, part
from selforg.compiler.records import Handle, Packed, opening
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import MOST_WALLS, OwnPoses
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.causes import Causes, note_cause
from selforg.mechanisms.steering.base import (
    OTHER_COLUMNS,
    OTHER_ROW,
    OTHER_VX,
    OTHER_VY,
    OTHER_X,
    OTHER_Y,
    SteeringMechanism,
    note_others,
    own_velocity,
    speed_to_change,
)
from selforg.parameters import at_least

POINT_X, POINT_Y, NORMAL_X, NORMAL_Y = 0, 1, 2, 3
LINE_COLUMNS = 4
WALL_HORIZON = 0.5
"""Time for which a robot does not come too near to a wall [s]; for longer ones it would slow down before doors."""
NEARLY = 1e-9
"""Sine of the angle up to which two borders count as parallel; likewise the slack of a constraint [m/s]."""


class HalfPlanes(NamedTuple):
    """The parameters of `ORCA`, and room for the others and the half-planes of one row."""

    others: Annotated[Floats, "R OTHER", SCRATCH]  # columns OTHER_
    lines: Annotated[Floats, "N+S LINE", SCRATCH]  # columns POINT_ and NORMAL_; S walls
    projected: Annotated[Floats, "N+S LINE", SCRATCH]  # the half-planes of the three-dimensional program
    found: Annotated[Floats, "2", SCRATCH]  # the velocity found [m/s]
    view_distance: float  # from here on: see `ORCA`
    distance: float
    horizon: float
    period: float


open_half_planes = opening(HalfPlanes)


@MECHANISMS.register
class ORCA(SteeringMechanism):
    """Optimal reciprocal collision avoidance of van den Berg, Guy, Lin & Manocha (2011).

    doi:10.1007/978-3-642-19457-3_1. Each other robot permits a half-plane of velocities, which avoids a collision for
    `horizon` if both take half of the change. The permitted velocity nearest to the commanded one is taken, by a linear
    program; if there is none, the one that violates the worst half-plane least. As in the paper, robots are taken to
    follow any velocity at once. The commanded speed is the largest.

    Args:
        buffer: of the robots, or their poses.
        distance: sum of the radii of two robots [m].
        horizon: time for which no collision is permitted [s].
        period: time within which robots that overlap have to part [s].
        **options: see `SteeringMechanism`.

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        distance: float = 0.65,
        horizon: float = 2.0,
        period: float = 0.2,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        self._planes = Packed(
            HalfPlanes(
                others=np.zeros((rows, OTHER_COLUMNS)),
                lines=np.zeros((rows + MOST_WALLS, LINE_COLUMNS)),
                projected=np.zeros((rows + MOST_WALLS, LINE_COLUMNS)),
                found=np.zeros(2),
                view_distance=self.view_distance,
                distance=at_least(self, "distance", distance, 0.0),
                horizon=at_least(self, "horizon", horizon, 1e-6),
                period=at_least(self, "period", period, 1e-6),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Handle[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        avoid_rows(now, rows, commands, self._planes.handle, self.poses.packed.handle)

    def steering(self, commands: Packed[Commanded]) -> tuple[Any, ...]:
        """Return the kernel of `steer` with its records."""
        return avoid_rows, commands, self._planes, self.poses.packed

    def weigh(self, now: float, rows: Ints, wishes: Floats, causes: Causes) -> None:
        """Note the others by how far the wish lies outside of what they permit [m/s]."""
        weigh_planes(now, rows, wishes, causes.who, causes.weights, self._planes.handle, self.poses.packed.handle)


@lean_kernel
def weigh_planes(
    now: float,
    rows: Ints,
    wishes: Floats,
    who: Ints,
    weights: Floats,
    planes: Handle[HalfPlanes],
    poses: Handle[Poses],
) -> None:
    """Note the others of `rows` (K,) in the arrays of `Causes`, for `wishes` (N, 2) [m/s] at `now` [s]."""
    h = open_half_planes(planes)
    for row in rows:
        vx, vy = own_velocity(row, poses)
        h.found[0], h.found[1] = wishes[row, 0], wishes[row, 1]
        for other in range(note_others(row, now, h.view_distance, h.others, poses)):
            permit(row, other, vx, vy, planes)
            note_cause(row, int(h.others[other, OTHER_ROW]), violation(other, h.lines, h.found), who, weights)


@lean_kernel
def avoid_rows(
    now: float, rows: Ints, commands: Handle[Commanded], planes: Handle[HalfPlanes], poses: Handle[Poses]
) -> int:
    """Change the commands of `rows` (K,) at `now` [s]; rows without a command that moves them keep it. A step."""
    m, h, p = open_commanded(commands), open_half_planes(planes), open_poses(poses)
    for row in rows:
        speed = speed_to_change(row, commands, poses)
        if speed == 0.0:
            continue
        count = note_others(row, now, h.view_distance, h.others, poses)
        vx, vy = own_velocity(row, poses)
        for other in range(count):
            permit(row, other, vx, vy, planes)
        for k in range(p.wall_counts[row]):
            permit_wall(count + k, p.wall_ways[row, k, 0], p.wall_ways[row, k, 1], planes)
        count += p.wall_counts[row]
        if count > 0:
            choose_velocity(count, m.vectors[row, 0], m.vectors[row, 1], speed, planes)
            m.vectors[row, 0], m.vectors[row, 1] = h.found[0], h.found[1]
    return 0


@part
def permit(row: int, other: int, vx: float, vy: float, planes: Handle[HalfPlanes]) -> None:
    """Write the half-plane ORCA of a robot of velocity (vx, vy) [m/s] for an other: eq. (2) to (5).

    u is the smallest change of the relative velocity that leaves the velocity obstacle, a cone whose tip is cut off by
    a circle; each of both robots makes half of it. Robots that overlap must have parted within one period; of two at
    one place the one of the lower row goes to the left.
    """
    h = open_half_planes(planes)
    px, py = h.others[other, OTHER_X], h.others[other, OTHER_Y]
    rx, ry = vx - h.others[other, OTHER_VX], vy - h.others[other, OTHER_VY]
    squared, radius = px * px + py * py, h.distance
    apart = squared > radius * radius
    time = h.horizon if apart else h.period
    wx, wy = rx - px / time, ry - py / time  # from the centre of the circle that cuts off the tip
    length, along = np.sqrt(wx * wx + wy * wy), wx * px + wy * py
    if not apart or (along < 0.0 and along * along > radius * radius * length * length):
        nx, ny = (
            (wx / length, wy / length) if length > 0.0 else (-1.0 if row < h.others[other, OTHER_ROW] else 1.0, 0.0)
        )
        ux, uy = (radius / time - length) * nx, (radius / time - length) * ny
    else:
        leg = np.sqrt(squared - radius * radius)
        side = 1.0 if px * wy - py * wx > 0.0 else -1.0  # the leg to the left of the cone, or to the right
        dx, dy = (leg * px - side * radius * py) / squared, (leg * py + side * radius * px) / squared
        nx, ny = -side * dy, side * dx
        outside = rx * nx + ry * ny
        ux, uy = -outside * nx, -outside * ny
    h.lines[other, POINT_X], h.lines[other, POINT_Y] = vx + 0.5 * ux, vy + 0.5 * uy
    h.lines[other, NORMAL_X], h.lines[other, NORMAL_Y] = nx, ny


@part
def permit_wall(line: int, x: float, y: float, planes: Handle[HalfPlanes]) -> None:
    """Write the half-plane for a wall whose nearest point is (x, y) [m] away: the robot avoids it alone.

    It comes no nearer than half of `distance` within WALL_HORIZON; one that is nearer must be away within a period.
    """
    h = open_half_planes(planes)
    length = np.sqrt(x * x + y * y)
    nx, ny = (-x / length, -y / length) if length > 0.0 else (1.0, 0.0)
    left = length - 0.5 * h.distance
    allowed = left / (WALL_HORIZON if left > 0.0 else h.period)
    h.lines[line, POINT_X], h.lines[line, POINT_Y] = -allowed * nx, -allowed * ny
    h.lines[line, NORMAL_X], h.lines[line, NORMAL_Y] = nx, ny


@part
def choose_velocity(count: int, x: float, y: float, speed: float, planes: Handle[HalfPlanes]) -> None:
    """Write the permitted velocity nearest to (x, y), at most `speed` [m/s] long (eq. 6).

    If none is permitted, the velocity that violates the worst half-plane least (section 5.3).
    """
    h = open_half_planes(planes)
    failed = nearest_permitted(count, x, y, speed, False, h.lines, h.found)
    if failed < count:
        least_violating(failed, count, speed, h.lines, h.projected, h.found)


@part
def violation(k: int, lines: Floats, found: Floats) -> float:
    """Return how far outside half-plane `k` the velocity `found` (2,) lies [m/s], negative inside."""
    x, y = lines[k, POINT_X] - found[0], lines[k, POINT_Y] - found[1]
    outside: float = x * lines[k, NORMAL_X] + y * lines[k, NORMAL_Y]
    return outside


@kernel
def nearest_permitted(count: int, x: float, y: float, speed: float, far: bool, lines: Floats, found: Floats) -> int:
    """Write into `found` (2,) the point nearest to (x, y) in `count` half-planes and the disc of radius `speed`.

    With `far`, the point farthest in the direction (x, y). The half-planes of `lines` (M, LINE_COLUMNS) are added one
    by one: where the point so far violates the next one, the new one lies on its border (de Berg et al., Computational
    Geometry, chapter 4). Returns `count`, or the first half-plane that leaves no point.
    """
    length = np.sqrt(x * x + y * y)
    scale = speed / length if length > 0.0 and (far or length > speed) else 1.0
    found[0], found[1] = scale * x, scale * y
    for k in range(count):
        if violation(k, lines, found) <= NEARLY:
            continue
        nx, ny = lines[k, NORMAL_X], lines[k, NORMAL_Y]
        dx, dy = ny, -nx  # along the border
        middle = lines[k, POINT_X] * dx + lines[k, POINT_Y] * dy
        offset = lines[k, POINT_X] * nx + lines[k, POINT_Y] * ny
        inside = speed * speed - offset * offset
        if inside < 0.0:
            return k
        first, last = -np.sqrt(inside) - middle, np.sqrt(inside) - middle
        for j in range(k):
            slope = dx * lines[j, NORMAL_X] + dy * lines[j, NORMAL_Y]
            room = (lines[k, POINT_X] - lines[j, POINT_X]) * lines[j, NORMAL_X]
            room += (lines[k, POINT_Y] - lines[j, POINT_Y]) * lines[j, NORMAL_Y]
            if abs(slope) <= NEARLY:
                if room < -NEARLY:
                    return k
            elif slope > 0.0:
                first = max(first, -room / slope)
            else:
                last = min(last, -room / slope)
        if first > last:
            return k
        wanted = (last if x * dx + y * dy > 0.0 else first) if far else x * dx + y * dy - middle
        at = min(max(wanted, first), last)
        found[0], found[1] = lines[k, POINT_X] + at * dx, lines[k, POINT_Y] + at * dy
    return count


@kernel
def least_violating(begin: int, count: int, speed: float, lines: Floats, projected: Floats, found: Floats) -> None:
    """Write into `found` (2,) the velocity in the disc of radius `speed` whose worst violation is least.

    The half-planes before `begin` are kept by `found`. Lifted by the violation, the others are half-spaces: where the
    next one is worse than all before, the optimum lies where it equals one of these, and moves along its normal.
    """
    worst = 0.0
    for k in range(begin, count):
        if violation(k, lines, found) <= worst + NEARLY:
            continue
        number = 0
        for j in range(k):
            nx, ny = lines[j, NORMAL_X] - lines[k, NORMAL_X], lines[j, NORMAL_Y] - lines[k, NORMAL_Y]
            length = np.sqrt(nx * nx + ny * ny)
            if length <= NEARLY:
                continue  # parallel, and less strict or never both
            nx, ny = nx / length, ny / length
            level = lines[j, POINT_X] * lines[j, NORMAL_X] + lines[j, POINT_Y] * lines[j, NORMAL_Y]
            level -= lines[k, POINT_X] * lines[k, NORMAL_X] + lines[k, POINT_Y] * lines[k, NORMAL_Y]
            projected[number, POINT_X], projected[number, POINT_Y] = level / length * nx, level / length * ny
            projected[number, NORMAL_X], projected[number, NORMAL_Y] = nx, ny
            number += 1
        before_x, before_y = found[0], found[1]
        if nearest_permitted(number, lines[k, NORMAL_X], lines[k, NORMAL_Y], speed, True, projected, found) < number:
            found[0], found[1] = before_x, before_y  # only by rounding
        worst = violation(k, lines, found)
