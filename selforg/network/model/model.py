"""The network model: the parts of a network, checked once, with its packed form; and models inside models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from selforg.arrays import Ints
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings, Sensor, column_of
from selforg.network.model.packer import Packer


class NetworkModel:
    """The declared network and its packed form.

    Attributes:
        packed: the record that compiled code reads, see `PackedModel`.
        precondition_roots: for each behaviour the nodes of its preconditions, of optional ones and alternatives too.

    Raises:
        ValueError: for a doubled name, an unknown sensor, or an activator that does not fit the sensor's kind.

    Warns:
        UserWarning: for an effect larger than 1, by which the default algorithm turns inhibition into support (Q17).

    """

    def __init__(
        self,
        sensors: Sequence[Sensor],
        behaviours: Sequence[Behaviour],
        goals: Sequence[Goal],
        settings: NetworkSettings | None = None,
    ) -> None:
        self.sensors = tuple(sensors)
        self.behaviours = tuple(behaviours)
        self.goals = tuple(goals)
        self.settings = settings or NetworkSettings()
        self.sensor_index = _index("sensor", [s.name for s in self.sensors])
        self.behaviour_index = _index("behaviour", [b.name for b in self.behaviours])
        self.goal_index = _index("goal", [g.name for g in self.goals])
        packer = Packer(self.sensors, self.behaviours, self.goals, self.settings)
        self.packed = packer.pack()
        self.precondition_roots = tuple(map(tuple, packer.roots))

    def sensor(self, name: str, where: str) -> int:
        """Return the index of the sensor `name`, to which `where` refers; ValueError for an unknown one."""
        return column_of(self.sensor_index, name, where)


@dataclass(frozen=True)
class NestedModel:
    """A model, and the models that some of its behaviours hold.

    Attributes:
        model: the network itself.
        inner: the network that each behaviour holds, by its name. Its sensors read the outer sensors of the same name,
            except those in its `own`.
        own: names of sensors that a network inside another one does not share with it.

    Raises:
        ValueError: a holder that is not a behaviour, an inner sensor that the outer network lacks or knows as another
            kind.

    """

    model: NetworkModel
    inner: Mapping[str, NestedModel] = field(default_factory=dict)
    own: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        for holder, nested in self.inner.items():
            where = f"network in behaviour {holder!r}"
            if holder not in self.model.behaviour_index:
                raise ValueError(f"{where}: no such behaviour (known: {', '.join(self.model.behaviour_index)})")
            for sensor in (one for one in nested.model.sensors if one.name not in nested.own):
                outer = self.model.sensors[self.model.sensor(sensor.name, where)]
                if outer.kind != sensor.kind:
                    raise ValueError(f"{where}: sensor {sensor.name!r} is a {sensor.kind}, outside a {outer.kind}")

    def shared_columns(self, outer: NetworkModel) -> tuple[Ints, Ints]:
        """Return the columns outside and inside (C,) of the sensors that it shares with the network around it."""
        names = [sensor.name for sensor in self.model.sensors if sensor.name not in self.own]
        outside, inside = ([model.sensor_index[name] for name in names] for model in (outer, self.model))
        return np.array(outside, dtype=np.int64), np.array(inside, dtype=np.int64)


def _index(what: str, names: Sequence[str]) -> dict[str, int]:
    index = {name: k for k, name in enumerate(names)}
    if len(index) < len(names):
        doubled = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"{what} names must be unique, got more than once: {', '.join(doubled)}")
    return index
