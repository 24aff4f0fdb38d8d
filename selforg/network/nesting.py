"""Networks inside networks: which behaviour holds which, the sensors that they share, and the rows that are inside."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from selforg.arrays import Ints
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork


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
