"""Causes: because of which other robots a mechanism changes what a robot wants, and how much each of them counts.

They explain a movement after it has been made, and change nothing.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import part

MOST_CAUSES: Final = 3
"""Others that are kept for a row."""


class Causes:
    """The others that count most for each of R rows.

    Attributes:
        who: (R, MOST_CAUSES) their rows, the one that counts most first; -1 for none.
        weights: (R, MOST_CAUSES + 1) how much each counts, and last how much all others do together.

    """

    def __init__(self, rows: int) -> None:
        self.who: Ints = np.full((rows, MOST_CAUSES), -1)
        self.weights: Floats = np.zeros((rows, MOST_CAUSES + 1))

    def clear(self) -> None:
        """Forget all causes."""
        self.who.fill(-1)
        self.weights.fill(0.0)

    def shares(self) -> Floats:
        """Return the shares (R, MOST_CAUSES) of those that are kept in the whole weight; 0 for none."""
        kept, whole = self.weights[:, :-1], self.weights[:, -1:]
        return np.divide(kept, whole, out=np.zeros_like(kept), where=whole > 0.0)


@part
def note_cause(row: int, other: int, weight: float, who: Ints, weights: Floats) -> None:
    """Let an other count by its weight, if that is above 0, in the arrays of `Causes`."""
    if not weight > 0.0:
        return
    last = who.shape[1]
    weights[row, last] += weight
    place = last
    while place > 0 and weight > weights[row, place - 1]:
        place -= 1
    for k in range(last - 1, place, -1):
        who[row, k], weights[row, k] = who[row, k - 1], weights[row, k - 1]
    if place < last:
        who[row, place], weights[row, place] = other, weight
