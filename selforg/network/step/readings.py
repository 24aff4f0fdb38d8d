"""The border at which readings enter a network by name: a fact is a truth value, a number a number.

Whoever fills the readings of all rows at once writes the array itself (1.0 and 0.0 for facts); a step refuses what is
neither.
"""

from __future__ import annotations

import math
from typing import NoReturn

import numpy as np

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.behaviours import Sensor
from selforg.network.model.packed import Floats, Ints, begin_of

FINE = -1  # no wrong reading


class ReadingError(ValueError):
    """A reading that its sensor cannot have."""


def reading_of(sensor: Sensor, value: object) -> float:
    """Return `value` as the network stores it: 1.0 or 0.0 for a fact, the number itself for a number.

    A number sensor takes a truth value as 1 or 0 (Q26 of the original); a fact takes nothing but truth values (Q33).

    Raises:
        ReadingError: a fact that is not a bool, a number that is none or not a number.

    """
    if isinstance(value, bool | np.bool_):
        return float(value)
    if sensor.kind == "fact":
        raise ReadingError(f"sensor {sensor.name!r}: expected True or False, got {value!r}")
    if not isinstance(value, int | float | np.integer | np.floating) or math.isnan(value):
        raise ReadingError(f"sensor {sensor.name!r}: expected a number, got {value!r}")
    return float(value)


@inlined
def find_wrong(rows: Ints, ints: Ints, readings: Floats) -> int:
    """Return row * S + sensor of the first wrong reading in `rows` (K,) of `readings` (R, S), FINE if all are right."""
    is_fact, sensors = begin_of(ints, t.SENSOR_IS_FACT), readings.shape[1]
    for row in rows:
        for sensor in range(sensors):
            value = readings[row, sensor]
            if value == 0.0 or value == 1.0:
                continue
            if ints[is_fact + sensor] or value != value:
                return int(row * sensors + sensor)
    return FINE


def refuse(found: int, sensors: tuple[Sensor, ...], readings: Floats) -> NoReturn:
    """Raise the error for what `find_wrong` has found."""
    row, column = divmod(found, len(sensors))
    sensor = sensors[column]
    expected = "0 or 1 (it is a fact)" if sensor.kind == "fact" else "a number"
    raise ReadingError(f"row {row}: sensor {sensor.name!r}: expected {expected}, got {readings[row, column]}")
