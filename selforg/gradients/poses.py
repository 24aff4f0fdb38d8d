"""Own poses: every row's moving pose gradient, its own history, and who shares it with whom."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.gradient import Gradient
from selforg.gradients.store.columns import (
    CELLS,
    DIFFUSION,
    GOAL,
    GRID_COLUMNS,
    PHX,
    PHY,
    POSE_COLUMNS,
    POSE_SIGN,
    POSE_STAMP,
    POSES,
    ROW_COLUMNS,
    SILENT,
    TEAM,
    X,
)
from selforg.gradients.store.pose_cells import POSE_TABLES, Poses, index_poses, poses_of
from selforg.space import Space, wrapped


class OwnPoses:
    """The pose gradients that rows carry, kept apart from all other gradients and shared by all buffers of a robot.

    Rows of one team see each other (ideal delivery); rows of different teams never do. A pose is repulsive by default:
    the paper's robots spread `goal_radius` 0.5 m, `diffusion` 1.0 m. With `hearing` a row sees what it has received as
    `selforg.gradients.pose_delivery` says, up to `history` poses old.

    Example:
        >>> poses = OwnPoses(Euclidean(2), rows=2, teams=np.array([0, 0]))
        >>> poses.update(np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros(2), now=0.0)

    """

    def __init__(
        self,
        space: Space,
        rows: int,
        teams: npt.ArrayLike | None = None,
        *,
        diffusion: float = 1.0,
        goal_radius: float = 0.5,
        attraction: int = -1,
        channel: str = "robot",
        history: int = 2,
        names: Sequence[str] | None = None,
        hearing: bool = False,
    ) -> None:
        if rows < 1:
            raise ValueError(f"OwnPoses: rows must be at least 1, got {rows!r}")
        if not (diffusion >= 0 and goal_radius >= 0 and np.isfinite(goal_radius)):
            raise ValueError(
                f"OwnPoses: diffusion and goal_radius must be at least 0 [m], got {diffusion!r}, {goal_radius!r}"
            )
        if attraction not in (-1, 0, 1):
            raise ValueError(f"OwnPoses: attraction must be -1, 0 or 1, got {attraction!r}")
        if history < 0:
            raise ValueError(f"OwnPoses: history must be at least 0, got {history!r}")
        if names is not None and (len(names) != rows or len(set(names)) != rows):
            raise ValueError(f"OwnPoses: names must be {rows} different names, got {names!r}")
        self.space = space
        self.rows = rows
        self.channel = channel
        self._look = np.array([diffusion, goal_radius, float(attraction)])
        self.history = history
        self.names = tuple(names) if names is not None else ()  # by which single messages know the rows
        self.own: Floats = np.zeros((rows, max(history, 1), POSE_COLUMNS))  # newest first
        codes = np.zeros(rows, dtype=np.int64) if teams is None else np.asarray(teams, dtype=np.int64)
        members = int(np.bincount(codes).max()) if hearing else 0
        self.row_table: Ints = np.zeros((rows, ROW_COLUMNS + members), dtype=np.int64)
        self.row_table[:, ROW_COLUMNS:] = -1
        self._set_teams(codes)
        self.tables: Poses = self._tables()
        self.bundle: Bundle = POSE_TABLES.bundle(*self.tables)

    def update(self, positions: Floats, headings: Floats | None, now: float) -> None:
        """Let every row spread its pose: positions (N, D) [m], headings (N,) [rad] in the plane or None, time [s]."""
        positions = np.ascontiguousarray(positions, dtype=np.float64)
        known = headings is not None
        headings = self._no_headings if headings is None else np.ascontiguousarray(headings, dtype=np.float64)
        if positions.shape != (self.rows, self.space.dim) or headings.shape != (self.rows,):
            raise ValueError(
                f"OwnPoses.update: positions must be ({self.rows}, {self.space.dim}) and headings ({self.rows},), "
                f"got {positions.shape} and {headings.shape}"
            )
        bad = update_poses(positions, headings, known, float(now), self._look, self.history, self.bundle)
        if bad >= 0:
            raise ValueError(f"OwnPoses.update: position and heading of row {bad} must be finite, got {positions[bad]}")

    def set_pose(
        self,
        row: int,
        position: Sequence[float],
        heading: Sequence[float],
        now: float,
        *,
        diffusion: float | None = None,
        goal_radius: float | None = None,
        attraction: int | None = None,
    ) -> bool:
        """Let one row spread one pose with fields of its own; False if it is not newer than the last one.

        position: (D,) [m]; heading: (D,) direction, zero if there is none; now [s].
        """
        if self.row_table[row, POSES] > 0 and now <= self.own[row, 0, POSE_STAMP]:
            return False
        place = self.space.wrap(np.asarray(position, dtype=np.float64))
        self.own[row, 1:] = self.own[row, :-1].copy()
        newest = self.own[row, 0]
        newest[:] = 0.0
        newest[X : X + len(place)] = place
        newest[PHX : PHX + len(heading)] = heading
        newest[DIFFUSION] = self._look[0] if diffusion is None else diffusion
        newest[GOAL] = self._look[1] if goal_radius is None else goal_radius
        newest[POSE_SIGN] = self._look[2] if attraction is None else attraction
        newest[POSE_STAMP] = now
        self.row_table[row, POSES] = min(self.row_table[row, POSES] + 1, self.history)
        index_poses(self.bundle)
        return True

    def gradient(self, row: int, age: int = 0) -> Gradient:
        """Return the pose gradient of `row`, the newest (age 0) or an older one."""
        fields, dim = self.own[row, age], self.space.dim
        return Gradient(
            channel=self.channel,
            position=tuple(fields[X : X + dim].tolist()),
            source=self.names[row] if self.names else row,
            heading=tuple(fields[PHX : PHX + dim].tolist()),
            attraction=int(fields[POSE_SIGN]),
            diffusion=float(fields[DIFFUSION]),
            goal_radius=float(fields[GOAL]),
            stamp=float(fields[POSE_STAMP]),
            moving=True,
        )

    def forget(self, rows: npt.ArrayLike) -> None:
        """Forget all poses of `rows` (R,), as before their first update."""
        self.row_table[np.asarray(rows, dtype=np.int64), POSES] = 0

    def silence(self, rows: npt.ArrayLike, silent: bool = True) -> None:
        """Forget all poses of `rows` (R,), which spread no more by `update`; or let them spread again."""
        self.forget(rows)
        self.row_table[np.asarray(rows, dtype=np.int64), SILENT] = int(silent)

    @property
    def teams(self) -> Ints:
        """Team of each row, (N,) int64, read only."""
        teams: Ints = self.row_table[:, TEAM]
        return teams

    def members(self, team: int) -> Ints:
        """Return the rows of a team, in their order."""
        return self._members[self._first[team] : self._first[team + 1]]

    @property
    def positions(self) -> Floats:
        """Newest position of each row, (N, D) [m]; only meaningful where `known`."""
        positions: Floats = self.own[:, 0, X : X + self.space.dim]
        return positions

    @property
    def known(self) -> npt.NDArray[np.bool_]:
        """Whether each row has spread a pose yet, (N,) bool."""
        known: npt.NDArray[np.bool_] = self.row_table[:, POSES] > 0
        return known

    def _set_teams(self, teams: Ints) -> None:
        if teams.shape != (self.rows,) or (teams < 0).any():
            raise ValueError(f"OwnPoses: teams must be ({self.rows},) numbers from 0 up, got shape {teams.shape}")
        self.row_table[:, TEAM] = teams
        self.team_count = int(teams.max()) + 1
        self._members = np.argsort(teams, kind="stable").astype(np.int64)
        self._first = np.searchsorted(teams[self._members], np.arange(self.team_count + 1)).astype(np.int64)
        self._no_headings = np.zeros(self.rows)

    def _tables(self) -> Poses:
        """Pack what compiled code needs; see `selforg.gradients.store.pose_cells.Poses`."""
        reach = np.zeros(self.team_count)
        width = max(float(self._look[:2].sum()), 0.1) if np.isfinite(self._look[:2].sum()) else 1.0
        # not much narrower than leaves one robot to a cell: looking into empty ones costs more than a neighbour too far
        width = max(width, float(np.prod(self.space.extent) / np.diff(self._first).max()) ** (1.0 / self.space.dim))
        grid = np.zeros((1, GRID_COLUMNS))
        for axis, side in enumerate(self.space.padded_extent):
            number = max(1.0, np.floor(side / width)) if side > 0 else 1024.0
            grid[0, CELLS + 2 * axis] = number
            grid[0, CELLS + 2 * axis + 1] = side / number if side > 0 else width
        size = 1 << int(2 * self.rows - 1).bit_length()
        buckets = np.full(size, -1, dtype=np.int32)
        links = np.full((self.rows, 2), -1, dtype=np.int32)
        whole = self.space.padded_extent
        return self.own, self.row_table, self._first, self._members, reach, whole, grid, buckets, links


@lean_kernel
def update_poses(
    positions: Floats, headings: Floats, with_headings: bool, now: float, look: Floats, history: int, poses: Bundle
) -> int:
    """Push one pose per row onto its history: positions (N, D) [m], headings (N,) [rad], time [s].

    look: (3,) diffusion [m], goal radius [m], attraction. A row whose last pose is not older than `now` keeps it; one
    that is silent spreads none. Returns -1, or the first row with a number that is not finite: nothing is changed then.
    """
    own, rows, _, _, _, extent, _, _, _ = poses_of(poses)
    dim = positions.shape[1]
    for row in range(len(rows)):
        finite = np.isfinite(headings[row])
        for axis in range(dim):
            finite = finite and np.isfinite(positions[row, axis])
        if not finite:
            return row
    for row in range(len(rows)):
        if rows[row, SILENT] or (rows[row, POSES] > 0 and now <= own[row, 0, POSE_STAMP]):
            continue
        for age in range(own.shape[1] - 1, 0, -1):
            for column in range(POSE_COLUMNS):
                own[row, age, column] = own[row, age - 1, column]
        newest = own[row, 0]
        newest[:] = 0.0
        for axis in range(dim):
            newest[X + axis] = wrapped(positions[row, axis], extent[axis])
        if with_headings:
            newest[PHX] = np.cos(headings[row])
            newest[PHY] = np.sin(headings[row])
        newest[DIFFUSION], newest[GOAL], newest[POSE_SIGN] = look[0], look[1], look[2]
        newest[POSE_STAMP] = now
        rows[row, POSES] = min(rows[row, POSES] + 1, history)
    index_poses(poses)
    return -1
