"""What every registered sensor and action promises; a reader's own class joins by registering."""

from typing import ClassVar, get_args

import numpy as np
import pytest

from selforg.commands import Commands
from selforg.components import (
    ACTIONS,
    SENSORS,
    Action,
    DecisionSource,
    GoalSource,
    MovementSource,
    Remembered,
    RobotMemory,
    SensorComponent,
)
from selforg.components.actions import Call
from selforg.components.sources import Source
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import (
    Carried,
    DecisionMechanism,
    PredictiveSteering,
    Quorum,
    RepulsionGradient,
    SpreadGradient,
    SteeringMechanism,
)
from selforg.parameters import REQUIRED, parameters_of
from selforg.space import Euclidean

ROWS = np.arange(4)
PLACES = np.array([[0.0, 0.0], [0.6, 0.2], [9.5, 0.0], [40.0, 40.0]])


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


class Surroundings:
    """Four robots, two of them close together, one at a goal and one alone; and all that components refer to."""

    def __init__(self):
        poses = OwnPoses(Euclidean(2), 4, goal_radius=0.25, diffusion=1.0)
        poses.update(PLACES, np.zeros(4), 1.0)
        self.buffer = SoBuffer(BufferSettings(view_distance=2.0), poses.space, poses)
        self.buffer.store_static(0, "goal", np.array([[10.0, 0.0]]), 1.0, diffusion=1.0, goal_radius=0.25)
        self.memory = RobotMemory(4, {"fact": False})
        self.called = []
        quorum = Quorum(self.buffer, threshold=1.0)
        self.parts = {
            MovementSource: MovementSource(RepulsionGradient(self.buffer)),
            DecisionSource: DecisionSource(quorum),
            GoalSource: GoalSource(self.buffer),
            Remembered: self.memory["fact"],
            DecisionMechanism: quorum,
            SteeringMechanism: PredictiveSteering(self.buffer),
            SpreadGradient: SpreadGradient(self.buffer, carried=Carried("light")),
            Call: lambda now, rows: self.called.append(rows.tolist()),
        }

    def build(self, cls):
        """Return a component built with its example; what that leaves open is given by type."""
        arguments = dict(cls.example)
        for name, one in parameters_of(cls).items():
            if arguments.get(name) is None and (name in arguments or one.default is REQUIRED):
                kinds = (one.annotation, *get_args(one.annotation))
                arguments[name] = next(part for kind, part in self.parts.items() if kind in kinds)
        component = cls(**arguments)
        for source in component.sources:
            source.ask(1.0, ROWS)
        return component

    def state(self):
        """Return copies of all that a sensor must not change."""
        return [self.buffer.table.record.near[: len(self.buffer)].copy(), self.memory["fact"].values.copy()]


@pytest.fixture
def around():
    return Surroundings()


def same(first, second):
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("cls", list(SENSORS), ids=SENSORS.names())
def test_a_sensor_reads_one_finite_number_a_row_and_changes_nothing(cls, around):
    sensor = around.build(cls)
    before = around.state()
    readings = sensor.read(ROWS)
    assert (readings.shape, readings.dtype) in (((4,), np.float64), ((4,), np.bool_))
    assert np.isfinite(readings).all()
    assert sensor.kind == "number" or np.isin(readings, (0.0, 1.0)).all()
    np.testing.assert_array_equal(sensor.read(ROWS), readings)
    np.testing.assert_array_equal(sensor.read(np.array([2, 0])), readings[[2, 0]])
    assert sensor.read(ROWS[:0]).shape == (0,)
    same(around.state(), before)
    assert all(isinstance(source, Source) for source in sensor.sources)


@pytest.mark.parametrize("cls", list(ACTIONS), ids=ACTIONS.names())
def test_an_action_commands_its_rows_and_no_others(cls, around):
    action, commands = around.build(cls), Commands(4, 2)
    action.act(1.0, np.array([2, 0]), np.array([2]), commands)
    action.steer(1.0, np.array([2, 0]), commands)
    assert np.isfinite(commands.vectors).all()
    for array in (commands.vectors, commands.commanded, commands.in_place):
        assert not array[[1, 3]].any()
    assert not around.memory["fact"].values[[0, 1, 3]].any()
    action.leave(1.0, np.array([2, 0]))
    assert around.called in ([], [[2]])


@pytest.mark.parametrize("cls", list(ACTIONS), ids=ACTIONS.names())
def test_an_action_without_rows_does_nothing(cls, around):
    action, commands, before = around.build(cls), Commands(4, 2), around.state()
    action.act(1.0, ROWS[:0], ROWS[:0], commands)
    action.steer(1.0, ROWS[:0], commands)
    action.leave(1.0, ROWS[:0])
    assert not commands.commanded.any()
    same(around.state(), before)
    assert around.called == []
