"""Compiled loops over frames: rounding of values, and the bytes of their differences in time."""

import numpy as np
from numpy.typing import NDArray

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel, part

WholeNumbers = NDArray[np.int32]
Bytes = NDArray[np.uint8]


@part
def rounded(value: float, scale: float, largest: int) -> int:
    """Return a value times `scale`, rounded, within +-`largest`; 0 for NaN."""
    scaled = value * scale
    if scaled >= largest:
        return largest
    if scaled <= -largest:
        return -largest
    return int(np.rint(scaled)) if scaled == scaled else 0


@lean_kernel
def copy_poses(positions: Floats, headings: Floats, poses: Floats) -> None:
    """Fill `poses` (R, 3) with positions (R, 2) [m] and headings (R,) [rad]."""
    for row in range(len(poses)):
        poses[row, 0], poses[row, 1], poses[row, 2] = positions[row, 0], positions[row, 1], headings[row]


@lean_kernel
def pack_steps(
    layout: Ints,
    first: WholeNumbers,
    steps: WholeNumbers,
    bits: WholeNumbers,
    begin: int,
    end: int,
    sizes: Ints,
    content: Bytes,
) -> int:
    """Fill `content` with the bytes of the frames from `begin` to `end` of C channels; return their number.

    The channels come one after the other. Steps and bits of these frames are zeros afterwards.

    layout: (C, 2) number of columns, and how often differences are taken in time, 1 or 2.
    first, steps, bits: (K,), (K, T), (K,) as those of a world of `WaitingFrames`.
    sizes: (C, 2) will hold how many columns of the channel change, and the width of a number: 1, 2 or 4 bytes.
    """
    at = low = 0
    for channel in range(len(layout)):
        high = low + layout[channel, 0]
        at = pack_first(first, bits, low, high, content, at)
        moving = used = 0
        for k in range(low, high):
            if bits[k] != 0:
                moving += 1
                used |= bits[k] if layout[channel, 1] == 1 else difference_again(steps, k, begin + 1, end)
        width = 1 if used < 1 << 7 else 2 if used < 1 << 15 else 4
        sizes[channel, 0], sizes[channel, 1] = moving, width
        for place in range(width):
            for k in range(low, high):
                if bits[k] != 0:
                    for t in range(begin + 1, end):
                        content[at] = (steps[k, t] >> 8 * place) & 255
                        at += 1
        for k in range(low, high):
            if bits[k] != 0:
                bits[k] = 0
                for t in range(begin + 1, end):
                    steps[k, t] = 0
        low = high
    return at


@part
def pack_first(first: WholeNumbers, bits: WholeNumbers, low: int, high: int, content: Bytes, at: int) -> int:
    """Write the columns from `low` to `high` of the first frame from place `at` on, and a bit for each that changes.

    Returns the place after them.
    """
    for k in range(low, high):
        for place in range(4):
            content[at] = (first[k] >> 8 * place) & 255
            at += 1
    for begin in range(low, high, 8):
        marks = 0
        for k in range(begin, min(begin + 8, high)):
            marks |= (bits[k] != 0) << (k - begin)
        content[at] = marks
        at += 1
    return at


@part
def difference_again(steps: WholeNumbers, k: int, begin: int, end: int) -> int:
    """Put the differences of steps from `begin` to `end` of column k in their place; the first one stays.

    Returns a number with the bits of all of them, where -n - 1 counts as n.
    """
    used = int(steps[k, begin] ^ (steps[k, begin] >> 63))
    for t in range(end - 1, begin, -1):
        step = steps[k, t] - steps[k, t - 1]
        steps[k, t] = step
        used |= step ^ (step >> 63)
    return used
