"""Errors that are drawn again in each control period: of where robots believe to be, and of what their wheels do.

Rows are robots, R = W * N.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated

import numpy as np

from selforg.arrays import KEPT, READ, Floats, Ints


class Errors:
    """Two errors of each of R robots with a standard deviation of their own.

    Args:
        key: spawn key of their streams in a world.
        deviations: (R,).
        lasting: control periods in which an error falls to 1/e, coarsely; 1: each one is drawn for itself.

    Attributes:
        none: whether all errors are zero; then nothing is drawn.

    """

    _generators: Annotated[list[np.random.Generator], "R", KEPT]
    _errors: Annotated[Floats, "R 2", KEPT]  # in standard deviations
    _deviations: Annotated[Floats, "R 1", READ]

    def __init__(self, key: int, deviations: Floats, lasting: float = 1.0) -> None:
        self._key, self._deviations, self.none = key, deviations[:, None], not deviations.any()
        self._kept = 1.0 - 1.0 / max(lasting, 1.0)
        self._generators = [np.random.default_rng(0)] * len(deviations)
        self._errors = np.zeros((len(deviations), 2))

    def reset(self, rows: Ints, seed: np.random.SeedSequence) -> None:
        """Restart the draws of a world's `rows` (N,) without an error."""
        if not self.none:
            self._generators[rows[0] : rows[-1] + 1] = generators_of(seed, self._key, len(rows))
            self._errors[rows] = 0.0

    def draw(self) -> Floats:
        """Return the errors (R, 2) of the next control period."""
        fresh = sqrt(1.0 - self._kept**2)
        for row, generator in enumerate(self._generators):
            self._errors[row] = self._kept * self._errors[row] + fresh * generator.standard_normal(2)
        return self._deviations * self._errors


def generators_of(seed: np.random.SeedSequence, key: int, robots: int) -> list[np.random.Generator]:
    """Return generators for one purpose, one for each robot of a world that begins from `seed`."""
    streams = np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, key)).spawn(robots)
    return [np.random.default_rng(stream) for stream in streams]
