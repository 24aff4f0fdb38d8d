"""Configurations at work: networks with mechanisms, sensors and actions for the rows of a host."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np

from selector.configurations.configuration import ActingNetworkSpec
from selector.configurations.host import Host
from selector.documents.errors import DocumentError, within
from selector.documents.plain import must_fit
from selector.vocabulary.components import ComponentSpec, MechanismSpec, TargetSpec
from selector.vocabulary.constructors import Reference, checked_parameters
from selforg.arrays import READ, Ints
from selforg.components import DecisionSource, GoalSource, MovementSource, OrganisedRobots, Remembered, RobotMemory
from selforg.gradients.queries import Filter
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SteeringMechanism
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.weighted_sum import MovementWeights
from selforg.network.network import BehaviourNetwork
from selforg.parameters import parameters_of
from selforg.registry import unknown

MOVEMENT = Reference("mechanism", MovementSource, MovementMechanism)


class RunningConfiguration(OrganisedRobots):
    """One configuration at work in R rows; callers name the rows that hold it.

    Attributes:
        mechanisms: by name.
        remembers: whether `forget` has anything to reset in a row that begins to hold the configuration.

    Raises:
        DocumentError: a component cannot be built; the text names its key.

    """

    spec: Annotated[ActingNetworkSpec[Any, Any], READ]

    def __init__(self, spec: ActingNetworkSpec[Any, Any], host: Host, where: str, *, explained: bool = False) -> None:
        self.spec, self._host, self._where = spec, host, where
        host.check(spec, where)
        self._memory = RobotMemory(host.rows, spec.knowledge)
        self._first_values: list[tuple[DecisionMechanism, Remembered]] = []  # with the source of their first values
        self._movements: dict[str, MovementSource] = {}
        self.mechanisms: dict[str, Mechanism] = {}
        for name, mechanism in spec.mechanisms.items():
            self.mechanisms[name] = self._mechanism(name, mechanism)
        self._decisions_made = [m for m in self.mechanisms.values() if isinstance(m, DecisionMechanism)]
        self._decisions: dict[str, DecisionSource] = {}
        self._targets = {name: self._target(declared) for name, declared in spec.targets.items()}
        sensors = {name: self._component(f"sensors.{name}", sensor) for name, sensor in spec.own_sensors.items()}
        actions = {
            name: [self._component(f"behaviours.{name}.action", action) for action in behaviour.action]
            for name, behaviour in spec.behaviours.items()
        }
        with within(where):
            network = BehaviourNetwork(spec.network_model(), host.rows, explained=explained)
        super().__init__(network, sensors, actions)
        self._steering = [m for m in self.mechanisms.values() if isinstance(m, SteeringMechanism)]
        self._kept = [source for source in self._movements.values() if source.hold > 0.0]
        self.remembers = bool(spec.knowledge or self._decisions_made or self._kept or self._steering)
        self.forget(np.arange(host.rows))

    @property
    def view_distance(self) -> float:
        """The longest view distance of a mechanism that moves the robot [m]; 0 without one."""
        seen = [m.view_distance for m in self.mechanisms.values() if isinstance(m, MovementMechanism)]
        return float(max(seen, default=0.0))

    def reset(self, rows: Ints) -> None:
        """Clear network and memory of `rows` (K,)."""
        self.network.reset(rows)
        self.forget(rows)

    def forget(self, rows: Ints) -> None:
        """Reset memory, decisions and steering of `rows` (K,) to their first values, and drop kept movements."""
        self._memory.reset(rows)
        for source in self._kept:
            source.forget(rows)
        for mechanism in self._decisions_made:
            mechanism.reset(rows)
        for steering in self._steering:
            steering.reset(rows)
        for mechanism, remembered in self._first_values:
            mechanism.values[rows] = remembered.values[rows]

    def _mechanism(self, name: str, declared: MechanismSpec) -> Mechanism:
        where = f"{self._where}: mechanisms.{name}"
        cls = MECHANISMS.find(declared.type)
        arguments = checked_parameters(cls, declared.parameters, f"{where}.parameters")
        known = arguments.get("value")
        if isinstance(known, str):
            expects = ", ".join(self.spec.expects) or "there is none"
            fits = known in self.spec.expects
            must_fit(fits, f"{where}.parameters.value", f"a number or a name under expects ({expects})", repr(known))
            del arguments["value"]
        for name in (part for part, one in parameters_of(cls).items() if one.annotation == MovementWeights):
            arguments[name] = {
                self._summand(one, f"{where}.parameters.{name}"): arguments[name][one] for one in arguments[name]
            }
        for given, value in (("directions", self._host.directions), ("generators", self._host.generators)):
            if given in parameters_of(cls):
                arguments[given] = value
        with within(f"{where}.parameters"):
            made = cls(self._host.buffers[declared.buffer], **arguments)
        if isinstance(known, str) and isinstance(made, DecisionMechanism):
            self._first_values.append((made, self._remembered(known)))
        return made

    def _summand(self, name: str, where: str) -> MovementSource:
        """Return the source of a mechanism in a sum; DocumentError unless it is a movement, and declared above."""
        if not isinstance(self.mechanisms.get(name), MovementMechanism):
            known = [one for one, mechanism in self.mechanisms.items() if isinstance(mechanism, MovementMechanism)]
            raise DocumentError(f"{where}: {unknown('movement mechanism above it', name, known)}")
        source: Any = self._referred(MOVEMENT, name)
        return source  # type: ignore[no-any-return]

    def _target(self, declared: TargetSpec) -> GoalSource:
        look = Filter(declared.channels, declared.static, declared.moving, declared.view_distance)
        return GoalSource(self._host.buffers[declared.buffer], declared.rule, look)

    def _component(self, key: str, spec: ComponentSpec[Any]) -> Any:  # noqa: ANN401  (sensors and actions alike)
        arguments = spec.given
        for parameter, reference, name in spec.references():
            arguments[parameter] = self._referred(reference, name)
        cls: Any = spec.component
        if "surroundings" in parameters_of(cls):
            arguments["surroundings"] = self._host.surroundings
        with within(f"{self._where}: {key}"):
            return cls(**arguments)

    def _referred(self, reference: Reference, name: str) -> object:
        """Return what a name refers to, of the type that the component takes."""
        mechanism = self.mechanisms.get(name)
        if reference.annotation is MovementSource and isinstance(mechanism, MovementMechanism):
            declared = self.spec.mechanisms[name]
            times = declared.hold, declared.hold_exponent, declared.longest_hold
            return self._movements.setdefault(name, MovementSource(mechanism, *times))
        if reference.annotation is DecisionSource and isinstance(mechanism, DecisionMechanism):
            return self._decisions.setdefault(name, DecisionSource(mechanism))
        found: dict[str, Mapping[str, Any]] = {
            "mechanism": self.mechanisms,
            "target": self._targets,
            "call": self._host.calls,
            "fact": self._host.facts,
        }
        return found[reference.what][name] if reference.what in found else self._remembered(name)

    def _remembered(self, name: str) -> Remembered:
        return (self._host.memory if name in self.spec.expects else self._memory)[name]
