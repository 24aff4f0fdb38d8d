"""What every registered sensor and action promises; a reader's own class joins by registering."""

from typing import ClassVar

import numpy as np
import pytest

from clean_swarm_env.testing import check_action, check_sensor
from selforg.components import ACTIONS, SENSORS, Action, MovementSource, SensorComponent
from selforg.plugins import PluginError

LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""


@SENSORS.register
class Heading(SensorComponent):
    """Direction of the movement [rad]: the worked example of the blueprint."""

    def __init__(self, mechanism: MovementSource) -> None:
        self.sources = (mechanism,)
        self._vectors = mechanism.vectors

    def read(self, rows):
        return np.arctan2(self._vectors[rows, 1], self._vectors[rows, 0])


@ACTIONS.register
class Back(Action):
    """Move against what a mechanism says."""

    example: ClassVar = {"share": 0.5}

    def __init__(self, mechanism: MovementSource, share: float) -> None:
        self.sources = (mechanism,)
        self._source, self._share = mechanism, share

    def act(self, now, rows, started, commands):
        commands.vectors[rows] = -self._share * self._source.vectors[rows]
        commands.commanded[rows] = self._source.active[rows]


@pytest.mark.parametrize("cls", list(SENSORS), ids=SENSORS.names())
def test_a_sensor_keeps_its_contract(cls):
    check_sensor(cls)


@pytest.mark.parametrize("cls", list(ACTIONS), ids=ACTIONS.names())
def test_an_action_keeps_its_contract(cls):
    check_action(cls)


def put(array, place, value):
    array[place] = value


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"read": lambda self, rows: np.zeros(3)},
         r"Mine.read: expected finite numbers or facts \(4,\), got float64 \(3,\)"),
        ({"read": lambda self, rows: np.full(len(rows), np.nan)},
         r"expected finite numbers or facts .* \[nan nan nan nan\]"),
        ({"read": lambda self, rows: ["a"] * len(rows)}, "expected finite numbers or facts"),
        ({"read": lambda self, rows: np.arange(len(rows)) * 1.0}, "for some of the rows what all of them get"),
        ({"read": lambda self, rows: LUCK.random(len(rows))}, "the same if it is asked twice"),
        ({"read": lambda self, rows: rows.sort() or np.zeros(len(rows))}, "expected to change no array that it reads"),
        ({"read": lambda self, rows: self.nothing}, "AttributeError: 'Mine' object has no attribute 'nothing'"),
        ({"read": lambda self, rows: np.full(len(rows), 0.5), "kind": "fact"}, "expected 0 or 1 of a fact"),
        ({"read": lambda self, rows: put(self._vectors, rows, 0.0) or np.zeros(len(rows)),
          "__init__": Heading.__init__}, r"Mine\.read: expected to change nothing"),
        ({"act": lambda self, now, rows, started, c: c.commanded.fill(True)},
         "to command no rows in which the behaviour does not"),
        ({"act": lambda self, now, rows, started, c: c.vectors[rows].fill(1) or put(c.vectors, rows, np.inf)},
         "finite vec"),
        ({"act": lambda self, now, rows, started, c: rows.fill(0)}, "expected to change no array that it reads"),
        ({"act": lambda self, now, rows, started, c: put(c.commanded, rows[0], True)}, "IndexError"),
    ],
)  # fmt: skip
def test_a_component_that_breaks_its_contract_is_one_line(members, said, monkeypatch):
    blueprint, registry = (SensorComponent, SENSORS) if "read" in members else (Action, ACTIONS)
    cls = type("Mine", (blueprint,), {"__init__": lambda self: None, "__module__": __name__, **members})
    monkeypatch.setitem(registry._classes, "Mine", cls)
    with pytest.raises(PluginError, match=said):
        (check_sensor if registry is SENSORS else check_action)(cls)
