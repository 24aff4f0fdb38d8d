"""Own poses: every row's moving pose gradient, its own history, who shares it with whom, and who received it.

When messages have a range and get lost, no pose is copied: the table of rows has a column for each member of the team,
with the age, in the history of that member, of the last pose received from it, and one with the age of the pose
received before that. A row that looks at poses begins with the first of them.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import kernel, lean_kernel
from selforg.compiler.records import Words
from selforg.elementary import sine_cosine
from selforg.gradients.gradient import Gradient
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import index_poses, make_pose_cells
from selforg.gradients.store.records import POSES, Poses, open_poses
from selforg.space import Space, squared_length, wrapped


class OwnPoses:
    """The pose gradients that rows carry, stored apart from all other gradients and shared by all buffers of a robot.

    Rows of one team see each other (ideal delivery); rows of different teams never do. A pose is repulsive by default:
    the paper's robots spread `goal_radius` 0.5 m, `diffusion` 1.0 m. With `hearing` a row sees what
    `PoseDelivery` has brought it, up to `history` poses old.

    Example:
        >>> poses = OwnPoses(Euclidean(2), rows=2, teams=np.array([0, 0]))
        >>> poses.update(np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros(2), now=0.0)

    Attributes:
        own: (N, K, POSE_COLUMNS) float64, poses of each row, the newest first.
        row_table: (N, ROW_COLUMNS or more) int64.
        radii: (N, 2) float64, diffusion and goal radius [m] of the poses that each row spreads; a host may change them.
        packed: all of them and more as compiled code takes them.

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
        self.row_table[:, c.ROW_TEAM] = codes
        self.row_table[:, c.ROW_COLUMNS :] = -1
        self._no_headings: Floats = np.zeros(rows)
        self.radii: Floats = np.tile([diffusion, goal_radius], (rows, 1))
        self.packed = POSES.pack(
            Poses(
                own=self.own,
                rows=self.row_table,
                first=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
                members=np.argsort(codes, kind="stable").astype(np.int64),
                reach=np.zeros(self.team_count),
                extent=space.padded_extent,
                cells=make_pose_cells(space, diffusion + goal_radius, sizes),
                buckets=np.full(1 << int(2 * rows - 1).bit_length(), -1, dtype=np.int32),
                links=np.full((rows, 2), -1, dtype=np.int32),
                radii=self.radii,
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
        bad = update_poses(positions, headings, known, float(now), self.packed.words)
        if bad >= 0:
            raise ValueError(f"OwnPoses.update: position and heading of row {bad} must be finite, got {positions[bad]}")

    def set_pose(self, row: int, position: Sequence[float], heading: Sequence[float], now: float) -> bool:
        """Spread one pose of one row; False if it is not newer than the last one.

        position: (D,) [m]; heading: (D,) direction, zero if there is none; now [s].
        """
        diffusion, goal_radius = self.radii[row].tolist()
        return self.set_gradient(
            row,
            Gradient(
                channel=self.channel,
                position=tuple(position),
                heading=tuple(heading),
                attraction=int(self.packed.record.attraction),
                diffusion=diffusion,
                goal_radius=goal_radius,
                stamp=now,
            ),
        )

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
        index_poses(self.packed.words)
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

    @property
    def teams(self) -> Ints:
        """Team of each row, (N,) int64, read only."""
        teams: Ints = self.row_table[:, c.ROW_TEAM]
        return teams

    def members(self, team: int) -> Ints:
        """Return the rows of a team, in their order."""
        first = self.packed.record.first
        return self.packed.record.members[first[team] : first[team + 1]]

    @property
    def positions(self) -> Floats:
        """Newest position of each row, (N, D) [m]; only meaningful where `known`."""
        positions: Floats = self.own[:, 0, c.X : c.X + self.space.dim]
        return positions

    @property
    def known(self) -> Flags:
        """Whether each row has spread a pose yet, (N,) bool."""
        known: Flags = self.row_table[:, c.ROW_POSES] > 0
        return known


class PoseDelivery:
    """Delivers poses among the rows of `poses`; call `deliver` after each update of the poses.

    Attributes:
        reaches: (T,) farthest receiver in each team [m]; the owner may change it.
        losses: (T,) probability that a receiver misses a pose, in each team; the owner may change it.
        generators: one for each row, for the losses of what it spreads; the owner may change it.
        delay: age of a pose on its arrival [updates].

    Raises:
        ValueError: poses that were not made with `hearing`.

    """

    def __init__(
        self,
        poses: OwnPoses,
        reaches: Floats,
        losses: Floats,
        generators: Sequence[np.random.Generator],
        delay: int = 0,
    ) -> None:
        if poses.row_table.shape[1] == c.ROW_HEARD:
            raise ValueError("PoseDelivery: the poses must be made with hearing=True")
        if not 0 <= delay < max(poses.history, 1):
            raise ValueError(f"PoseDelivery: delay must lie in the history of {poses.history} poses, got {delay!r}")
        self.poses, self.delay = poses, delay
        self.reaches, self.losses, self.generators = reaches, losses, generators
        self._draws: Floats = np.zeros((poses.rows, (poses.row_table.shape[1] - c.ROW_HEARD) // 2))

    def deliver(self) -> None:
        """Deliver the pose of each row that arrives now to the other rows in range, unless it gets lost.

        Losses are drawn, and ranges measured from where the pose was sent, on its arrival.
        """
        lossy = (self.losses > 0.0) & (self.losses < 1.0)
        if lossy.any():
            for row in np.flatnonzero(lossy[self.poses.teams] & self.poses.known).tolist():
                self._draws[row] = self.generators[row].random(self._draws.shape[1])
        deliver_poses(self.poses.packed.words, self.reaches, self.losses, self._draws, self.delay)


@lean_kernel
def update_poses(positions: Floats, headings: Floats, with_headings: bool, now: float, poses: Words[Poses]) -> int:
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


@kernel
def deliver_poses(poses: Words[Poses], reaches: Floats, losses: Floats, draws: Floats, delay: int) -> None:
    """Write for each pair of a team the ages of the last two poses received, -1 for none that is still remembered.

    reaches (T,) [m], losses (T,), draws (N, most members) uniform in [0, 1) of the row that spreads, delay [updates].
    """
    p = open_poses(poses)
    room = (p.rows.shape[1] - c.ROW_HEARD) // 2
    for team in range(len(reaches)):
        begin, count = int(p.first[team]), int(p.first[team + 1] - p.first[team])
        for receiver in range(count):
            row = int(p.members[begin + receiver])
            for index in range(count):
                other = int(p.members[begin + index])
                age, before = int(p.rows[row, c.ROW_HEARD + index]), int(p.rows[row, c.ROW_HEARD + room + index])
                age, before = age + 1 if age >= 0 else -1, before + 1 if before >= 0 else -1
                dx = p.own[other, delay, c.X] - p.own[row, 0, c.X]
                dy = p.own[other, delay, c.Y] - p.own[row, 0, c.Y]
                dz = p.own[other, delay, c.Z] - p.own[row, 0, c.Z]
                lost = losses[team] >= 1.0 or (losses[team] > 0.0 and draws[other, receiver] < losses[team])
                if not lost and squared_length(dx, dy, dz, p.extent) <= reaches[team] * reaches[team]:
                    age, before = delay, age
                known = p.rows[other, c.ROW_POSES] if p.rows[row, c.ROW_POSES] > 0 else 0
                p.rows[row, c.ROW_HEARD + index] = age if age < known else -1
                p.rows[row, c.ROW_HEARD + room + index] = before if before < known else -1
