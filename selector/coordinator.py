"""The coordinator: a sub-network for one goal, whose content is the configuration of the option that serves it now.

To the network that holds it a coordinator shows the preconditions and effects of the configuration held now, so that
arbitration sees what it would see without the nesting. Different robots may hold different options at the same time;
the work grows with the number of options in use, not with robots.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from selector.configuration import ConfigurationSpec, LengthSpec, PresenceSpec
from selector.documents import DocumentError
from selector.knowledge import Knowledge
from selector.library import Library
from selforg.compiled import kernel
from selforg.mechanisms import MovementMechanism
from selforg.network.behaviours import Behaviour, Effect, Interface, Sensor
from selforg.network.conditions import Conjunction, Disjunction, Optional, Tree
from selforg.network.model import NetworkModel
from selforg.network.network import BehaviourNetwork

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
MakeMechanism = Callable[[str, Mapping[str, Any]], MovementMechanism]


class CoordinatorModel:
    """What can serve a goal: the options in the order of the knowledge, with their configurations.

    Attributes:
        goal: name of the self-organisation goal.
        options: (O,) names.
        sensors: of all configurations; those of one name are one sensor.

    Raises:
        DocumentError: a configuration that cannot be built, or two that mean different things by one name.

    """

    def __init__(self, goal: str, knowledge: Knowledge, library: Library) -> None:
        self.goal = goal
        self.options = tuple(option.name for option in knowledge.options(goal))
        self.configurations = tuple(library.of_option(option) for option in knowledge.options(goal))
        sensors: dict[str, Sensor] = {}
        for name, configuration in zip(self.options, self.configurations, strict=True):
            for sensor in configuration.network_sensors():
                if sensors.setdefault(sensor.name, sensor) != sensor:
                    other = sensors[sensor.name].kind
                    raise DocumentError(
                        f"goal {goal}: option {name}: sensor {sensor.name!r} is a {sensor.kind}, elsewhere a {other}"
                    )
        self.sensors = tuple(sensors.values())

    def behaviour(self, **settings: Any) -> Behaviour:  # noqa: ANN401  (keyword arguments of Behaviour)
        """Return the coordinator as a behaviour of the network that holds it."""
        shown = tuple(shown_interface(configuration) for configuration in self.configurations)
        return Behaviour(self.goal, alternatives=shown, **settings)


def shown_interface(configuration: ConfigurationSpec) -> Interface:
    """Return what a configuration shows: its behaviour's interface; of several, ready when one of them is."""
    faces = configuration.interfaces()
    if len(faces) == 1:
        return faces[0]
    optional = tuple(p for face in faces for p in face.preconditions if isinstance(p, Optional))
    mandatory = [tuple(p for p in face.preconditions if not isinstance(p, Optional)) for face in faces]
    trees: tuple[Tree, ...] = ()
    if all(mandatory):
        trees = (Disjunction(*(Conjunction(*parts) for parts in mandatory)),)
    effects = {(effect.sensor, effect.change): effect for face in faces for effect in face.effects}
    return Interface((*trees, *optional), tuple(Effect(sensor, change) for sensor, change in effects))


@dataclass
class Content:
    """One option at work: its mechanisms and its own network, for all rows (only those that hold it are computed)."""

    configuration: ConfigurationSpec
    mechanisms: dict[str, MovementMechanism]
    network: BehaviourNetwork
    columns: Ints  # column in the parent's readings of each sensor
    vectors: dict[str, Floats]  # mechanism -> (R, D) movement of the rows that hold the option


class Coordinator:
    """R rows that each hold one option of a `CoordinatorModel`, inside the network `parent`."""

    def __init__(self, model: CoordinatorModel, parent: BehaviourNetwork, make: MakeMechanism, dim: int = 2) -> None:
        self.model = model
        self.parent = parent
        self.index = parent.model.behaviour_index[model.goal]
        self.held: Ints = np.zeros(parent.rows, dtype=np.int64)
        self.contents = [self._content(configuration, make, dim) for configuration in model.configurations]
        self._columns = np.array([parent.model.sensor_index[sensor.name] for sensor in model.sensors])
        self._in_use: list[tuple[Content, Ints]] = []
        self.reset(np.arange(parent.rows))

    def _content(self, configuration: ConfigurationSpec, make: MakeMechanism, dim: int) -> Content:
        sensors, rows = configuration.network_sensors(), self.parent.rows
        inner = NetworkModel(sensors, configuration.network_behaviours(), configuration.network_goals())
        return Content(
            configuration,
            {name: make(spec.type, spec.parameters) for name, spec in configuration.mechanisms.items()},
            BehaviourNetwork(inner, rows),
            np.array([self.parent.model.sensor_index[sensor.name] for sensor in sensors], dtype=np.int64),
            {name: np.zeros((rows, dim)) for name in configuration.mechanisms},
        )

    def reset(self, rows: Ints) -> None:
        """Begin anew in `rows` (K,), holding the options they hold."""
        for content in self.contents:
            content.network.reset(rows)
        self.parent.hold(rows, self.index, self.held[rows])
        self._group()

    def hold(self, rows: Ints, options: Ints) -> None:
        """Let `rows` (K,) hold `options` (K,); the rest of each robot goes on undisturbed."""
        changed = self.held[rows] != options
        if not changed.any():
            return
        rows, options = rows[changed], options[changed]
        if options.min() < 0 or options.max() >= len(self.contents):
            raise ValueError(f"goal {self.model.goal}: expected options 0..{len(self.contents) - 1}, got {options}")
        self.held[rows] = options
        self.parent.hold(rows, self.index, options)
        self.parent.readings[np.ix_(rows, self._columns)] = 0.0
        for content in self.contents:
            content.network.halt(rows)
        self._group()

    def _group(self) -> None:
        groups = [(content, np.flatnonzero(self.held == k)) for k, content in enumerate(self.contents)]
        self._in_use = [(content, rows) for content, rows in groups if len(rows)]

    def sense(self, now: float) -> None:
        """Ask the mechanisms in use at `now` [s] and write their sensors into the parent's readings."""
        for content, rows in self._in_use:
            for name, mechanism in content.mechanisms.items():
                vectors, active = mechanism.move(now, rows)
                content.vectors[name][rows] = vectors
                for column, sensor in zip(content.columns, content.configuration.sensors.values(), strict=True):
                    if sensor.mechanism != name:
                        continue
                    presence = isinstance(sensor, PresenceSpec)
                    threshold = sensor.longer_than if isinstance(sensor, PresenceSpec) else 0.0
                    assert presence or isinstance(sensor, LengthSpec)
                    read_vector(rows, vectors, active, presence, threshold, self.parent.readings, column)

    def act(self, vectors: Floats, commanded: Flags) -> None:
        """Run the content where the parent runs the coordinator; its movement goes into `vectors` (R, D)."""
        running = self.parent.executing[:, self.index] == 1
        if not running.any():
            return
        started = np.flatnonzero(self.parent.started[:, self.index])
        for content, rows in self._in_use:
            acting = rows[running[rows]]
            if not len(acting):
                continue
            network = content.network
            network.halt(started)
            network.readings[acting] = self.parent.readings[np.ix_(acting, content.columns)]
            network.step(acting, guarantee=True)
            for b, behaviour in enumerate(content.configuration.behaviours.values()):
                moving = acting[network.executing[acting, b] == 1]
                vectors[moving] = content.vectors[behaviour.action.mechanism][moving]
                commanded[moving] = True


@kernel
def read_vector(
    rows: Ints, vector: Floats, active: Flags, presence: bool, threshold: float, readings: Floats, column: int
) -> None:
    """Write presence (1 or 0) or length [m] of the movement `vector` (K, D) of `rows` (K,) into a column."""
    for k in range(rows.shape[0]):
        length = 0.0
        if active[k]:
            for axis in range(vector.shape[1]):
                length += vector[k, axis] * vector[k, axis]
            length = np.sqrt(length)
        if presence:
            length = 1.0 if length > threshold else 0.0
        readings[rows[k], column] = length
