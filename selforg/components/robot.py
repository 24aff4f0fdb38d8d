"""Robots whose network senses and acts through components: as steps of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np

from selforg.arrays import READ, Floats, Ints
from selforg.commands import Commands
from selforg.components.actions import Action
from selforg.components.sensors import SensorComponent
from selforg.components.sources import Source
from selforg.network.network import BehaviourNetwork
from selforg.network.state import list_running
from selforg.program import ACT, SENSE, Rows, Step

Actions = Mapping[str, Action | Sequence[Action]]


class OrganisedRobots:
    """N robots with one network; a sensor may read through a component, a behaviour may act through components.

    Sources that only actions read are asked only for the rows that act.

    Args:
        network: of the robots.
        sensors: components by name; the host writes the other readings into `network.readings`.
        actions: one or several by behaviour.

    Attributes:
        sensors: each component with its column of the readings.
        actions: each component with the number of its behaviour.

    Raises:
        ValueError: the model lacks a sensor or behaviour, or a sensor has another kind than its component.

    """

    _shown: Annotated[Ints, "S", READ]
    _shown_in: Annotated[Floats, "N T", READ]

    def __init__(self, network: BehaviourNetwork, sensors: Mapping[str, SensorComponent], actions: Actions) -> None:
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
        self._shown, self._shown_in = np.arange(network.readings.shape[1]), network.readings

    def steps(self, sensing: Rows, acting: Rows, commands: Commands, guarantee: bool = True) -> list[Step]:
        """Return the steps that write the readings of some rows, decide and act in others, which may be the same.

        Movements go into `commands`. With `guarantee` some behaviour runs wherever one is able to.
        """
        network, state = self.network, self.network.state
        steps = [step for source in self._sensed for step in source.asking(SENSE, sensing)]
        for column, sensor in self.sensors:
            shown = self._shown_in, int(self._shown[column])
            steps.append(sensor.reading(sensing, network.readings, column, *shown))
        listing = Step(ACT, list_running, acting, list_running, (network.packed,), always=True)
        steps += [network.deciding(ACT, acting, guarantee), listing]
        for (number, action), sources in zip(self.actions, self._asked_late, strict=True):
            running, started = map(Rows, state.running[number], state.counts[number])
            steps += [step for source in sources for step in source.asking(ACT, running)]
            steps += action.steps(running, started, commands)
        return steps

    def show_in(self, readings: Floats, columns: Ints) -> None:
        """Write all readings also into `readings` (N, T), those of sensor k into column columns[k], from now on."""
        self._shown_in, self._shown = readings, columns


def _each_once(known: Sequence[Source], components: Sequence[SensorComponent | Action]) -> list[Source]:
    """Return the sources of all components, without those `known`, in order and each once."""
    found: list[Source] = []
    for component in components:
        each = (one for source in component.sources for one in (*source.parts, source))
        found += [one for one in each if not any(one is other for other in (*known, *found))]
    return found
