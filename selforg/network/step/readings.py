"""Readings: the first stage of a step refuses wrong ones; `reading_of` converts a value that a host gives by name.

A host that fills the readings of all rows at once writes the array itself, 1.0 and 0.0 for facts.
"""

from __future__ import annotations

import math
from typing import NoReturn

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle
from selforg.network.model.behaviours import Sensor
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import RowStates, open_states

NONE_WRONG = -1


class ReadingError(ValueError):
    """A reading that its sensor cannot have."""


def reading_of(sensor: Sensor, value: object) -> float:
    """Return `value` as the network stores it: 1.0 or 0.0 for a fact, the number itself for a number.

    A number sensor takes a truth value as 1 or 0 (Q26 of the original); a fact takes nothing but truth values (Q33).

    Raises:
        ReadingError: a fact that is not a bool, or a number that is NaN or no number at all.

    """
    if isinstance(value, bool | np.bool_):
        return float(value)
    if sensor.kind == "fact":
        raise ReadingError(f"sensor {sensor.name!r}: expected True or False, got {value!r}")
    if not isinstance(value, int | float | np.integer | np.floating) or math.isnan(value):
        raise ReadingError(f"sensor {sensor.name!r}: expected a number, got {value!r}")
    return float(value)


@inlined
def find_wrong(rows: Ints, model: Handle[PackedModel], states: Handle[RowStates]) -> int:
    """Return row * S + sensor of the first wrong reading of `rows` (K,), NONE_WRONG if all are right."""
    is_fact, readings = open_model(model).is_fact, open_states(states).readings
    sensors = readings.shape[1]
    for row in rows:
        read = readings[row]
        for sensor in range(sensors):
            value = read[sensor]
            if value == 0.0 or value == 1.0:
                continue
            if is_fact[sensor] or value != value:
                return int(row * sensors + sensor)
    return NONE_WRONG


def refuse(found: int, sensors: tuple[Sensor, ...], readings: Floats) -> NoReturn:
    """Raise the error for what `find_wrong` has found."""
    row, column = divmod(found, len(sensors))
    sensor = sensors[column]
    expected = "0 or 1 (it is a fact)" if sensor.kind == "fact" else "a number"
    raise ReadingError(f"row {row}: sensor {sensor.name!r}: expected {expected}, got {readings[row, column]}")
