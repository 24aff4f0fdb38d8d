"""The network of a robot as its document declares it, the root and the networks inside behaviours; and its models.

The cleaning robot's document is `configs/robots/cleaning.yaml`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple, Self, TypeVar

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from selector.configurations.configuration import DECLARED_BY, ActingBehaviourSpec, ActingNetworkSpec
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Name
from selector.documents.plain import must_fit, must_know
from selector.vocabulary.components import ActionSpecs, SensorSpec
from selector.vocabulary.conditions import AnyCondition, BehaviourSpec, GoalSpec
from selector.vocabulary.settings import SettingsSpec
from selforg.arrays import Ints
from selforg.components import FactRule
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings, Sensor
from selforg.network.model.model import NetworkModel

Coordinators = Mapping[str, CoordinatorModel]
_Part = TypeVar("_Part", Sensor, Behaviour, Goal)


class HoldingBehaviourSpec(BehaviourSpec):
    """A behaviour that may hold a network, or a coordinator that holds the configuration chosen for its goal."""

    type: Literal["Behaviour", "Coordinator"] = "Behaviour"
    """Kind; preconditions and effects of a coordinator add to those of the configuration that it holds."""
    goal: Name | None = None
    """Of a coordinator: the self-organisation goal that it serves, which is also its name."""
    during: tuple[Name, ...] = ()
    """Of a coordinator whose options only steer: the behaviours while which they do; always unless given."""
    network: Name | None = None
    """Of a behaviour: name of the network inside, which decides while the behaviour runs."""

    @model_validator(mode="after")
    def _holds_one_thing(self) -> Self:
        if self.type == "Coordinator" and (self.goal is None or self.network is not None):
            raise ValueError("expected a coordinator with a goal and without a network")
        if self.type == "Behaviour" and (self.goal is not None or self.during):
            raise ValueError("expected a goal for a coordinator only (type: Coordinator)")
        return self

    def build_with(self, name: str, coordinators: Coordinators) -> Behaviour:
        """Return the behaviour; a coordinator has the options of its goal as alternatives."""
        plain = self.build(name)
        if self.goal is None:
            return plain
        where = f"behaviours.{name}.goal"
        must_know("coordinated goal", self.goal, sorted(coordinators), where)
        must_fit(self.goal == name, where, "the name of the coordinator", repr(self.goal))
        model = coordinators[self.goal]
        for option, configuration in zip(model.options, model.configurations, strict=True):
            steers = configuration.steers or not self.during
            must_fit(steers, f"behaviours.{name}.during", "options that only steer", option)
        return model.behaviour(plain)


InnerSensor = Annotated[
    Annotated[Literal["fact", "number"], Tag("kind")] | Annotated[SensorSpec, Tag("sensor")],
    Discriminator(lambda given: "kind" if isinstance(given, str) else "sensor"),
]
"""Kind of the sensor of that name, which something around the network feeds, or a sensor component."""


class NetworkSpec(Closed):
    """The root network, after names of conditions were replaced."""

    sensors: Annotated[dict[Name, InnerSensor], Field(min_length=1)]
    """What each sensor reads, which the host writes; or a sensor of a fact that robots tell each other."""
    conditions: dict[Name, AnyCondition] = Field(default_factory=dict)
    """Conditions by name."""
    behaviours: Annotated[dict[Name, HoldingBehaviourSpec], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, GoalSpec] = Field(default_factory=dict)
    """Goals by name."""
    settings: SettingsSpec = SettingsSpec()
    """How it decides."""

    @property
    def during(self) -> dict[str, tuple[str, ...]]:
        """The coordinators that steer only while certain behaviours run, and these behaviours."""
        return {name: spec.during for name, spec in self.behaviours.items() if spec.during}

    def sensors_of(self, facts: Collection[str]) -> dict[str, SensorSpec]:
        """Return the sensors of facts; ValueError for another component, or a fact that is not one of `facts`."""
        found = {name: spec for name, spec in self.sensors.items() if isinstance(spec, SensorSpec)}
        for name, spec in found.items():
            references = [(reference.what, fact) for _, reference, fact in spec.references()]
            if [what for what, _ in references] != ["fact"]:
                expected = "fact, number, or a sensor of a fact, as the outermost network has no other components"
                raise ValueError(f"sensors.{name}: expected {expected}, got {spec.type}")
            must_know("fact", references[0][1], sorted(facts), f"sensors.{name}.fact", DECLARED_BY["fact"])
        return found

    def build(self, coordinators: Coordinators, settings: NetworkSettings | None) -> NetworkModel:
        """Return the model, with `settings` if given; the sensors of coordinators come after those of the network."""
        for coordinator, names in self.during.items():
            for name in names:
                must_know("behaviour", name, sorted(self.behaviours), f"behaviours.{coordinator}.during")
        behaviours = [spec.build_with(name, coordinators) for name, spec in self.behaviours.items()]
        held = [spec.goal for spec in self.behaviours.values() if spec.goal is not None]
        sensors = [
            *(Sensor(name, one if isinstance(one, str) else one.component.kind) for name, one in self.sensors.items()),
            *(sensor for goal in held for sensor in coordinators[goal].sensors),
        ]
        goals = [spec.build(name) for name, spec in self.goals.items()]
        return NetworkModel(sensors, behaviours, goals, settings or self.settings.build())


class InnerBehaviourSpec(HoldingBehaviourSpec, ActingBehaviourSpec):
    """A behaviour of an inner network, which may act, hold another network, or both."""

    action: ActionSpecs = ()
    """What the behaviour does while it runs: one action or several."""


class InnerNetworkSpec(ActingNetworkSpec[InnerSensor, InnerBehaviourSpec]):
    """A network inside a behaviour, after names of conditions were replaced."""

    conditions: dict[Name, AnyCondition] = Field(default_factory=dict)
    """Conditions by name."""

    def network_sensors(self) -> tuple[Sensor, ...]:
        """Return all sensors of the behaviour network, also those that the network around reads."""
        kinds = {name: self.kind_of(one) if isinstance(one, SensorSpec) else one for name, one in self.sensors.items()}
        return tuple(Sensor(name, kind) for name, kind in kinds.items())

    def network_behaviours(self) -> tuple[Behaviour, ...]:
        """Return the behaviours of the behaviour network; none of them is a coordinator."""
        return tuple(spec.build_with(name, {}) for name, spec in self.behaviours.items())


class LeftOut(NamedTuple):
    """Behaviours, goals and facts of a network that robots of one document do not have, by name."""

    behaviours: tuple[str, ...]
    goals: tuple[str, ...]
    facts: tuple[str, ...]


@dataclass(frozen=True)
class RobotNetwork:
    """A network whose inner networks sense and act through components.

    Attributes:
        model: the network itself.
        inner: the network that each behaviour holds, by its name. Its sensors read the outer sensors of the same name,
            except those that are components of its own.
        during: goals of coordinators that steer only while certain behaviours run, and these behaviours.
        left_out: of a network for robots of several documents, what those of each do not have.
        spec: components of a network inside; None for the root, whose behaviours the host of the robot carries out.
        facts: of the root: what robots tell each other, by name.
        sensors: of the root: its sensors of facts, by name.

    Raises:
        ValueError: a holder that is not a behaviour, an inner sensor that the outer network lacks or knows as another
            kind.

    """

    model: NetworkModel
    inner: Mapping[str, RobotNetwork] = field(default_factory=dict)
    during: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    spec: InnerNetworkSpec | None = None
    left_out: tuple[LeftOut, ...] = ()
    facts: Mapping[str, FactRule] = field(default_factory=dict)
    sensors: Mapping[str, SensorSpec] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for holder, nested in self.inner.items():
            where = f"network in behaviour {holder!r}"
            must_know("behaviour", holder, self.model.behaviour_index, where)
            for sensor in nested.shared:
                outer = self.model.sensors[self.model.sensor(sensor.name, where)]
                if outer.kind != sensor.kind:
                    raise ValueError(f"{where}: sensor {sensor.name!r} is a {sensor.kind}, outside a {outer.kind}")

    @property
    def shared(self) -> tuple[Sensor, ...]:
        """The sensors of a network inside another one that it shares with that."""
        own = self.spec.own_sensors if self.spec else ()
        return tuple(sensor for sensor in self.model.sensors if sensor.name not in own)

    def shared_columns(self, outer: NetworkModel) -> tuple[Ints, Ints]:
        """Return the columns outside and inside (C,) of the sensors that it shares with the network around it."""
        outside, inside = ([m.sensor_index[sensor.name] for sensor in self.shared] for m in (outer, self.model))
        return np.array(outside, dtype=np.int64), np.array(inside, dtype=np.int64)

    def all_specs(self) -> Iterator[InnerNetworkSpec]:
        """Yield the documents of all networks inside, at any depth."""
        for held in self.inner.values():
            if held.spec is not None:
                yield held.spec
            yield from held.all_specs()


def merged_networks(networks: Mapping[str, RobotNetwork]) -> RobotNetwork:
    """Return one network for robots of several documents, by their names: each robot has the parts of its own.

    Raises:
        DocumentError: parts of one name that differ, or documents that coordinate different goals.

    """
    names, models = list(networks), [network.model for network in networks.values()]
    if len(models) == 1:
        return networks[names[0]]
    sensors = _all_of("sensor", names, [model.sensors for model in models])
    behaviours = _all_of("behaviour", names, [model.behaviours for model in models])
    goals = _all_of("goal", names, [model.goals for model in models])
    inner: dict[str, RobotNetwork] = {}
    during: dict[str, tuple[str, ...]] = {}
    shared: dict[str, dict[str, Any]] = {"fact": {}, "sensor": {}}
    for name, network in networks.items():
        given: dict[str, Mapping[str, Any]] = {"fact": network.facts, "sensor": network.sensors}
        for what, named in given.items():
            for own, one in named.items():
                if shared[what].setdefault(own, one) != one:
                    raise DocumentError(f"robots of {name}: {what} {own}: expected {_SAME}")
        for holder, held in network.inner.items():
            if inner.setdefault(holder, held).spec != held.spec:
                raise DocumentError(f"robots of {name}: behaviour {holder}: expected {_SAME}")
        for goal, behaved in network.during.items():
            if during.setdefault(goal, behaved) != behaved:
                raise DocumentError(f"robots of {name}: behaviour {goal}: during: expected {_SAME}")
    for name, network in networks.items():
        for behaviour in network.model.behaviours:
            if (behaviour.name in inner) != (behaviour.name in network.inner):
                raise DocumentError(f"robots of {name}: behaviour {behaviour.name}: expected {_SAME}")
    left_out = tuple(
        LeftOut(
            tuple(one.name for one in behaviours if one.name not in network.model.behaviour_index),
            tuple(one.name for one in goals if one.name not in network.model.goal_index),
            tuple(fact for fact in shared["fact"] if fact not in network.facts),
        )
        for network in networks.values()
    )
    model = NetworkModel(sensors, behaviours, goals, models[0].settings)
    facts, read = shared["fact"], shared["sensor"]
    return RobotNetwork(model, inner, during=during, left_out=left_out, facts=facts, sensors=read)


_SAME = "the same as in the documents of the mission's other robots, or another name"


def _all_of(what: str, names: Sequence[str], given: Sequence[Sequence[_Part]]) -> list[_Part]:
    """Return the sensors, behaviours or goals of all documents, each once."""
    found: dict[str, _Part] = {}
    for name, parts in zip(names, given, strict=True):
        for part in parts:
            if found.setdefault(part.name, part) != part:
                raise DocumentError(f"robots of {name}: {what} {part.name}: expected {_SAME}")
    return list(found.values())
