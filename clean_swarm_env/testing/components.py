"""The contract of components: sensors and actions, as documents declare them, and activators."""

from __future__ import annotations

from typing import Any

import numpy as np

from clean_swarm_env.testing.expecting import expect, expect_registered, expect_same
from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import Host
from selector.configurations.running import RunningConfiguration
from selector.documents.errors import validated
from selector.vocabulary.conditions import ActivatorSpec
from selector.vocabulary.constructors import references_of
from selforg.arrays import Ints
from selforg.commands import Commands
from selforg.components import ACTIONS, SENSORS, Action, RobotMemory, SensorComponent
from selforg.components.facts import SHARED_FACTS, FactRule, SharedFact
from selforg.components.sources import Source
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import DecisionMechanism, MovementMechanism, SteeringMechanism
from selforg.network.model.activators import ACTIVATORS, BOOLEAN_RULE, EQUAL_RULE, Activator
from selforg.plugins import contract
from selforg.space import Euclidean

EACH_ROW, SOME, OTHERS = np.arange(4), np.array([2, 0]), np.array([1, 3])
OF_KIND = {MovementMechanism: "go", DecisionMechanism: "quorum", SteeringMechanism: "bend"}
"""Base class of mechanisms -> name of one in the document."""
NAMES = {"target": "goal", "knowledge": "told", "call": "ring", "fact": "danger"}
PARTS = {
    "mechanisms": {
        "go": {"type": "RepulsionGradient"},
        "quorum": {"type": "Quorum", "parameters": {"threshold": 1.0}},
        "bend": {"type": "PredictiveSteering"},
        "light": {"type": "SpreadGradient", "parameters": {"carried": {"channel": "light"}}},
    },
    "targets": {"goal": {}},
    "expects": {"told": "fact"},
}


class Scene:
    """Four robots, two of them close together, one at a goal and one alone; and all that components refer to."""

    def __init__(self) -> None:
        poses = OwnPoses(Euclidean(2), 4, goal_radius=0.25, diffusion=1.0)
        poses.update(np.array([[0.0, 0.0], [0.6, 0.2], [9.5, 0.0], [40.0, 40.0]]), np.zeros(4), 1.0)
        buffer = SoBuffer(BufferSettings(view_distance=2.0), poses.space, poses)
        buffer.store_static(0, "goal", np.array([[10.0, 0.0]]), 1.0, diffusion=1.0, goal_radius=0.25)
        self.called: list[list[int]] = []
        self.sources: tuple[Source, ...] = ()
        calls = {"ring": lambda now, rows: self.called.append(rows.tolist())}
        facts = {"danger": SharedFact(SoBuffer(SHARED_FACTS, poses.space, poses), "danger", FactRule())}
        facts["danger"].tell(0.8, np.array([1]), 3.0)
        memory = RobotMemory(4, {"told": False})
        self.host = Host(poses, {"gradients": buffer}, memory=memory, calls=calls, facts=facts)

    def build(self, cls: type, parameters: dict[str, Any]) -> Any:  # noqa: ANN401  (a sensor or an action)
        """Return a component of a document, with its sources asked; DocumentError for what a document cannot say."""
        sensor = issubclass(cls, SensorComponent)
        own, turn = declared(cls, parameters), {"type": "Turn", "mechanism": "go"}
        content = {**PARTS, "behaviours": {"Do": {"action": turn if sensor else own}}}
        content |= {"sensors": {"read": own}} if sensor else {}
        robots = RunningConfiguration(validated(ConfigurationSpec, content, ""), self.host, cls.__name__)
        built = robots.sensors[0][1] if sensor else robots.actions[0][1]
        self.sources = tuple(built.sources)
        for source in self.sources:
            source.ask(1.0, EACH_ROW)
        return built

    def state(self) -> list[Any]:
        """Return copies of all that a sensor must not change."""
        buffer, told = self.host.buffers["gradients"], self.host.memory["told"].values
        answers = [answer for source in self.sources for answer in vars(source).values()]
        read = [answer.copy() for answer in answers if isinstance(answer, np.ndarray)]
        return [buffer.table.record.near[: len(buffer)].copy(), told.copy(), self.host.poses.own.copy(), *read]


def declared(cls: type, parameters: dict[str, Any]) -> dict[str, Any]:
    """Return how a document declares a component: its example, and the names of what it refers to."""
    example: dict[str, Any] = cls.example  # type: ignore[attr-defined]  # of sensors, actions and activators
    content = {"type": cls.__name__, **example, **parameters}
    for name, reference in references_of(cls).items():
        if content.get(name) is None and (
            name not in ("target", "mechanism") or name in content or "target" not in example
        ):
            content[name] = NAMES.get(reference.what) or OF_KIND.get(reference.mechanism, "light")
    return content


def check_sensor(cls: type[SensorComponent], **parameters: Any) -> None:  # noqa: ANN401  (those of the class)
    """Raise PluginError or DocumentError, one line, unless a registered sensor keeps its contract.

    A document can declare it. It reads a finite number, or a fact, for each of the rows that it is asked for, the same
    twice, and changes nothing. `parameters` come beside those of the class's `example`.
    """
    expect_registered(cls, SENSORS)
    around = Scene()
    sensor = around.build(cls, parameters)
    before = around.state()

    def read(rows: Ints) -> Any:  # noqa: ANN401  (an array, if all is well)
        with contract(sensor, "read", rows):
            readings = np.asarray(sensor.read(rows))
        good = readings.shape == rows.shape and readings.dtype in (np.float64, np.bool_) and np.isfinite(readings).all()
        got = f"{readings.dtype} {readings.shape} {readings.ravel()[:4]}"
        expect(good, cls, "read", f"finite numbers or facts {rows.shape}, got {got}")
        return readings

    first = read(EACH_ROW)
    expect_same([read(EACH_ROW)], [first], cls, "read", "the same if it is asked twice")
    expect_same([read(SOME)], [first[SOME]], cls, "read", "for some of the rows what all of them get")
    read(EACH_ROW[:0])
    expect_same(around.state(), before, cls, "read", "to change nothing")
    expect(sensor.kind == "number" or np.isin(first, (0, 1)).all(), cls, "read", f"0 or 1 of a fact, got {first}")
    expect(all(isinstance(one, Source) for one in sensor.sources), cls, "sources", "sources")


def check_action(cls: type[Action], **parameters: Any) -> None:  # noqa: ANN401  (those of the class)
    """Raise PluginError or DocumentError, one line, unless a registered action keeps its contract.

    A document can declare it. It commands finite vectors to the rows in which its behaviour runs, remembers and calls
    for those in which that has just started, and does nothing without rows. `parameters`: beside those of `example`.
    """
    expect_registered(cls, ACTIONS)
    around = Scene()
    action, commands, before = around.build(cls, parameters), Commands(4, 2), around.state()
    for rows, started in ((EACH_ROW[:0], EACH_ROW[:0]), (SOME, SOME[:1])):
        with contract(action, "", rows, started):
            action.act(1.0, rows, started, commands)
            action.steer(1.0, rows, commands)
            idle = not any(array[OTHERS].any() for array in commands.packed.record)
            expect(idle, cls, "", "to command no rows in which the behaviour does not run, got a command")
            told = around.host.memory["told"].values[[0, 1, 3]].any()
            expect(not told, cls, "", "to remember nothing for rows in which the behaviour does not start")
            action.leave(1.0, rows)
        expect(
            np.isfinite(commands.vectors).all(), cls, "act", f"finite vectors, got {commands.vectors[SOME].tolist()}"
        )
        if not len(rows):
            nothing = [[commands.commanded.any(), len(around.called)], *around.state()]
            expect_same(nothing, [[False, 0], *before], cls, "", "nothing to happen without rows")
    expect(around.called in ([], [[2]]), cls, "", f"one call of the host for row 2, got {around.called}")


def check_activator(cls: type[Activator], **parameters: Any) -> None:  # noqa: ANN401  (those of the class)
    """Raise PluginError or DocumentError, one line, unless a registered activator keeps its contract.

    A document can declare it. Its rule is one of ours, with two finite numbers and a sign. `parameters` come beside
    those of the class's `example`.
    """
    expect_registered(cls, ACTIVATORS)
    content = {**declared(cls, parameters), "low": 0.25, "high": 0.75}
    with contract(cls, "parameters"):
        built = validated(ActivatorSpec, content, cls.__name__).build()
        numbers, kind = np.asarray(built.parameters, dtype=np.float64), built.kind
    expect(kind in range(BOOLEAN_RULE, EQUAL_RULE + 1), cls, "kind", f"one of our rules, got {kind!r}")
    good = numbers.shape == (3,) and np.isfinite(numbers).all() and abs(built.direction) == 1.0
    expect(good, cls, "parameters", f"two finite numbers and the sign 1 or -1, got {numbers.tolist()}")
