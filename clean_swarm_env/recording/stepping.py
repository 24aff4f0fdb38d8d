"""Compiled loops over frames: rounding of values, and their differences in time."""

import numpy as np
from numpy.typing import NDArray

from selforg.arrays import Flags, Floats
from selforg.compiler.decorators import kernel

Whole = NDArray[np.int32]


@kernel
def round_values(values: Floats, scale: float, largest: int, whole: Whole) -> None:
    """Fill `whole` (K,) with `values` (K,) times `scale`, rounded, within +-`largest`; NaN becomes 0."""
    for k in range(values.shape[0]):
        scaled = values[k] * scale
        if scaled >= largest:
            whole[k] = largest
        elif scaled <= -largest:
            whole[k] = -largest
        else:
            whole[k] = np.int32(np.rint(scaled)) if scaled == scaled else 0


@kernel
def take_differences(whole: Whole, order: int, steps: Whole, changing: Flags) -> int:
    """Fill `steps` (K, T - 1) with the differences in time of `whole` (T, K), taken `order` times.

    The first difference of the second order is that of the first order. `changing` (K,): columns that change. Returns
    the largest size of a difference, where -n - 1 counts as n.
    """
    frames, columns = whole.shape
    largest = 0
    for k in range(columns):
        changing[k] = False
        before = 0
        for t in range(frames - 1):
            step = whole[t + 1, k] - whole[t, k]
            if step != 0:
                changing[k] = True
            kept = step - before if order == 2 else step
            before = step
            steps[k, t] = kept
            largest = max(largest, kept, -1 - kept)
    return largest
