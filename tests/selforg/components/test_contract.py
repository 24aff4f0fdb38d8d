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


@pytest.mark.parametrize(
    ("read", "said"),
    [
        (lambda self, rows: np.zeros(3), r"Mine.read: expected finite numbers or facts \(4,\), got float64 \(3,\)"),
        (lambda self, rows: np.full(len(rows), np.nan), r"expected finite numbers or facts .* \[nan nan nan nan\]"),
        (lambda self, rows: ["a"] * len(rows), "expected finite numbers or facts"),
        (lambda self, rows: np.arange(len(rows)) * 1.0, "for some of the rows what all of them get"),
        (lambda self, rows: LUCK.random(len(rows)), "the same if it is asked twice"),
        (lambda self, rows: rows.sort() or np.zeros(len(rows)), "expected to change no array that it reads"),
        (lambda self, rows: self.nothing, "AttributeError: 'Mine' object has no attribute 'nothing'"),
    ],
)
def test_a_sensor_that_breaks_its_contract_is_one_line(read, said, monkeypatch):
    cls = type("Mine", (SensorComponent,), {"read": read, "__init__": lambda self: None, "__module__": __name__})
    monkeypatch.setitem(SENSORS._classes, "Mine", cls)
    with pytest.raises(PluginError, match=said):
        check_sensor(cls)


def test_a_fact_is_0_or_1(monkeypatch):
    def read(self, rows):
        return np.full(len(rows), 0.5)

    members = {"read": read, "kind": "fact", "__init__": lambda self: None, "__module__": __name__}
    monkeypatch.setitem(SENSORS._classes, "Mine", cls := type("Mine", (SensorComponent,), members))
    with pytest.raises(PluginError, match="expected 0 or 1 of a fact"):
        check_sensor(cls)


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (
            lambda self, now, rows, started, c: c.commanded.fill(True),
            "to command no rows in which the behaviour does not",
        ),
        (
            lambda self, now, rows, started, c: c.vectors[rows].fill(1) or c.vectors.__setitem__(rows, np.inf),
            "finite vec",
        ),
        (lambda self, now, rows, started, c: rows.fill(0), "expected to change no array that it reads"),
        (lambda self, now, rows, started, c: c.commanded.__setitem__(rows[0], True), "IndexError"),
    ],
)
def test_an_action_that_breaks_its_contract_is_one_line(act, said, monkeypatch):
    cls = type("Mine", (Action,), {"act": act, "__init__": lambda self: None, "__module__": __name__})
    monkeypatch.setitem(ACTIONS._classes, "Mine", cls)
    with pytest.raises(PluginError, match=said):
        check_action(cls)


def test_a_sensor_that_changes_what_its_source_says_is_one_line(monkeypatch):
    def read(self, rows):
        self.source.vectors[rows] = 0.0
        return np.zeros(len(rows))

    def begin(self, mechanism: MovementSource) -> None:
        self.source, self.sources = mechanism, (mechanism,)

    members = {"read": read, "__init__": begin, "__module__": __name__}
    monkeypatch.setitem(SENSORS._classes, "Mine", cls := type("Mine", (SensorComponent,), members))
    with pytest.raises(PluginError, match=r"Mine\.read: expected to change nothing"):
        check_sensor(cls)
