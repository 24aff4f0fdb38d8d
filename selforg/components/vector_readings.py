"""Readings of the sensors of movement vectors, written for all rows in one compiled call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Recording, Written
from selforg.components.sources import MovementSource


class ReadingTables(NamedTuple):
    """What `read_vectors` reads and writes, of N rows and C sensors."""

    vectors: Annotated[Floats, "N D", READ]  # of the source [m/s]
    active: Annotated[Flags, "N", READ]  # whether there is a vector
    longest_absent: Annotated[Floats, "C", READ]  # of each sensor [m/s]
    readings: Annotated[Floats, "N S", KEPT]  # of the network that has the sensors
    columns: Annotated[Ints, "C", READ]  # column of each sensor in `readings`
    other_readings: Annotated[Floats, "N T", KEPT]  # of a network that gets the readings too
    other_columns: Annotated[Ints, "C", READ]


READING_TABLES = Recording(ReadingTables)
open_tables = READING_TABLES.open


class VectorReadings:
    """Writes the readings of all vector sensors of one source in one call.

    Args:
        source: source of the vectors.
        longest_absent: column of `readings` -> largest length that counts as no vector [m/s].
        readings: (N, S) of the network that has the sensors.

    """

    def __init__(self, source: MovementSource, longest_absent: Mapping[int, float], readings: Floats) -> None:
        self._source, self._readings = source, readings
        self._longest = np.array(list(longest_absent.values()))
        self.columns: Ints = np.array(list(longest_absent), dtype=np.int64)
        self.show_in(readings, self.columns)

    def show_in(self, readings: Floats, columns: Ints) -> None:
        """Write later readings also into `columns` (C,) of other `readings` (N, T)."""
        source = self._source
        self._tables = READING_TABLES.pack(
            ReadingTables(source.vectors, source.active, self._longest, self._readings, self.columns, readings, columns)
        )

    def write(self, rows: Ints) -> None:
        """Write the readings of `rows` (K,)."""
        read_vectors(rows, self._tables.words)


@lean_kernel
def read_vectors(rows: Ints, tables: Written[ReadingTables]) -> None:
    """Write the readings of `rows` (K,): the length of the vector, 0 without one.

    A sensor with `longest_absent` >= 0 reads 1 where the length is larger than that, else 0.
    """
    t = open_tables(tables)
    for row in rows:
        length = 0.0
        if t.active[row]:
            for axis in range(t.vectors.shape[1]):
                length += t.vectors[row, axis] * t.vectors[row, axis]
            length = np.sqrt(length)
        for k in range(t.columns.shape[0]):
            reading = length
            if t.longest_absent[k] >= 0.0:
                reading = 1.0 if length > t.longest_absent[k] else 0.0
            t.readings[row, t.columns[k]] = reading
            t.other_readings[row, t.other_columns[k]] = reading
