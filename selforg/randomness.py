"""Random directions for compiled code: every row has a stream of its own."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from selforg.arrays import KEPT, Flags, Floats, Ints, derived
from selforg.compiler.decorators import kernel
from selforg.elementary import unit_vectors
from selforg.parameters import at_least, check_choice

GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))


class DirectionStream:
    """Unit vectors drawn ahead, one `Generator` per row, so that the draws of a row depend on no other row.

    Nothing is drawn at construction. `next_direction` sets `low` when a row has used half of its block, and `refill`
    then draws more. A row that takes more than half a block in one call gets its last vector again.

    Attributes:
        vectors: (N, block, 3) float64, drawn unit vectors, the third component zero in the plane.
        cursor: (N,) int64, next vector of each row.
        low: (1,) bool, whether some row may have used half of its block.

    """

    vectors: Annotated[Floats, "N BLOCK 3", KEPT]
    cursor: Annotated[Ints, "N", KEPT]
    low: Annotated[Flags, "1", derived(True)]
    _generators: Annotated[list[np.random.Generator | None], "N", KEPT]

    def __init__(self, generators: Sequence[np.random.Generator], dim: int = 2, block: int = 256) -> None:
        check_choice("DirectionStream: dim", dim, (2, 3))
        at_least(self, "block", block, 1)
        self.dim = dim
        self.block = block
        self._generators = list(generators)
        rows = len(self._generators)
        self.vectors = np.zeros((rows, block, 3))
        self.cursor = np.full(rows, block, dtype=np.int64)
        self.low = np.ones(1, dtype=np.bool_)

    @classmethod
    def fixed(cls, rows: int, dim: int = 2) -> "DirectionStream":
        """Return a stream that is not random: row i always gets the direction of i golden angles [rad]."""
        stream = cls((), dim, 1)
        stream._generators = [None] * rows
        cosines, sines = unit_vectors(GOLDEN_ANGLE * np.arange(rows))
        stream.vectors = np.stack([cosines, sines, np.zeros(rows)], axis=1)[:, None, :].copy()
        stream.cursor = np.zeros(rows, dtype=np.int64)
        stream.low[0] = False
        return stream

    def reset(self, rows: Ints | Sequence[int], generators: Sequence[np.random.Generator]) -> None:
        """Give `rows` (R,) new generators; their next direction is the first one of the new generator."""
        if len(rows) != len(generators):
            raise ValueError(f"DirectionStream.reset: {len(rows)} rows but {len(generators)} generators")
        for row, generator in zip(rows, generators, strict=True):
            self._generators[int(row)] = generator
            self.cursor[int(row)] = self.block
        self.low[0] = True

    def next_directions(self, rows: Ints) -> Floats:
        """Return the next unit vectors (K, 3) of `rows` (K,), each once at most; for kernels `next_direction`."""
        self.refill()
        places = np.minimum(self.cursor[rows], self.block - 1)
        self.cursor[rows] += 1
        self.low[0] = True
        return self.vectors[rows, places]

    def refill(self) -> None:
        """Draw for every row that has used half of its block; does nothing unless `low` is set."""
        if not self.low[0]:
            return
        for row in np.flatnonzero(2 * self.cursor >= self.block):
            generator = self._generators[row]
            if generator is None:
                continue
            used = min(int(self.cursor[row]), self.block)
            self.vectors[row, : self.block - used] = self.vectors[row, used:].copy()
            self.vectors[row, self.block - used :] = draw_directions(generator, used, self.dim)
            self.cursor[row] = 0
        self.low[0] = False


def draw_directions(generator: np.random.Generator, count: int, dim: int) -> Floats:
    """Return `count` unit vectors (count, 3), uniform on the circle (`dim` 2) or the sphere (`dim` 3).

    They are drawn one after the other, so that the stream does not depend on how many are drawn at a time.
    """
    uniform = generator.random((count, dim - 1))  # (count, 1 or 2) in [0, 1)
    cosines, sines = unit_vectors(2.0 * np.pi * uniform[:, 0])
    height = 2.0 * uniform[:, 1] - 1.0 if dim == 3 else np.zeros(count)
    radius = np.sqrt(1.0 - height * height)
    return np.stack([radius * cosines, radius * sines, height], axis=1)


@kernel
def next_direction(vectors: Floats, cursor: Ints, low: Flags, row: int) -> tuple[float, float, float]:
    """Return the next unit vector of `row`, advance its cursor, and set `low` where half of its block is used."""
    block = vectors.shape[1]
    index = min(int(cursor[row]), block - 1)
    cursor[row] = index + 1
    if 2 * (index + 1) >= block:
        low[0] = True
    return vectors[row, index, 0], vectors[row, index, 1], vectors[row, index, 2]
