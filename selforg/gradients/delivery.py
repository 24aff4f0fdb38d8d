"""Delivery: which rows receive what is spread, and when.

With ideal delivery (the default) all rows of a team share one content. With a limited range, losses or a delay every
row has a content of its own, and what is spread is stored once for each row that receives it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Words
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.space import squared_length


@dataclass(frozen=True)
class Delivery:
    """How gradients travel from row to row.

    Attributes:
        reach: farthest receiver [m], from the centre of what is spread.
        loss: probability that a receiver misses a message, drawn for each receiver.
        delay: from spreading to storing [s].
        generators: one per team, or one per row for what it spreads; needed if `loss` is neither 0 nor 1.

    Reach and loss may be arrays (T,), one for each team, which their owner may change: then delivery is never taken for
    ideal, and every row has a content of its own.

    """

    reach: float | Floats = np.inf
    loss: float | Floats = 0.0
    delay: float = 0.0
    generators: Sequence[np.random.Generator] = field(default=(), repr=False)

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


@dataclass
class Mail:
    """Messages under way: when they arrive [s], and the tables that the buffer will store."""

    arrivals: list[float] = field(default_factory=list)
    messages: list[Floats] = field(default_factory=list)
    tags: list[Ints] = field(default_factory=list)

    def add(self, arrival: float, messages: Floats, tags: Ints) -> None:
        """Post messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS) that arrive together."""
        self.arrivals.append(arrival)
        self.messages.append(messages)
        self.tags.append(tags)

    def collect(self, now: float) -> list[tuple[Floats, Ints]]:
        """Remove and return what has arrived by `now` [s], in the order of arrival, then of posting."""
        due = sorted((i for i, arrival in enumerate(self.arrivals) if arrival <= now), key=lambda i: self.arrivals[i])
        taken = [(self.messages[i], self.tags[i]) for i in due]
        stays = [i for i, arrival in enumerate(self.arrivals) if arrival > now]
        self.arrivals = [self.arrivals[i] for i in stays]
        self.messages = [self.messages[i] for i in stays]
        self.tags = [self.tags[i] for i in stays]
        return taken

    def to(self, rows: Ints) -> list[tuple[float, Floats, Ints]]:
        """Return copies of what is under way to `rows` (R,), in the order of posting: arrivals [s], messages, tags."""
        posts = zip(self.arrivals, self.messages, self.tags, strict=True)
        addressed = ((*post, np.isin(post[2][:, c.TAG_SPACE], rows)) for post in posts)
        return [(arrival, messages[to], tags[to]) for arrival, messages, tags, to in addressed if to.any()]

    def forget(self, rows: Ints) -> None:
        """Delete what is under way to `rows` (R,)."""
        for i, (messages, tags) in enumerate(zip(self.messages, self.tags, strict=True)):
            stays = ~np.isin(tags[:, c.TAG_SPACE], rows)
            self.messages[i], self.tags[i] = messages[stays], tags[stays]


def address(messages: Floats, tags: Ints, poses: OwnPoses, delivery: Delivery) -> tuple[Floats, Ints]:
    """Return messages and tags once for each row that receives them; TAG_SPACE is the receiver.

    messages (M, MESSAGE_COLUMNS), tags (M, TAG_COLUMNS), whose TAG_SOURCE is the row that spreads. A row always
    receives what it deposits itself, and never its own moving gradients.
    """
    teams = poses.teams[tags[:, c.TAG_SOURCE]]
    reaches = np.broadcast_to(delivery.reach, poses.team_count)
    losses = np.broadcast_to(delivery.loss, poses.team_count)
    sizes = np.bincount(poses.teams)
    draws = np.ones((len(messages), int(sizes[teams].max(initial=0))))
    for index in np.flatnonzero((losses[teams] > 0) & (losses[teams] < 1)).tolist():
        # every row has a draw, in range or not, so that a move does not change the draws
        source, count = int(tags[index, c.TAG_SOURCE]), int(sizes[teams[index]])
        by_row = len(delivery.generators) == poses.rows
        draws[index, :count] = delivery.generators[source if by_row else int(teams[index])].random(count)
    which, receivers = np.empty(draws.size, dtype=np.int64), np.empty(draws.size, dtype=np.int64)
    found = find_receivers(messages, tags, reaches[teams], losses[teams], draws, poses.packed.words, which, receivers)
    copies = tags[which[:found]]
    copies[:, c.TAG_SPACE] = receivers[:found]
    return messages[which[:found]], copies


@kernel
def find_receivers(
    messages: Floats,
    tags: Ints,
    reaches: Floats,
    losses: Floats,
    draws: Floats,
    poses: Words[Poses],
    which: Ints,
    receivers: Ints,
) -> int:
    """List which message goes to which row, message by message, and return how many there are.

    reaches (M,) [m], losses (M,), draws (M, most members) of each message; see `address`.
    """
    p = open_poses(poses)
    found = 0
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
            received = near and losses[message] < 1.0 and draws[message, index] >= losses[message]
            if row == source:
                received = tags[message, c.TAG_MOVING] == 0
            if received:
                which[found], receivers[found] = message, row
                found += 1
    return found
