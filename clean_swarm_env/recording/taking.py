"""The frames of a recording: one compiled loop takes numbers of arrays of the worlds, and notes those that changed.

What else was tried: docs/decisions/0183-changed-numbers.md.

Shapes: W worlds, T frames, K numbers a frame of one world.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from clean_swarm_env.recording.channels import LARGEST_WHOLE, Channel, PackedFrames
from clean_swarm_env.recording.stepping import WholeNumbers, pack_steps, rounded
from clean_swarm_env.world.parts.shown import AnyArray
from selforg.arrays import Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.intrinsics import byte_at, float_at, int_at
from selforg.compiler.switches import BY_ADDRESS

MOST_FRAMES: Final = 250
"""Frames that wait for being written; a killed run loses at most these. No power of two, for the processor's caches."""
WAITING_BYTES: Final = 1 << 25
"""Memory for these frames; worlds with many robots and minds keep fewer."""
LEAST_FRAMES: Final = 16
# columns of a table of sources
ADDRESS, KIND, SCALE, BEGIN, LENGTHS, STRIDES = 0, 1, 2, 3, 4, 7
NUMBER_KINDS = {np.dtype(np.float64): 0, np.dtype(np.int64): 1, np.dtype(np.bool_): 2}
FLOATS, INTS = 0, 1
IDLE, FIRST, GOING = range(3)


@dataclass(frozen=True)
class Sampled:
    """A channel, and the array whose numbers it holds in every frame."""

    channel: Channel
    values: AnyArray
    """(W * N, ...) or (W, ...) numbers, or a view of them: the same memory all the time."""
    option: tuple[int, int] | None = None
    """The coordinator and its option to which the array belongs: it changes only while a robot holds the option."""
    prepare: Callable[[], None] | None = None
    """Brings the numbers up to date, before every frame."""


class WaitingFrames:
    """Frames of W worlds that wait for being written: the numbers of the first one, and how later ones differ.

    Most numbers stay as they are from frame to frame, and cost one look.

    Args:
        sampled: the channels, and where their numbers are.
        worlds: W.

    Attributes:
        channels: the channels.
        room: T, frames for which there is room.
        at: how many there are.
        steps: (W, K, T) what is added to each number in each frame.

    """

    def __init__(self, sampled: Sequence[Sampled], worlds: int) -> None:
        self.channels = tuple(each.channel for each in sampled)
        columns = [channel.columns for channel in self.channels]
        begins, total = np.cumsum([0, *columns]).tolist(), sum(columns)
        self.room = int(np.clip(WAITING_BYTES // (4 * worlds * total), LEAST_FRAMES, MOST_FRAMES))
        self.at = 0
        self._prepare = [each.prepare for each in sampled if each.prepare is not None]
        self._sources = [  # views: to split the first axis copies nothing
            (begin, each.channel, each.values.reshape(worlds, *each.channel.shape))
            for begin, each in zip(begins, sampled, strict=False)
        ]
        self._options = [each.option for each in sampled]
        self._table: Ints = np.array([_source(*source) for source in self._sources])
        self._due: Ints = np.arange(len(sampled))  # the channels that are looked at
        self._used: Sequence[Sequence[int]] | None = None  # the options in use, to which they belong; None for all
        self._layout: Ints = np.array([(channel.columns, channel.order) for channel in self.channels])
        self._stages: Ints = np.full(worlds, IDLE)
        self._begins: Ints = np.zeros(worlds, dtype=np.int64)  # the first frame of each world
        self._new: list[int] = []  # worlds whose first frame is the next one
        self._first, self._last, self._bits = (np.zeros((worlds, total), dtype=np.int32) for _ in range(3))
        self.steps: WholeNumbers = np.zeros((worlds, total, self.room), dtype=np.int32)

    def start(self, world: int) -> None:
        """Let the next frame be the first one of a world, of which no frame waits."""
        self._stages[world], self._begins[world] = FIRST, self.at
        self._new.append(world)

    def restart(self, worlds: Iterable[int]) -> None:
        """Start again with some worlds, once all frames are packed."""
        self.at = 0
        for world in worlds:
            self.start(world)

    def record(self, used: Sequence[Sequence[int]] | None = None) -> None:
        """Record a frame.

        `used`: the options of each coordinator that robots hold; the numbers of others are not looked at. None for all.
        """
        if used != self._used:
            self._used = used
            looked_at = [each is None or used is None or each[1] in used[each[0]] for each in self._options]
            self._due = np.flatnonzero(looked_at)
        for prepare in self._prepare:
            prepare()
        if BY_ADDRESS:
            record_numbers(self._table, self._due, self._stages, self.at, self._last, self.steps, self._bits)
        else:
            self._record()
        for world in self._new:
            self._first[world] = self._last[world]
            self._stages[world] = GOING
        self._new.clear()
        self.at += 1

    def waiting(self, world: int) -> int:
        """Return how many frames of a world wait."""
        return self.at - int(self._begins[world])

    def pack(self, world: int) -> PackedFrames:
        """Return the frames of a world of which some wait; later ones are not taken until it begins again."""
        self._stages[world] = IDLE
        return self._packed(self._first[world], self._bits[world], world, int(self._begins[world]))

    def latest(self, world: int) -> PackedFrames:
        """Return the last frame of a world."""
        return self._packed(self._last[world], np.zeros_like(self._bits[world]), world, self.at - 1)

    def present(self, world: int) -> PackedFrames:
        """Return a frame of the present arrays, which is not recorded."""
        for prepare in self._prepare:
            prepare()
        numbers = [channel.whole(values[world : world + 1])[0] for _, channel, values in self._sources]
        return self._packed(np.concatenate(numbers), np.zeros_like(self._bits[world]), world, self.at - 1)

    def _packed(self, first: WholeNumbers, bits: WholeNumbers, world: int, begin: int) -> PackedFrames:
        sizes: Ints = np.empty((len(self.channels), 2), dtype=np.int64)
        content = np.empty(4 * len(first) * (self.at - begin) + sum(-(-self._layout[:, 0] // 8)), dtype=np.uint8)
        used = pack_steps(self._layout, first, self.steps[world], bits, begin, self.at, sizes, content)
        return PackedFrames(self.at - begin, list(map(tuple, sizes.tolist())), content[:used].tobytes())

    def _record(self) -> None:
        """Do what `record_numbers` does."""
        going = (self._stages == GOING)[:, np.newaxis]
        for begin, channel, values in (self._sources[k] for k in self._due):
            own = slice(begin, begin + channel.columns)
            numbers = channel.whole(values)
            steps = np.where(going, numbers - self._last[:, own], 0)
            self.steps[:, own, self.at] = steps
            self._bits[:, own] |= (steps != 0) | steps ^ (steps >> 31)
            self._last[:, own] = numbers


def _source(begin: int, channel: Channel, values: AnyArray) -> list[int]:
    """Return the row of a channel, whose columns begin at `begin`, in a table of sources; values (W, ...)."""
    worlds = len(values)
    row = [values.ctypes.data, NUMBER_KINDS[values.dtype], channel.scale, begin]
    if values[0].flags.c_contiguous:
        values = values.reshape(worlds, -1)  # one long loop in place of three
    return [*row, *(1, 1, 1, *values.shape[1:])[-3:], values.strides[0], *(0, 0, 0, *values.strides[1:])[-3:]]


@lean_kernel
def record_numbers(
    table: Ints, due: Ints, stages: Ints, at: int, last: WholeNumbers, steps: WholeNumbers, bits: WholeNumbers
) -> None:
    """Bring `last` (W, K) up to date from the sources in the rows `due` of a table; note what changed as frame `at`.

    stages: (W,) whether a world is idle, in its first frame, of which nothing is noted, or going.
    steps: (W, K, T), 0 until a number changes. bits: (W, K) bits of all steps, where -n - 1 counts as n; 0 for none.
    """
    for row in due:
        kind, scale = table[row, KIND], float(table[row, SCALE])
        first, second, third = table[row, LENGTHS], table[row, LENGTHS + 1], table[row, LENGTHS + 2]
        to_second, to_third, to_next = table[row, STRIDES + 1], table[row, STRIDES + 2], table[row, STRIDES + 3]
        for world in range(len(stages)):
            if stages[world] == IDLE:
                continue
            begin, column = table[row, ADDRESS] + world * table[row, STRIDES], table[row, BEGIN]
            for i in range(first):
                for j in range(second):
                    place = begin + i * to_second + j * to_third
                    for _ in range(third):
                        if kind == FLOATS:
                            number = rounded(float_at(place), scale, LARGEST_WHOLE)
                        elif kind == INTS:
                            number = int(int_at(place))
                        else:
                            number = int(byte_at(place))
                        step = number - last[world, column]
                        if step != 0:
                            last[world, column] = number
                            if stages[world] == GOING:
                                steps[world, column, at] = step
                                bits[world, column] |= 1 | step ^ (step >> 63)
                        place += to_next
                        column += 1
