"""What a frame is made of: numbers of arrays of the worlds, copied as whole numbers by one compiled loop.

Shapes: W worlds, T frames, K numbers a frame of one world.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from clean_swarm_env.recording.channels import LARGEST_WHOLE, AnyArray, Channel
from clean_swarm_env.recording.stepping import WholeNumbers, rounded
from selforg.arrays import Ints
from selforg.compiler.addresses import byte_at, float_at, int_at
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.switches import COMPILED, PLAIN

BY_ADDRESS = COMPILED and not PLAIN
"""Whether compiled code reads the arrays by their addresses, as it reads records."""
MOST_FRAMES: Final = 256
"""Frames that wait for being written; a killed run loses at most these."""
WAITING_BYTES: Final = 1 << 25
"""Memory for these frames; worlds with many robots and minds keep fewer."""
LEAST_FRAMES: Final = 16
# columns of a table of sources
ADDRESS, KIND, SCALE, BEGIN, LENGTHS, STRIDES, SOURCE_COLUMNS = 0, 1, 2, 3, 4, 7, 11
NUMBER_KINDS = {np.dtype(np.float64): 0, np.dtype(np.int64): 1, np.dtype(np.bool_): 2}
FLOATS, INTS = 0, 1


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


class FrameFiller:
    """Copies the numbers of some channels of all worlds into their columns of a frame.

    Args:
        sampled: the channels, each with the first of its columns.
        worlds: W.

    Attributes:
        columns: their columns, if they lie side by side.

    """

    def __init__(self, sampled: Sequence[tuple[int, Sampled]], worlds: int) -> None:
        self._sources = [  # views: to split the first axis copies nothing
            (begin, each.channel, each.values.reshape(worlds, *each.channel.shape)) for begin, each in sampled
        ]
        begin, (end, last) = sampled[0][0], sampled[-1]
        self.columns = slice(begin, end + last.channel.columns)
        self._table: Ints = np.zeros((len(sampled), SOURCE_COLUMNS), dtype=np.int64)
        for row, (begin, channel, values) in zip(self._table, self._sources, strict=True):
            row[:LENGTHS] = values.ctypes.data, NUMBER_KINDS[values.dtype], channel.scale, begin
            if values[0].flags.c_contiguous:
                values = values.reshape(worlds, -1)  # one long loop in place of three
            row[LENGTHS:STRIDES] = (1, 1, 1, *values.shape[1:])[-3:]
            row[STRIDES:] = values.strides[0], *(0, 0, 0, *values.strides[1:])[-3:]

    def fill(self, frames: WholeNumbers, at: int) -> None:
        """Fill the columns of frame `at` of `frames` (W, T, K)."""
        if BY_ADDRESS:
            take_numbers(self._table, frames, at)
            return
        for begin, channel, values in self._sources:
            frames[:, at, begin : begin + channel.columns] = channel.whole(values)


def fillers_of(sampled: Sequence[Sampled], worlds: int) -> tuple[FrameFiller, dict[tuple[int, int], FrameFiller]]:
    """Return what fills the columns of all channels but those of options, and of each option, in the order given."""
    begins = np.cumsum([0, *(each.channel.columns for each in sampled)]).tolist()
    by_option: dict[tuple[int, int] | None, list[tuple[int, Sampled]]] = {None: []}
    for begin, each in zip(begins, sampled, strict=False):
        by_option.setdefault(each.option, []).append((begin, each))
    always = FrameFiller(by_option.pop(None), worlds)
    return always, {option: FrameFiller(own, worlds) for option, own in by_option.items() if option is not None}


def waiting_frames(worlds: int, channels: Sequence[Channel]) -> WholeNumbers:
    """Return memory (W, T, K) for the frames of all channels that wait for being written."""
    columns = sum(channel.columns for channel in channels)
    frames = int(np.clip(WAITING_BYTES // (4 * worlds * columns), LEAST_FRAMES, MOST_FRAMES))
    return np.zeros((worlds, frames, columns), dtype=np.int32)


@lean_kernel
def take_numbers(table: Ints, frames: WholeNumbers, at: int) -> None:
    """Fill frame `at` of `frames` (W, T, K) from the sources in the rows of a table; see `FrameFiller`."""
    for row in range(len(table)):
        kind, scale = table[row, KIND], float(table[row, SCALE])
        first, second, third = table[row, LENGTHS], table[row, LENGTHS + 1], table[row, LENGTHS + 2]
        to_second, to_third, to_next = table[row, STRIDES + 1], table[row, STRIDES + 2], table[row, STRIDES + 3]
        for world in range(len(frames)):
            begin, column = table[row, ADDRESS] + world * table[row, STRIDES], table[row, BEGIN]
            for i in range(first):
                for j in range(second):
                    place = begin + i * to_second + j * to_third
                    if kind == FLOATS:
                        for k in range(third):
                            number = rounded(float_at(place + k * to_next), scale, LARGEST_WHOLE)
                            frames[world, at, column + k] = number
                    elif kind == INTS:
                        for k in range(third):
                            frames[world, at, column + k] = int_at(place + k * to_next)
                    else:
                        for k in range(third):
                            frames[world, at, column + k] = byte_at(place + k * to_next)
                    column += third
