"""Networks inside networks: while a behaviour runs, the network that it holds decides what the robot does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from selforg.arrays import Ints
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import BuiltInPlanner, Planner


@dataclass(frozen=True)
class NestedModel:
    """A model, and the models that some of its behaviours hold.

    Attributes:
        model: the network itself.
        inner: by behaviour, the network it holds; its sensors are those of the same name outside.

    Raises:
        ValueError: a holder that is not a behaviour, an inner sensor that the outer network lacks or knows as another
            kind.

    """

    model: NetworkModel
    inner: Mapping[str, NestedModel] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for holder, nested in self.inner.items():
            where = f"network in behaviour {holder!r}"
            if holder not in self.model.behaviour_index:
                raise ValueError(f"{where}: no such behaviour (known: {', '.join(self.model.behaviour_index)})")
            for sensor in nested.model.sensors:
                outer = self.model.sensors[self.model.sensor(sensor.name, where)]
                if outer.kind != sensor.kind:
                    raise ValueError(f"{where}: sensor {sensor.name!r} is a {sensor.kind}, outside a {outer.kind}")


class NestedNetwork:
    """R rows of a `NestedModel`: fill `readings`, call `step`, then act on what `running` yields.

    An inner network decides in every step in which its holder runs, with a decision guaranteed; when the holder stops,
    whatever runs inside stops too, and activations stay as they are. With `planned`, every network has the built-in
    planner.
    """

    def __init__(self, nested: NestedModel, rows: int, planned: bool = False, explained: bool = False) -> None:
        planner: Planner | None = BuiltInPlanner(nested.model) if planned else None
        self.network = BehaviourNetwork(nested.model, rows, planner, explained)
        self.inner = {name: NestedNetwork(held, rows, planned, explained) for name, held in nested.inner.items()}
        self._columns = {
            name: np.array([nested.model.sensor_index[sensor.name] for sensor in held.model.sensors], dtype=np.int64)
            for name, held in nested.inner.items()
        }

    def reset(self, rows: Ints | None = None) -> None:
        """Return to the first step in all rows or `rows` (K,)."""
        self.network.reset(rows)
        for inner in self.inner.values():
            inner.reset(rows)

    def step(self, rows: Ints | None = None, guarantee: bool = False) -> None:
        """Decide once in all rows or `rows` (K,), from the outermost network inwards."""
        chosen = np.arange(self.network.rows) if rows is None else rows
        self.network.step(chosen, guarantee)
        for name, inner in self.inner.items():
            b = self.network.model.behaviour_index[name]
            runs = self.network.executing[chosen, b] == 1
            inner.halt(chosen[~runs | (self.network.started[chosen, b] == 1)])
            active = chosen[runs]
            if len(active):
                inner.network.readings[active] = self.network.readings[np.ix_(active, self._columns[name])]
                inner.step(active, guarantee=True)

    def halt(self, rows: Ints) -> None:
        """Stop all behaviours in `rows` (K,), inside too."""
        self.network.halt(rows)
        for inner in self.inner.values():
            inner.halt(rows)

    def running(self) -> Iterator[tuple[tuple[str, ...], Ints]]:
        """Yield (path of behaviours from the outside in, rows (K,)) for every behaviour that runs somewhere."""
        for b, behaviour in enumerate(self.network.model.behaviours):
            rows = np.flatnonzero(self.network.executing[:, b])
            if len(rows):
                yield (behaviour.name,), rows
        for name, inner in self.inner.items():
            for path, rows in inner.running():
                yield (name, *path), rows
