"""What robots know: named values per robot, written by behaviours and read by sensors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats
from selforg.network.model.behaviours import Sensor, SensorKind
from selforg.network.step.readings import reading_of


class Knowledge:
    """Values of N robots by name; each is a fact (1 or 0) or a number, with the value that it has at first.

    >>> knowledge = Knowledge(2, {"home": True, "charge": 0.5})
    >>> knowledge.write("charge", [1], 0.25)
    >>> knowledge.values("charge").tolist()
    [0.5, 0.25]
    """

    def __init__(self, rows: int, first: Mapping[str, bool | float]) -> None:
        self.kinds: dict[str, SensorKind] = {
            name: "fact" if isinstance(value, bool | np.bool_) else "number" for name, value in first.items()
        }
        self._first = {name: reading_of(Sensor(name, self.kinds[name]), value) for name, value in first.items()}
        self._values = {name: np.full(rows, value) for name, value in self._first.items()}

    def values(self, name: str) -> Floats:
        """Return the values (N,) under a name; an unknown name raises ValueError."""
        if name not in self._values:
            raise ValueError(f"knowledge: unknown name {name!r} (known: {', '.join(self._values)})")
        return self._values[name]

    def write(self, name: str, rows: npt.ArrayLike, value: npt.ArrayLike) -> None:
        """Set what `rows` (K,) know under a name: one value or (K,)."""
        given = np.asarray(value, dtype=np.float64)
        if self.kinds.get(name) == "fact" and not np.isin(given, (0.0, 1.0)).all():
            raise ValueError(f"knowledge {name!r} is a fact: expected True or False, got {value!r}")
        if np.isnan(given).any():
            raise ValueError(f"knowledge {name!r}: expected numbers, got {value!r}")
        self.values(name)[np.asarray(rows, dtype=np.int64)] = given

    def reset(self, rows: npt.ArrayLike) -> None:
        """Let `rows` (K,) know again what they knew at first."""
        for name, value in self._first.items():
            self._values[name][np.asarray(rows, dtype=np.int64)] = value
