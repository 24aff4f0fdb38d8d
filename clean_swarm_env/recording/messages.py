"""Deposits of gradients that robots leave behind, and poses of others that did not reach them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from clean_swarm_env.recording.channels import channel_of
from clean_swarm_env.recording.taking import Sampled
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.store import columns as c

LASTING = np.array([c.DIFFUSION, c.GOAL_RADIUS, c.MESSAGE_FAR + c.FAR_FACTOR, c.MESSAGE_FAR + c.FAR_PERIOD])
"""Columns of a message that are the same for all deposits of a mechanism."""


class MessageLog:
    """Deposits and missed poses of all rows in a tick.

    Attributes:
        deposits: (R,) kinds that each row has left, a bit for each.
        kinds: what was deposited so far; bit k of a number in `deposits` stands for kind k.

    """

    def __init__(self, worlds: Worlds) -> None:
        self.deposits: Ints = np.zeros(worlds.rows, dtype=np.int64)
        self._bits: dict[tuple[str, bytes, int, int], int] = {}
        self.kinds: list[dict[str, Any]] = []
        self._message: Floats = np.zeros(0)  # the latest, and its bit
        self._bit = 0
        self._worlds, self._buffers = worlds, worlds.minds.buffers
        self._missed: Ints = np.zeros(worlds.rows, dtype=np.int64)
        for name, buffer in self._buffers.items():
            buffer.tell_deposits(partial(self._note, name))

    def clear(self) -> None:
        """Clear the deposits of the tick before."""
        self.deposits.fill(0)

    def close(self) -> None:
        """Stop listening to the buffers."""
        for buffer in self._buffers.values():
            buffer.tell_deposits(None)

    def _note(self, name: str, rows: Ints, message: Floats, tag: Ints) -> None:
        if message is not self._message:  # a mechanism that leaves gradients has one message for all of them
            key = name, message[LASTING].tobytes(), int(tag[c.TAG_CHANNEL]), int(tag[c.TAG_SIGN])
            if key not in self._bits:
                self._bits[key] = 1 << len(self.kinds)
                self.kinds.append(_kind(name, self._buffers[name], message, tag))
            self._message, self._bit = message, self._bits[key]
        mark_rows(self.deposits, rows, self._bit)

    def arrays(self) -> Iterator[Sampled]:
        """Yield the arrays, both of one tick."""
        robots = {"robot": self._worlds.robots}
        about = "kinds of gradients that the robot leaves here, a bit for each"
        yield Sampled(channel_of("deposit", robots, about), self.deposits)
        if self._worlds.minds.reception.own_contents:
            about = "poses of others that the robot misses: lost, or out of range"
            yield Sampled(channel_of("missed", robots, about), self._missed, None, self._count)

    def _count(self) -> None:
        """Count the poses that each row missed in this tick."""
        worlds = self._worlds
        rows, delay, n = worlds.minds.poses.row_table, worlds.minds.reception.delay_ticks, worlds.robots
        spread, heard = rows[:, c.ROW_POSES] > delay, rows[:, c.ROW_HEARD : c.ROW_HEARD + n] == delay
        missed = np.repeat(spread.reshape(-1, n), n, axis=0) & ~heard
        missed[np.arange(worlds.rows), np.arange(worlds.rows) % n] = False  # its own pose
        self._missed[:] = missed.sum(axis=1) * worlds.team.working


@lean_kernel
def mark_rows(marks: Ints, rows: Ints, bit: int) -> None:
    """Set a bit of `marks` (R,) in `rows` (K,)."""
    for row in rows:
        marks[row] |= bit


def _kind(name: str, buffer: SoBuffer, message: Floats, tag: Ints) -> dict[str, Any]:
    """Return a kind of deposits as plain data."""
    far = message[c.MESSAGE_FAR :]
    return {
        "buffer": name,
        "channel": buffer.channels.name(int(tag[c.TAG_CHANNEL])),
        "attraction": int(tag[c.TAG_SIGN]),
        "diffusion": float(message[c.DIFFUSION]),
        "goal_radius": float(message[c.GOAL_RADIUS]),
        "evaporation_factor": float(far[c.FAR_FACTOR]),
        "evaporation_period": float(far[c.FAR_PERIOD]),
        "min_diffusion": buffer.settings.min_diffusion,
        "aggregation_distance": buffer.settings.aggregation_distance,
    }
