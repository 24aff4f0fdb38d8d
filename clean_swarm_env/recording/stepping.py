"""Compiled loops over frames: rounding of values, and the bytes of their differences in time."""

import numpy as np
from numpy.typing import NDArray

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel, lean_kernel, part

WholeNumbers = NDArray[np.int32]
Bytes = NDArray[np.uint8]
TOGETHER = 256
"""Columns whose differences are taken in one go through time: memory is read a kilobyte at a time."""


@part
def rounded(value: float, scale: float, largest: int) -> int:
    """Return a value times `scale`, rounded, within +-`largest`; 0 for NaN."""
    scaled = value * scale
    if scaled >= largest:
        return largest
    if scaled <= -largest:
        return -largest
    return int(np.rint(scaled)) if scaled == scaled else 0


@kernel
def round_values(values: Floats, scale: float, largest: int, whole: WholeNumbers) -> None:
    """Fill `whole` (K,) with `values` (K,), `rounded`."""
    for k in range(values.shape[0]):
        whole[k] = rounded(values[k], scale, largest)


@lean_kernel
def copy_poses(positions: Floats, headings: Floats, poses: Floats) -> None:
    """Fill `poses` (R, 3) with positions (R, 2) [m] and headings (R,) [rad]."""
    for row in range(len(poses)):
        poses[row, 0], poses[row, 1], poses[row, 2] = positions[row, 0], positions[row, 1], headings[row]


@lean_kernel
def pack_columns(
    frames: WholeNumbers, layout: Ints, changed: WholeNumbers, steps: WholeNumbers, sizes: Ints, content: Bytes
) -> int:
    """Fill `content` with the bytes of frames (T, K) of C channels, one after the other; return their number.

    layout: (C, 3) number of columns, how often differences are taken in time, 1 or 2, and 1 for a channel that stays.
    changed: (K,) zeros; not 0 afterwards where a column changes.
    steps: (columns of the widest channel, T - 1) space for the differences.
    sizes: (C, 2) will hold how many columns of the channel change, and the width of a number: 1, 2 or 4 bytes.
    """
    count = len(frames)
    for t in range(1, count):
        begin = 0
        for channel in range(len(layout)):
            end = begin + layout[channel, 0]
            if layout[channel, 2] == 0:
                for k in range(begin, end):
                    changed[k] |= frames[t, k] ^ frames[t - 1, k]
            begin = end
    at = begin = 0
    for channel in range(len(layout)):
        end = begin + layout[channel, 0]
        at = pack_first(frames, changed, begin, end, content, at)
        bits = moving = 0
        for first in range(begin, end, TOGETHER):
            last = min(first + TOGETHER, end)
            bits |= take_differences(frames, changed, first, last, layout[channel, 1], steps, moving)
            for k in range(first, last):
                moving += changed[k] != 0
        width = 1 if bits < 1 << 7 else 2 if bits < 1 << 15 else 4
        sizes[channel, 0], sizes[channel, 1] = moving, width
        for place in range(width):
            for k in range(moving):
                for t in range(count - 1):
                    content[at + t] = (steps[k, t] >> 8 * place) & 255
                at += count - 1
        begin = end
    return at


@part
def pack_first(frames: WholeNumbers, changed: WholeNumbers, begin: int, end: int, content: Bytes, at: int) -> int:
    """Write the columns from `begin` to `end` of the first frame from place `at` on, and a bit for each that changes.

    Returns the place after them.
    """
    for k in range(begin, end):
        for place in range(4):
            content[at] = (frames[0, k] >> 8 * place) & 255
            at += 1
    for first in range(begin, end, 8):
        bits = 0
        for k in range(first, min(first + 8, end)):
            bits |= (changed[k] != 0) << (k - first)
        content[at] = bits
        at += 1
    return at


@part
def take_differences(
    frames: WholeNumbers, changed: WholeNumbers, first: int, last: int, order: int, steps: WholeNumbers, row: int
) -> int:
    """Fill rows of `steps`, from `row` on, with the differences in time of the columns that change.

    Differences are taken `order` times; the first one of the second order is that of the first order. Returns a number
    with the bits of all differences, where -n - 1 counts as n.
    """
    bits = 0
    for t in range(len(frames) - 1):
        to = row
        for k in range(first, last):
            if changed[k] != 0:
                step = frames[t + 1, k] - frames[t, k]
                if order == 2 and t > 0:
                    step -= frames[t, k] - frames[t - 1, k]
                steps[to, t] = step
                bits |= step ^ (step >> 63)
                to += 1
    return bits
