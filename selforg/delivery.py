"""Delivery: who receives what is spread, and when. The input side of a buffer.

Ideal delivery (the default) needs nothing of this: all rows of a team share one content. With a limited range, losses
or a delay every row has a content of its own, and what is spread is stored once for each row that receives it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.columns import TAG_MOVING, TAG_SOURCE, TAG_SPACE, X
from selforg.poses import OwnPoses


@dataclass(frozen=True)
class Delivery:
    """How gradients travel from row to row.

    Attributes:
        reach: farthest receiver [m], from the centre of what is spread.
        loss: probability that a receiver misses a message, drawn for each receiver.
        delay: from spreading to storing [s].
        generators: one per team, for the losses; needed if `loss` is neither 0 nor 1.

    """

    reach: float = np.inf
    loss: float = 0.0
    delay: float = 0.0
    generators: Sequence[np.random.Generator] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        """Check every field."""
        if not self.reach >= 0:
            raise ValueError(f"Delivery: reach must be at least 0 [m], got {self.reach!r}")
        if not 0 <= self.loss <= 1:
            raise ValueError(f"Delivery: loss must be a probability, got {self.loss!r}")
        if not 0 <= self.delay < np.inf:
            raise ValueError(f"Delivery: delay must be at least 0 and finite [s], got {self.delay!r}")
        if 0 < self.loss < 1 and not self.generators:
            raise ValueError("Delivery: losses need one generator per team")

    @property
    def ideal(self) -> bool:
        """Whether everybody in a team receives everything at once."""
        return bool(np.isinf(self.reach)) and self.loss == 0 and self.delay == 0


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

    def take(self, now: float) -> list[tuple[Floats, Ints]]:
        """Take out what has arrived by `now` [s], in the order of arrival, then of posting."""
        due = sorted((i for i, arrival in enumerate(self.arrivals) if arrival <= now), key=lambda i: self.arrivals[i])
        taken = [(self.messages[i], self.tags[i]) for i in due]
        stays = [i for i, arrival in enumerate(self.arrivals) if arrival > now]
        self.arrivals = [self.arrivals[i] for i in stays]
        self.messages = [self.messages[i] for i in stays]
        self.tags = [self.tags[i] for i in stays]
        return taken

    def forget(self, rows: Ints) -> None:
        """Drop what is under way to `rows` (R,)."""
        for i, (messages, tags) in enumerate(zip(self.messages, self.tags, strict=True)):
            stays = ~np.isin(tags[:, TAG_SPACE], rows)
            self.messages[i], self.tags[i] = messages[stays], tags[stays]


def address(messages: Floats, tags: Ints, poses: OwnPoses, delivery: Delivery) -> tuple[Floats, Ints]:
    """Return messages and tags once for each row that receives them, TAG_SPACE being the receiver.

    messages (M, MESSAGE_COLUMNS), tags (M, TAG_COLUMNS), whose TAG_SOURCE is the row that spreads. A row always
    receives what it deposits itself, and never its own moving gradients.
    """
    out_messages, out_tags = [], []
    for message, tag in zip(messages, tags, strict=True):
        source = int(tag[TAG_SOURCE])
        team = int(poses.teams[source])
        rows = poses.members(team)
        offsets = poses.space.offsets(message[X : X + poses.space.dim], poses.positions[rows])
        near = poses.known[rows] & (np.sqrt((offsets * offsets).sum(axis=1)) <= delivery.reach)
        if 0 < delivery.loss < 1:  # a draw for every row, in range or not: who moves changes no luck
            near &= delivery.generators[team].random(len(rows)) >= delivery.loss
        elif delivery.loss == 1:
            near[:] = False
        near[rows == source] = not tag[TAG_MOVING]
        receivers = rows[near]
        copies = np.repeat(tag[None], len(receivers), axis=0)
        copies[:, TAG_SPACE] = receivers
        out_messages.append(np.repeat(message[None], len(receivers), axis=0))
        out_tags.append(copies)
    if not out_messages:
        return messages, tags
    return np.concatenate(out_messages), np.concatenate(out_tags)
