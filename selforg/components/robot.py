"""Robots whose network senses and acts through components, with a method for a tick and one for each part of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np

from selforg.arrays import READ, Floats, Ints
from selforg.commands import Commands
from selforg.compiler.decorators import lean_kernel
from selforg.components.actions import Action
from selforg.components.sensors import SensorComponent, VectorReadings, VectorSensor
from selforg.components.sources import MovementSource, Source
from selforg.network.network import BehaviourNetwork

Actions = Mapping[str, Action | Sequence[Action]]


class OrganisedRobots:
    """N robots with one network; a sensor may read through a component, a behaviour may act through components.

    Sources that only actions read are asked only for the rows that act.

    Args:
        network: of the robots.
        sensors: components by name; the host writes the other readings into `network.readings`.
        actions: one or several by behaviour.
        dim: dimensions of the space, D.

    Attributes:
        sensors: each component with its column of the readings.
        actions: each component with the number of its behaviour.

    Raises:
        ValueError: the model lacks a sensor or behaviour, or a sensor has another kind than its component.

    """

    _all: Annotated[Ints, "N", READ]
    _shown: Annotated[tuple[Floats, Ints, Ints] | None, READ]

    def __init__(
        self, network: BehaviourNetwork, sensors: Mapping[str, SensorComponent], actions: Actions, dim: int = 2
    ) -> None:
        self.network, model = network, network.model
        self.sensors = [(model.sensor(name, "sensor component"), component) for name, component in sensors.items()]
        for column, component in self.sensors:
            sensor = model.sensors[column]
            if sensor.kind != component.kind:
                what = f"{type(component).__name__} reads a {component.kind}"
                raise ValueError(f"sensor {sensor.name!r} is a {sensor.kind}, but {what}")
        unknown = [name for name in actions if name not in model.behaviour_index]
        if unknown:
            raise ValueError(f"action: unknown behaviour {unknown[0]!r} (known: {', '.join(model.behaviour_index)})")
        each = [(name, [act] if isinstance(act, Action) else list(act)) for name, act in actions.items()]
        self.actions = [(model.behaviour_index[name], action) for name, all_of in each for action in all_of]
        self._sensed = _each_once([], [component for _, component in self.sensors])
        self._asked_late = [_each_once(self._sensed, [action]) for _, action in self.actions]
        self._vector_readings = _by_source(self.sensors, self.network.readings)
        self._others = [(column, one) for column, one in self.sensors if not isinstance(one, VectorSensor)]
        self._shown = None
        self._acted: list[tuple[Action, Ints]] = []
        self._all, self._dim = np.arange(network.rows), dim

    def tick(self, now: float, rows: Ints | None = None) -> Commands:
        """Sense, decide and act at `now` [s] in `rows` (K,) or in all rows; return the commands of all N rows."""
        chosen = self._all if rows is None else rows
        self.sense(now, chosen)
        self.network.step(chosen)
        commands = Commands(self.network.rows, self._dim)
        self.act(now, chosen, commands)
        self.steer(now, commands)
        self.leave(now)
        return commands

    def sense(self, now: float, rows: Ints) -> None:
        """Write the readings of `rows` (K,) at `now` [s]."""
        if not len(rows):
            return
        for source in self._sensed:
            source.ask(now, rows)
        for vectors in self._vector_readings:
            vectors.write(rows)
        readings = self.network.readings
        for column, component in self._others:
            readings[rows, column] = component.read(rows)
        if self._shown is not None:
            show(rows, readings, *self._shown)

    def show_in(self, readings: Floats, columns: Ints) -> None:
        """Write all later readings also into `readings` (N, T), those of sensor k into column columns[k]."""
        for vectors in self._vector_readings:
            vectors.show_in(readings, columns[vectors.columns])
        others: Ints = np.array([column for column, _ in self._others], dtype=np.int64)
        self._shown = (readings, others, columns[others]) if len(others) else None

    def act(self, now: float, rows: Ints, commands: Commands) -> None:
        """Run the actions of the behaviours that run in `rows` (K,); movements go into `commands`."""
        self._acted = []
        for (b, action), sources in zip(self.actions, self._asked_late, strict=True):
            acting, started = self.network.running(b, rows)
            if not len(acting):
                continue
            for source in sources:
                source.ask(now, acting)
            action.act(now, acting, started, commands)
            self._acted.append((action, acting))

    def steer(self, now: float, commands: Commands) -> None:
        """Change `commands` at `now` [s] in the rows that acted; call it when all behaviours have acted."""
        for action, acting in self._acted:
            action.steer(now, acting, commands)

    def leave(self, now: float) -> None:
        """Spread and deposit gradients at `now` [s] in the rows that acted; call it when all movements are known."""
        for action, acting in self._acted:
            action.leave(now, acting)
        self._acted = []


def _each_once(known: Sequence[Source], components: Sequence[SensorComponent | Action]) -> list[Source]:
    """Return the sources of all components, without those `known`, in order and each once."""
    found: list[Source] = []
    for component in components:
        each = (one for source in component.sources for one in (*source.parts, source))
        found += [one for one in each if not any(one is other for other in (*known, *found))]
    return found


def _by_source(sensors: Sequence[tuple[int, SensorComponent]], readings: Floats) -> list[VectorReadings]:
    """Return writers for the vector sensors among `sensors`, one for each source."""
    found: dict[int, tuple[MovementSource, dict[int, float]]] = {}
    for column, component in sensors:
        if isinstance(component, VectorSensor):
            _, those = found.setdefault(id(component.source), (component.source, {}))
            those[column] = component.longest_absent
    return [VectorReadings(source, those, readings) for source, those in found.values()]


@lean_kernel
def show(rows: Ints, inner: Floats, outer: Floats, columns: Ints, outer_columns: Ints) -> None:
    """Copy `columns` (C,) of the readings `inner` (N, S) of `rows` (K,) into columns of `outer` (N, T)."""
    for row in rows:
        for k in range(columns.shape[0]):
            outer[row, outer_columns[k]] = inner[row, columns[k]]
