"""The network model: the parts of a network, checked once, with its packed form."""

from __future__ import annotations

from collections.abc import Sequence

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


def _index(what: str, names: Sequence[str]) -> dict[str, int]:
    index = {name: k for k, name in enumerate(names)}
    if len(index) < len(names):
        doubled = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"{what} names must be unique, got more than once: {', '.join(doubled)}")
    return index
