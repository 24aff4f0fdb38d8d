"""Networks inside networks: while a behaviour runs, the network that it holds decides what the robot does."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
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
        inner: by behaviour, the network it holds; its sensors are those of the same name outside, but for its own.
        own: names of sensors that the network has for itself, though it lies in another.

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
        self._columns = {name: shared_columns(nested.model, held) for name, held in nested.inner.items()}

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
            active = rows_inside(self.network, b, chosen, inner.halt)
            if len(active):
                outside, inside = self._columns[name]
                inner.network.readings[np.ix_(active, inside)] = self.network.readings[np.ix_(active, outside)]
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


def rows_inside(outer: BehaviourNetwork, behaviour: int, rows: Ints, halt: Callable[[Ints], None]) -> Ints:
    """Return those of `rows` (K,) in which a behaviour runs that holds a network.

    `halt` is called with the rows in which all that runs inside has to stop: the behaviour does not run, or has just
    been started.
    """
    runs = outer.executing[rows, behaviour] == 1
    halt(rows[~runs | (outer.started[rows, behaviour] == 1)])
    inside: Ints = rows[runs]
    return inside


def shared_columns(outer: NetworkModel, held: NestedModel) -> tuple[Ints, Ints]:
    """Return the columns outside and inside (C,) of the sensors that a network inside shares with the one around."""
    names = [sensor.name for sensor in held.model.sensors if sensor.name not in held.own]
    outside, inside = ([model.sensor_index[name] for name in names] for model in (outer, held.model))
    return np.array(outside, dtype=np.int64), np.array(inside, dtype=np.int64)
