"""Own poses: every row's moving pose gradient, its own history, and who shares it with whom."""

from collections.abc import Iterable, Sequence
from typing import Annotated, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel, long_kernel
from selforg.compiler.records import Handle, Packed, Written
from selforg.elementary import sine_cosine
from selforg.gradients.gradient import Gradient
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import index_poses, make_pose_cells
from selforg.gradients.store.records import Poses, open_poses
from selforg.parameters import at_least, check_choice
from selforg.program import BEGINNING, Rows, Step
from selforg.space import Space, wrapped
from selforg.walls.segments import Walls, cell_of_walls, no_walls, open_walls, to_segment
from selforg.walls.ways import Aims, Ways

MOST_WALLS: Final = 8
"""Points of walls that a row knows, the nearest ones."""
WALL_VIEW: Final = 2.0
"""Distance up to which it knows them [m]."""
SAME_POINT: Final = 0.01
"""Distance up to which the nearest points of two segments are one, as where these meet [m]."""

RowNumbers: TypeAlias = npt.NDArray[np.integer] | Iterable[int]


class OwnPoses:
    """The pose gradients that rows carry, stored apart from all other gradients and shared by all buffers of a robot.

    Rows of one team see each other (ideal delivery); rows of different teams never do. A pose is repulsive by default:
    the paper's robots spread `goal_radius` 0.5 m, `diffusion` 1.0 m. With `hearing` a row sees what
    `PoseDelivery` has brought it, up to `history` poses old. Rows know the `walls` near their newest pose.

    Example:
        >>> poses = OwnPoses(Euclidean(2), rows=2, teams=np.array([0, 0]))
        >>> poses.update(np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros(2), now=0.0)

    Attributes:
        own: (N, K, POSE_COLUMNS) float64, poses of each row, the newest first.
        row_table: (N, ROW_COLUMNS or more) int64.
        teams: (N,) int64, team of each row; read only.
        radii: (N, 2) float64, diffusion and goal radius [m] of the poses that each row spreads; a host may change them.
        packed: all of them and more as compiled code takes them.

    """

    radii: Annotated[Floats, "N 2", KEPT]
    _no_headings: Annotated[Floats, "N", READ]  # zero [rad]

    space: Annotated[Space, READ]

    def __init__(
        self,
        space: Space,
        rows: int,
        teams: npt.ArrayLike | None = None,
        *,
        diffusion: float | Floats = 1.0,
        goal_radius: float | Floats = 0.5,
        attraction: int = -1,
        channel: str = "robot",
        history: int = 2,
        names: Sequence[str] | None = None,
        hearing: bool = False,
        walls: Packed[Walls] | None = None,
    ) -> None:
        at_least(self, "rows", rows, 1)
        radii = np.stack(np.broadcast_arrays(*np.atleast_1d(diffusion, goal_radius)), axis=-1)
        if not ((radii >= 0).all() and np.isfinite(radii[..., 1]).all()):
            raise ValueError(
                f"OwnPoses: diffusion and goal_radius must be at least 0 [m], got {diffusion!r}, {goal_radius!r}"
            )
        check_choice("OwnPoses: attraction", attraction, (-1, 0, 1))
        at_least(self, "history", history, 0)
        if names is not None and (len(names) != rows or len(set(names)) != rows):
            raise ValueError(f"OwnPoses: names must be {rows} different names, got {names!r}")
        self.space = space
        self.rows = rows
        self.channel = channel
        self.history = history
        self.names = tuple(names) if names is not None else ()  # by which single messages know the rows
        self.own: Floats = np.zeros((rows, max(history, 1), c.POSE_COLUMNS))  # newest first
        codes = np.zeros(rows, dtype=np.int64) if teams is None else np.asarray(teams, dtype=np.int64)
        if codes.shape != (rows,) or (codes < 0).any():
            raise ValueError(f"OwnPoses: teams must be ({rows},) numbers from 0 up, got shape {codes.shape}")
        self.team_count = int(codes.max()) + 1
        sizes = np.bincount(codes)
        heard = int(sizes.max()) if hearing else 0
        self.row_table: Ints = np.zeros((rows, c.ROW_COLUMNS + 2 * heard), dtype=np.int64)
        self.row_table[:, c.ROW_COLUMNS :] = -1
        self.teams = codes.copy()
        self._no_headings = np.zeros(rows)
        self._walls = walls
        wall = (walls or no_walls()).record
        self.radii = np.array(np.broadcast_to(radii, (rows, 2)), dtype=np.float64, order="C")
        self.packed = Packed(
            Poses(
                own=self.own,
                rows=self.row_table,
                teams=self.teams,
                first=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
                members=np.argsort(codes, kind="stable").astype(np.int64),
                reach=np.zeros(self.team_count),
                extent=space.padded_extent,
                cells=make_pose_cells(space, float(radii.sum(axis=-1).max()), sizes),
                buckets=np.full(1 << int(2 * rows - 1).bit_length(), -1, dtype=np.int32),
                links=np.full((rows, 2), -1, dtype=np.int32),
                radii=self.radii,
                wall_ways=np.zeros((rows, 0 if walls is None else MOST_WALLS, 2)),
                wall_counts=np.zeros(rows, dtype=np.int64),
                segments=wall.segments,
                cell_lists=wall.first,
                listed=wall.listed,
                clear=wall.clear,
                wall_grid=np.array([wall.left, wall.bottom, wall.pitch, wall.near, wall.columns, wall.lines]),
                room=np.zeros((0, 0), np.uint8),
                pitch=np.ones(2),
                corner=np.zeros(2),
                aims=np.zeros((self.team_count, 0), np.int64),
                aim_squares=np.zeros((0, 2), np.int64),
                fields=np.zeros((0, 0, 0), np.int32),
                attraction=attraction,
                history=history,
            )
        )

    def update(self, positions: Floats, headings: Floats | None, now: float) -> None:
        """Spread the pose of every row: positions (N, D) [m], headings (N,) [rad] in the plane or None, time [s]."""
        positions = np.ascontiguousarray(positions, dtype=np.float64)
        known = headings is not None
        headings = self._no_headings if headings is None else np.ascontiguousarray(headings, dtype=np.float64)
        if positions.shape != (self.rows, self.space.dim) or headings.shape != (self.rows,):
            raise ValueError(
                f"OwnPoses.update: positions must be ({self.rows}, {self.space.dim}) and headings ({self.rows},), "
                f"got {positions.shape} and {headings.shape}"
            )
        bad = update_poses(positions, headings, known, float(now), self.packed.handle)
        if bad >= 0:
            raise ValueError(f"OwnPoses.update: position and heading of row {bad} must be finite, got {positions[bad]}")
        if self._walls is not None:
            note_walls(now, self.teams, self.packed.handle, self._walls.handle)

    def noting_walls(self, rows: Rows) -> list[Step]:
        """Return the steps of a program that note the walls near all rows."""
        if self._walls is None:
            return []
        return [Step(BEGINNING, note_walls, rows, note_walls, (self.packed, self._walls))]

    def set_gradient(self, row: int, gradient: Gradient) -> bool:
        """Spread a checked gradient as the pose of one row; False if it is not newer than the last one."""
        if self.row_table[row, c.ROW_POSES] > 0 and gradient.stamp <= self.own[row, 0, c.POSE_STAMP]:
            return False
        place = self.space.wrap(np.asarray(gradient.position, dtype=np.float64))
        self.own[row, 1:] = self.own[row, :-1].copy()
        newest = self.own[row, 0]
        newest[:] = 0.0
        newest[c.X : c.X + len(place)] = place
        newest[c.POSE_HEADING : c.POSE_HEADING + len(gradient.heading)] = gradient.heading
        newest[[c.DIFFUSION, c.GOAL_RADIUS]] = gradient.diffusion, gradient.goal_radius
        newest[[c.POSE_SIGN, c.POSE_STAMP]] = gradient.attraction, gradient.stamp
        self.row_table[row, c.ROW_POSES] = min(self.row_table[row, c.ROW_POSES] + 1, self.history)
        index_poses(self.packed.handle)
        return True

    def gradient(self, row: int, age: int = 0) -> Gradient:
        """Return the pose gradient of `row`, the newest (age 0) or an older one."""
        fields, dim = self.own[row, age], self.space.dim
        return Gradient(
            channel=self.channel,
            position=tuple(fields[c.X : c.X + dim].tolist()),
            source=self.names[row] if self.names else row,
            heading=tuple(fields[c.POSE_HEADING : c.POSE_HEADING + dim].tolist()),
            attraction=int(fields[c.POSE_SIGN]),
            diffusion=float(fields[c.DIFFUSION]),
            goal_radius=float(fields[c.GOAL_RADIUS]),
            stamp=float(fields[c.POSE_STAMP]),
            moving=True,
        )

    def go_round(self, ways: Ways, aims: Aims) -> None:
        """Let static gradients that attract lead round walls, where they are `aims`, one row for each team."""
        self.packed.replace(
            self.packed.record._replace(
                room=ways.room,
                pitch=ways.pitch,
                corner=ways.corner,
                aims=aims.numbers,
                aim_squares=aims.squares,
                fields=aims.fields,
            )
        )

    def forget(self, rows: npt.ArrayLike) -> None:
        """Forget all poses of `rows` (R,), as before their first update."""
        self.row_table[np.asarray(rows, dtype=np.int64), c.ROW_POSES] = 0

    def silence(self, rows: npt.ArrayLike, silent: bool = True) -> None:
        """Forget all poses of `rows` (R,) and leave them out of `update`; with `silent` False, include them again."""
        self.forget(rows)
        self.row_table[np.asarray(rows, dtype=np.int64), c.ROW_SILENT] = int(silent)

    def deafen(self, rows: Ints, deaf: Flags) -> None:
        """Say which of `rows` (R,) are `deaf` (R,): they store nothing that others spread."""
        self.row_table[rows, c.ROW_DEAF] = deaf

    def members(self, team: int) -> Ints:
        """Return the rows of a team, in their order."""
        first = self.packed.record.first
        return self.packed.record.members[first[team] : first[team + 1]]

    def chosen(self, rows: RowNumbers | None) -> Ints:
        """Return `rows` (R,), or all where None is given."""
        return np.arange(self.rows) if rows is None else np.ascontiguousarray(rows, dtype=np.int64)

    @property
    def positions(self) -> Floats:
        """Newest position of each row, (N, D) [m]; only meaningful where `known`."""
        return self.own[:, 0, c.X : c.X + self.space.dim]

    @property
    def known(self) -> Flags:
        """Whether each row has spread a pose yet, (N,) bool."""
        return self.row_table[:, c.ROW_POSES] > 0


@long_kernel
def update_poses(positions: Floats, headings: Floats, with_headings: bool, now: float, poses: Written[Poses]) -> int:
    """Push one pose per row onto its history: positions (N, D) [m], headings (N,) [rad], time [s].

    A row whose last pose is not older than `now` keeps that pose; a silent row spreads none. Returns -1. If a number is
    not finite, nothing is changed, and the result is the first such row.
    """
    p = open_poses(poses)
    dim = positions.shape[1]
    for row in range(len(p.rows)):
        finite = np.isfinite(headings[row])
        for axis in range(dim):
            finite = finite and np.isfinite(positions[row, axis])
        if not finite:
            return row
    for row in range(len(p.rows)):
        known = p.rows[row, c.ROW_POSES]
        if p.rows[row, c.ROW_SILENT] or (known > 0 and now <= p.own[row, 0, c.POSE_STAMP]):
            continue
        for age in range(p.own.shape[1] - 1, 0, -1):
            for column in range(c.POSE_COLUMNS):
                p.own[row, age, column] = p.own[row, age - 1, column]
        newest = p.own[row, 0]
        newest[:] = 0.0
        for axis in range(dim):
            newest[c.X + axis] = wrapped(positions[row, axis], p.extent[axis])
        if with_headings:
            sine, cosine = sine_cosine(headings[row])
            newest[c.POSE_HEADING], newest[c.POSE_HEADING + 1] = cosine, sine
        newest[c.DIFFUSION], newest[c.GOAL_RADIUS] = p.radii[row, 0], p.radii[row, 1]
        newest[c.POSE_SIGN] = p.attraction
        newest[c.POSE_STAMP] = now
        p.rows[row, c.ROW_POSES] = min(known + 1, p.history)
    index_poses(poses)
    return -1


@lean_kernel
def note_walls(now: float, rows: Ints, poses: Handle[Poses], walls: Handle[Walls]) -> int:
    """Write the ways to the nearest points of the walls near each row, at most MOST_WALLS; farther ones make room.

    All rows are noted. This is a step, see `selforg.program`.
    """
    p, w = open_poses(poses), open_walls(walls)
    for row in range(len(p.rows)):
        count, x, y = 0, p.own[row, 0, c.X], p.own[row, 0, c.Y]
        cell = cell_of_walls(x, y, w)
        for k in range(w.first[cell], w.first[cell + 1]) if cell >= 0 else range(0):
            dx, dy = to_segment(x, y, w.listed[k], w)
            place, farthest = count, dx * dx + dy * dy
            if farthest > WALL_VIEW * WALL_VIEW:
                continue
            for other in range(count):
                ox, oy = p.wall_ways[row, other, 0], p.wall_ways[row, other, 1]
                if (ox - dx) * (ox - dx) + (oy - dy) * (oy - dy) < SAME_POINT * SAME_POINT:
                    place = MOST_WALLS
                    break
                if count == MOST_WALLS and ox * ox + oy * oy > farthest:
                    place, farthest = other, ox * ox + oy * oy
            if place < MOST_WALLS:
                p.wall_ways[row, place, 0], p.wall_ways[row, place, 1] = dx, dy
                count = max(count, place + 1)
        p.wall_counts[row] = count
    return 0
