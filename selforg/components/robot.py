"""Robots whose network senses and acts through components: one call a tick."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from selforg.arrays import Ints
from selforg.components.actions import Action, Commands
from selforg.components.sensors import SensorComponent
from selforg.components.sources import Source
from selforg.network.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning import Planner


class OrganisedRobots:
    """N robots with one model; each sensor reads through a component, each behaviour acts through one or not at all.

    Readings of sensors without a component are the host's: it writes them into `network.readings` before each tick.

    Raises:
        ValueError: a component for a sensor or behaviour that the model lacks, or of another kind than its sensor.

    """

    def __init__(
        self,
        model: NetworkModel,
        rows: int,
        sensors: Mapping[str, SensorComponent],
        actions: Mapping[str, Action],
        planner: Planner | None = None,
        dim: int = 2,
    ) -> None:
        self.network = BehaviourNetwork(model, rows, planner)
        self._sensors = [(model.sensor(name, "sensor component"), component) for name, component in sensors.items()]
        for column, component in self._sensors:
            sensor = model.sensors[column]
            if sensor.kind != component.kind:
                what = f"{type(component).__name__} reads a {component.kind}"
                raise ValueError(f"sensor {sensor.name!r} is a {sensor.kind}, but {what}")
        unknown = [name for name in actions if name not in model.behaviour_index]
        if unknown:
            raise ValueError(f"action: unknown behaviour {unknown[0]!r} (known: {', '.join(model.behaviour_index)})")
        self._actions = [(model.behaviour_index[name], action) for name, action in actions.items()]
        self._sources = _each_once([*sensors.values(), *actions.values()])
        self._all, self._dim = np.arange(rows), dim

    def tick(self, now: float, rows: Ints | None = None) -> Commands:
        """Let `rows` (K,) or all sense, decide and act at `now` [s]; returns what all N rows are told."""
        chosen = self._all if rows is None else rows
        for source in self._sources:
            source.ask(now, chosen)
        for column, component in self._sensors:
            self.network.readings[chosen, column] = component.read(chosen)
        self.network.step(chosen)
        commands = Commands.none(self.network.rows, self._dim)
        running = [(action, chosen[self.network.executing[chosen, b] == 1], b) for b, action in self._actions]
        for action, acting, b in running:
            action.act(now, acting, acting[self.network.started[acting, b] == 1], commands)
        for action, acting, _ in running:
            action.leave(now, acting)
        return commands


def _each_once(components: list[SensorComponent | Action]) -> list[Source]:
    """Return the sources of all components, in order, no source twice."""
    found: list[Source] = []
    for component in components:
        found += [source for source in component.sources if not any(source is known for known in found)]
    return found
