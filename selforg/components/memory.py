"""Memory of robots: named values of each robot, which behaviours write and sensors read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, Floats
from selforg.compiler.records import Packed
from selforg.components.sources import Answers
from selforg.network.model.behaviours import Sensor, SensorKind
from selforg.network.step.readings import reading_of


class RobotMemory:
    """Values of N robots by name, with their first values; a value is a fact (1 or 0) or a number.

    >>> memory = RobotMemory(2, {"home": True, "charge": 0.5})
    >>> memory["charge"].write([1], 0.25)
    >>> memory["charge"].values.tolist()
    [0.5, 0.25]
    """

    def __init__(self, rows: int, first: Mapping[str, bool | float]) -> None:
        self._remembered = {name: Remembered(name, rows, value) for name, value in first.items()}

    @property
    def kinds(self) -> dict[str, SensorKind]:
        """Whether each name stands for a fact or a number."""
        return {name: remembered.kind for name, remembered in self._remembered.items()}

    @property
    def facts(self) -> tuple[str, ...]:
        """Names of the facts."""
        return tuple(name for name, kind in self.kinds.items() if kind == "fact")

    def __getitem__(self, name: str) -> Remembered:
        """Return the values under a name; an unknown name raises ValueError."""
        if name not in self._remembered:
            raise ValueError(f"knowledge: unknown name {name!r} (known: {', '.join(self._remembered)})")
        return self._remembered[name]

    def reset(self, rows: npt.ArrayLike) -> None:
        """Reset all values of `rows` (K,) to the first ones."""
        for remembered in self._remembered.values():
            remembered.reset(rows)


class Remembered:
    """The values of N robots under one name.

    Attributes:
        kind: whether the values are facts or numbers.
        values: (N,) present values; facts are 1 or 0.
        answers: the same as a record.

    Raises:
        ReadingError: the first value is neither True or False nor a number.

    """

    values: Annotated[Floats, "N", KEPT]

    def __init__(self, name: str, rows: int, first: bool | float) -> None:
        self.name = name
        self.kind: SensorKind = "fact" if isinstance(first, bool | np.bool_) else "number"
        self._first = reading_of(Sensor(name, self.kind), first)
        self.values = np.full(rows, self._first)
        self.answers = Packed(Answers(np.ones(rows, dtype=np.bool_), self.values))

    def write(self, rows: npt.ArrayLike, value: npt.ArrayLike) -> None:
        """Set the values of `rows` (K,) to one value or to (K,) values; ValueError for a value of another kind."""
        given = np.asarray(value, dtype=np.float64)
        if self.kind == "fact" and not np.isin(given, (0.0, 1.0)).all():
            raise ValueError(f"knowledge {self.name!r} is a fact: expected True or False, got {value!r}")
        if np.isnan(given).any():
            raise ValueError(f"knowledge {self.name!r}: expected numbers, got {value!r}")
        self.values[np.asarray(rows, dtype=np.int64)] = given

    def reset(self, rows: npt.ArrayLike) -> None:
        """Reset the values of `rows` (K,) to the first one."""
        self.values[np.asarray(rows, dtype=np.int64)] = self._first
