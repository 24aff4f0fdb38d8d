"""Sensor components: how a source or the own knowledge becomes a reading of a behaviour network."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import final

import numpy as np
import numpy.typing as npt

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import lean_kernel
from selforg.components.memory import Knowledge
from selforg.components.sources import DecisionSource, GoalSource, MovementSource, Source
from selforg.network.model.behaviours import SensorKind


class SensorComponent(ABC):
    """Blueprint of a sensor: `read` is called once a tick, after the sources were asked.

    Subclasses state their `kind`, name their `sources` and implement `_read`.

    Example:
        >>> class Heading(SensorComponent):
        ...     def _read(self, rows):
        ...         return compass[rows]

    """

    kind: SensorKind = "number"
    sources: Sequence[Source] = ()

    @final
    def read(self, rows: Ints) -> Floats:
        """Return the readings (K,) of `rows` (K,); facts are 1 or 0."""
        return np.asarray(self._read(rows), dtype=np.float64)

    @abstractmethod
    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        """Return what `rows` (K,) sense: bool or number (K,)."""


class VectorSensor(SensorComponent):
    """What the sensors over a movement vector share: they are read by a kernel."""

    longest_absent = -1.0
    """Length [m/s] that still counts as none, for a fact; negative for a number."""

    def __init__(self, source: MovementSource) -> None:
        self.source = source
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        readings = np.zeros((len(self.source.vectors), 1))
        VectorReadings(self.source, {0: self}, readings).write(rows)
        read: Floats = readings[rows, 0]
        return read


class VectorPresent(VectorSensor):
    """A fact: there is a movement vector, longer than `longer_than` [m/s] (so a zero vector is none)."""

    kind = "fact"

    def __init__(self, source: MovementSource, longer_than: float = 1e-9) -> None:
        super().__init__(source)
        if not longer_than >= 0.0:
            raise ValueError(f"VectorPresent: longer_than must be at least 0, got {longer_than}")
        self.longest_absent = float(longer_than)


class VectorLength(VectorSensor):
    """Length of the movement vector [m/s], 0 without one."""


class GoalSensor(SensorComponent):
    """What the sensors over a goal gradient share."""

    def __init__(self, source: GoalSource) -> None:
        self.source = source
        self.sources = (source,)


class GoalPresent(GoalSensor):
    """A fact: a goal gradient is in view."""

    kind = "fact"

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self.source.present[rows]


class GoalReached(GoalSensor):
    """A fact: the own goal area touches the goal's."""

    kind = "fact"

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self.source.present[rows] & (self.source.clearance[rows] <= 0.0)


class GoalDistance(SensorComponent):
    """Clearance to the goal [m], at least 0; `unseen` [m] where there is none in view."""

    def __init__(self, source: GoalSource, unseen: float) -> None:
        if not (unseen >= 0.0 and np.isfinite(unseen)):
            raise ValueError(f"GoalDistance: unseen must be a distance, got {unseen}")
        self.source, self.unseen = source, unseen
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return np.where(self.source.present[rows], np.maximum(self.source.clearance[rows], 0.0), self.unseen)


class FartherThan(SensorComponent):
    """A fact: a goal is in view, its clearance larger than `distance` [m]."""

    kind = "fact"

    def __init__(self, source: GoalSource, distance: float) -> None:
        self.source, self.distance = source, distance
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self.source.present[rows] & (self.source.clearance[rows] > self.distance)


class Value(SensorComponent):
    """The value that a decision mechanism would decide now [-]."""

    def __init__(self, source: DecisionSource) -> None:
        self.source = source
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self.source.values[rows]


class StateIs(SensorComponent):
    """A fact: a decision mechanism would decide for one certain state now."""

    kind = "fact"

    def __init__(self, source: DecisionSource, state: str) -> None:
        known = source.mechanism.states
        if state not in known:
            raise ValueError(f"StateIs: state must be one of {', '.join(known)}, got {state!r}")
        self.source, self.code = source, known.index(state)
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        there: Flags = self.source.states[rows] == self.code
        return there


class Changed(SensorComponent):
    """A fact: a decision mechanism would decide something else now than what it has spread last."""

    kind = "fact"

    def __init__(self, source: DecisionSource) -> None:
        self.source = source
        self.sources = (source,)

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self.source.differs[rows]


class Known(SensorComponent):
    """What the robot knows under a name."""

    def __init__(self, knowledge: Knowledge, name: str) -> None:
        self._values = knowledge.values(name)
        self.kind = knowledge.kinds[name]

    def _read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return self._values[rows]


class VectorReadings:
    """Writes what the vector sensors over one source read, all in one call.

    Args:
        source: theirs.
        sensors: the column of the readings of each.
        readings: (N, S) of the network that has the sensors.

    """

    def __init__(self, source: MovementSource, sensors: Mapping[int, VectorSensor], readings: Floats) -> None:
        self._source, self._readings = source, readings
        self._longest = np.array([sensor.longest_absent for sensor in sensors.values()])
        self.columns: Ints = np.array(list(sensors), dtype=np.int64)
        self.show_in(readings, self.columns)

    def show_in(self, readings: Floats, columns: Ints) -> None:
        """Write them into `columns` (C,) of other `readings` (N, T) too."""
        self._bundle = READING_TABLES.bundle(
            self._source.vectors, self._source.active, self._longest, self._readings, self.columns, readings, columns
        )

    def write(self, rows: Ints) -> None:
        """Write the readings of `rows` (K,)."""
        read_vectors(rows, self._bundle)


# vectors (N, D) and active (N,) of the source, longest absent (C,) [m/s]; twice readings (N, S) and columns (C,)
READING_TABLES = Layout("f2", "b1", "f1", "f2", "i1", "f2", "i1")
ReadingTables = tuple[Floats, Flags, Floats, Floats, Ints, Floats, Ints]
reading_tables_of: Callable[[Bundle], ReadingTables] = READING_TABLES.unbundle


@lean_kernel
def read_vectors(rows: Ints, tables: Bundle) -> None:
    """Write of `rows` (K,) the length of the vector, 0 without one.

    From a longest absent >= 0 on: 1 where it is longer than that, else 0.
    """
    vectors, active, longest, readings, columns, others, other_columns = reading_tables_of(tables)
    for row in rows:
        length = 0.0
        if active[row]:
            for axis in range(vectors.shape[1]):
                length += vectors[row, axis] * vectors[row, axis]
            length = np.sqrt(length)
        for k in range(columns.shape[0]):
            reading = length
            if longest[k] >= 0.0:
                reading = 1.0 if length > longest[k] else 0.0
            readings[row, columns[k]] = reading
            others[row, other_columns[k]] = reading
