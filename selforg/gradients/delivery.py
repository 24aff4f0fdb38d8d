"""Delivery: the rules by which what a row spreads reaches other rows; `world.reception` sets them for worlds.

With ideal delivery (the default) all rows of a team share one content. With a limited range, losses or a delay every
row has a content of its own, and what is spread is stored once for each row that receives it. Poses are spread to all
of a team in every tick, and never copied: `PoseDelivery` notes for each member of the team the age, in the history of
that member, of the last two poses received from it. A row that looks at poses begins with the last one received.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Annotated, TypeAlias

import numpy as np

from selforg.arrays import READ, SCRATCH, Floats, Ints
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Handle, Packed, Written
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.space import nearest_image, squared_length
from selforg.walls.segments import Walls, is_hidden, no_walls, open_walls

Post: TypeAlias = tuple[float, Floats, Ints]
"""Arrival [s], messages (M, MESSAGE_COLUMNS), tags (M, TAG_COLUMNS)."""


@dataclass(frozen=True)
class Delivery:
    """How gradients travel from row to row.

    Attributes:
        reach: farthest receiver [m], from the centre of the gradient.
        loss: probability that a receiver misses a message, drawn for each receiver.
        delay: from spreading to storing [s].
        generators: one per team, or one per row for what it spreads; needed if `loss` is neither 0 nor 1.
        ranges: (N,) farthest receiver of what each row spreads [m], if `reach` is larger; empty: only `reach` counts.
        in_zones: (N,) probability that a message from or to each row gets lost where it is; empty: only `loss` counts.
        walls: stop messages to rows behind them.

    Reach and loss may be arrays (T,), one for each team, which their owner may change: then delivery is never taken for
    ideal, and every row has a content of its own.

    """

    reach: float | Floats = np.inf
    loss: float | Floats = 0.0
    delay: float = 0.0
    generators: Sequence[np.random.Generator] = field(default=(), repr=False)
    ranges: Annotated[Floats, "N", READ] = field(default_factory=lambda: np.zeros(0))
    in_zones: Annotated[Floats, "N", READ] = field(default_factory=lambda: np.zeros(0))
    walls: Packed[Walls] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        """Check every field."""
        if not np.all(np.asarray(self.reach) >= 0):
            raise ValueError(f"Delivery: reach must be at least 0 [m], got {self.reach!r}")
        losses = np.asarray(self.loss)
        if not np.all((losses >= 0) & (losses <= 1)):
            raise ValueError(f"Delivery: loss must be a probability, got {self.loss!r}")
        if not 0 <= self.delay < np.inf:
            raise ValueError(f"Delivery: delay must be at least 0 and finite [s], got {self.delay!r}")
        if np.any((losses > 0) & (losses < 1)) and not self.generators:
            raise ValueError("Delivery: losses need one generator per team")

    @property
    def ideal(self) -> bool:
        """Whether everybody in a team receives everything at once."""
        given = np.ndim(self.reach) + np.ndim(self.loss)
        return given == 0 and bool(np.isinf(self.reach)) and self.loss == 0 and self.delay == 0


class Mail:
    """Messages under way, in the order of posting: when they arrive [s], and the tables that the buffer will store."""

    def __init__(self) -> None:
        self.posts: list[Post] = []

    def add(self, arrival: float, messages: Floats, tags: Ints) -> None:
        """Post messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS) that arrive together."""
        self.posts.append((arrival, messages, tags))

    def collect(self, now: float) -> list[Post]:
        """Remove and return the messages that have arrived by `now` [s], in the order of arrival, then of posting."""
        if not self.posts:
            return []
        due = sorted((post for post in self.posts if post[0] <= now), key=itemgetter(0))
        self.posts = [post for post in self.posts if post[0] > now]
        return due

    def to(self, rows: Ints) -> list[Post]:
        """Return copies of the messages under way to `rows` (R,)."""
        addressed = ((*post, np.isin(post[2][:, c.TAG_SPACE], rows)) for post in self.posts)
        return [(arrival, messages[to], tags[to]) for arrival, messages, tags, to in addressed if to.any()]

    def forget(self, rows: Ints) -> None:
        """Delete the messages under way to `rows` (R,)."""
        stays = [~np.isin(tags[:, c.TAG_SPACE], rows) for _, _, tags in self.posts]
        posts = zip(self.posts, stays, strict=True)
        self.posts = [(arrival, messages[kept], tags[kept]) for (arrival, messages, tags), kept in posts]


def address(messages: Floats, tags: Ints, poses: OwnPoses, delivery: Delivery) -> tuple[Floats, Ints]:
    """Return messages and tags once for each row that receives them; TAG_SPACE is the receiver.

    messages (M, MESSAGE_COLUMNS), tags (M, TAG_COLUMNS), whose TAG_SOURCE is the row that spreads. A row always
    receives what it deposits itself, and never its own moving gradients.
    """
    teams = poses.teams[tags[:, c.TAG_SOURCE]]
    reaches = np.broadcast_to(delivery.reach, poses.team_count)
    losses = np.broadcast_to(delivery.loss, poses.team_count)
    of_message = reaches[teams]
    if len(delivery.ranges):
        of_message = np.minimum(of_message, delivery.ranges[tags[:, c.TAG_SOURCE]])
    sizes = np.bincount(poses.teams)
    draws = np.ones((len(messages), int(sizes[teams].max(initial=0))))
    chances = np.repeat(losses[teams][:, None], draws.shape[1], axis=1)
    silent = len(delivery.in_zones) > 0
    for index in range(len(messages)) if silent else ():
        at = delivery.in_zones[poses.members(int(teams[index]))]
        chances[index, : len(at)] = np.maximum(chances[index, : len(at)], at)
        chances[index] = np.maximum(chances[index], delivery.in_zones[tags[index, c.TAG_SOURCE]])
    for index in np.flatnonzero(silent | ((losses[teams] > 0) & (losses[teams] < 1))).tolist():
        # every row has a draw, in range or not, so that a move does not change the draws
        source, count = int(tags[index, c.TAG_SOURCE]), int(sizes[teams[index]])
        by_row = len(delivery.generators) == poses.rows
        draws[index, :count] = delivery.generators[source if by_row else int(teams[index])].random(count)
    received = np.empty((2, draws.size), dtype=np.int64)
    walls = (delivery.walls or no_walls()).handle
    found = find_receivers(messages, tags, of_message, chances, draws, poses.packed.handle, walls, received)
    which, receivers = received[:, :found]
    copies = tags[which]
    copies[:, c.TAG_SPACE] = receivers
    return messages[which], copies


@kernel
def find_receivers(
    messages: Floats,
    tags: Ints,
    reaches: Floats,
    losses: Floats,
    draws: Floats,
    poses: Handle[Poses],
    walls: Handle[Walls],
    receptions: Ints,
) -> int:
    """List in `receptions` (2, M) which message goes to which row, unless walls stop it; return how many there are.

    reaches (M,) [m], losses and draws (M, most members) of each message; see `address`.
    """
    p, walled, found = open_poses(poses), open_walls(walls).segments.shape[0] > 0, 0
    for message in range(len(messages)):
        source = tags[message, c.TAG_SOURCE]
        team = p.teams[source]
        for index in range(p.first[team + 1] - p.first[team]):
            row = p.members[p.first[team] + index]
            dx = p.own[row, 0, c.X] - messages[message, c.X]
            dy = p.own[row, 0, c.Y] - messages[message, c.Y]
            dz = p.own[row, 0, c.Z] - messages[message, c.Z]
            distance = np.sqrt(squared_length(dx, dy, dz, p.extent))
            hears = p.rows[row, c.ROW_POSES] > 0 and p.rows[row, c.ROW_DEAF] == 0
            near = hears and distance <= reaches[message]
            received = near and losses[message, index] < 1.0 and draws[message, index] >= losses[message, index]
            if row == source:
                received = tags[message, c.TAG_MOVING] == 0
            if received and walled:
                x, y = nearest_image(dx, p.extent[0]), nearest_image(dy, p.extent[1])
                received = not is_hidden(messages[message, c.X], messages[message, c.Y], x, y, p.extent, walls)
            if received:
                receptions[0, found], receptions[1, found] = message, row
                found += 1
    return found


class PoseDelivery:
    """Delivers poses among the rows of `poses`; call `deliver` after each update of the poses.

    Attributes:
        rule: range, losses and what else decides who hears whom; reach and loss are arrays (T,), its delay is not read.
        delay: age of a pose on its arrival [updates].

    Raises:
        ValueError: poses that were not made with `hearing`.

    """

    _ranges: Annotated[Floats, "N", READ]
    _draws: Annotated[Floats, "N MEMBERS", SCRATCH]

    def __init__(self, poses: OwnPoses, rule: Delivery, delay: int = 0) -> None:
        if poses.row_table.shape[1] == c.ROW_HEARD:
            raise ValueError("PoseDelivery: the poses must be made with hearing=True")
        if not 0 <= delay < max(poses.history, 1):
            raise ValueError(f"PoseDelivery: delay must lie in the history of {poses.history} poses, got {delay!r}")
        self.poses, self.rule, self.delay = poses, rule, delay
        self._ranges = rule.ranges if len(rule.ranges) else np.full(poses.rows, np.inf)
        self._walls = rule.walls or no_walls()
        self._draws = np.zeros((poses.rows, (poses.row_table.shape[1] - c.ROW_HEARD) // 2))

    def deliver(self) -> None:
        """Deliver the pose of each row that arrives now to the other rows in range, unless it gets lost.

        Losses are drawn, and ranges measured from where the pose was sent, on its arrival.
        """
        rule, reaches, losses = self.rule, np.asarray(self.rule.reach), np.asarray(self.rule.loss)
        lossy = (losses > 0.0) & (losses < 1.0) | (len(rule.in_zones) > 0)
        if lossy.any():
            for row in np.flatnonzero(lossy[self.poses.teams] & self.poses.known).tolist():
                self._draws[row] = rule.generators[row].random(self._draws.shape[1])
        poses, walls = self.poses.packed.handle, self._walls.handle
        deliver_poses(poses, reaches, self._ranges, losses, rule.in_zones, self._draws, self.delay, walls)


@kernel
def deliver_poses(
    poses: Written[Poses],
    reaches: Floats,
    ranges: Floats,
    losses: Floats,
    in_zones: Floats,
    draws: Floats,
    delay: int,
    walls: Handle[Walls],
) -> None:
    """Write for each pair of a team the ages of the last two poses received, -1 for none that is still remembered.

    reaches (T,) and ranges (N,) [m], losses (T,), in_zones (N,) or none, draws (N, most members) uniform in [0, 1) of
    the row that spreads, delay [updates].
    """
    p = open_poses(poses)
    room, walled = (p.rows.shape[1] - c.ROW_HEARD) // 2, open_walls(walls).segments.shape[0] > 0
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
                loss = losses[team]
                if len(in_zones) > 0:
                    loss = max(loss, in_zones[row], in_zones[other])
                lost = loss >= 1.0 or (loss > 0.0 and draws[other, receiver] < loss)
                reach = min(reaches[team], ranges[other])
                if not lost and squared_length(dx, dy, dz, p.extent) <= reach * reach:
                    x, y = p.own[row, 0, c.X], p.own[row, 0, c.Y]
                    dx, dy = nearest_image(dx, p.extent[0]), nearest_image(dy, p.extent[1])
                    if not (walled and is_hidden(x, y, dx, dy, p.extent, walls)):
                        age, before = delay, age
                known = p.rows[other, c.ROW_POSES] if p.rows[row, c.ROW_POSES] > 0 else 0
                p.rows[row, c.ROW_HEARD + index] = age if age < known else -1
                p.rows[row, c.ROW_HEARD + room + index] = before if before < known else -1
