"""The content of a coordinator: a configuration built from components, for the rows of a host."""

from __future__ import annotations

from typing import Any

import numpy as np

from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import Host
from selector.documents.errors import DocumentError
from selector.vocabulary.components import (
    ActionSpec,
    ActSpec,
    ChangedSpec,
    DecideSpec,
    DecideStateSpec,
    FartherThanSpec,
    GoalDistanceSpec,
    GoalPresentSpec,
    GoalReachedSpec,
    KnownSpec,
    MechanismSpec,
    MoveSpec,
    SensorSpec,
    SetStateSpec,
    SpreadSpec,
    StateIsSpec,
    TargetSpec,
    TurnSpec,
    ValueSpec,
    VectorLengthSpec,
    VectorPresentSpec,
)
from selector.vocabulary.mechanisms import checked_parameters, takes
from selforg import components as c
from selforg.arrays import Ints
from selforg.components.sensors import SensorComponent
from selforg.gradients.queries import Filter
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SpreadGradient
from selforg.mechanisms.base import Mechanism
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork


class Content:
    """One configuration at work in R rows; only the rows that hold it are ever asked for.

    Attributes:
        mechanisms: by name.
        robots: its own network with sensors and actions.
        remembers: whether anything but its network is to begin anew when a row takes it up.

    Raises:
        DocumentError: something that cannot be built; names the key.

    """

    def __init__(self, spec: ConfigurationSpec, host: Host, where: str, *, explained: bool = False) -> None:
        self.spec, self._host, self._where = spec, host, where
        host.check(spec, where)
        self._knowledge = c.Knowledge(host.rows, spec.knowledge)
        self._first_values: list[tuple[DecisionMechanism, str]] = []  # and the knowledge that they begin with
        self.mechanisms = {name: self._mechanism(name, declared) for name, declared in spec.mechanisms.items()}
        self._decisions_made = [m for m in self.mechanisms.values() if isinstance(m, DecisionMechanism)]
        self._movements: dict[str, c.MovementSource] = {}
        self._decisions: dict[str, c.DecisionSource] = {}
        self._targets = {name: self._target(declared) for name, declared in spec.targets.items()}
        sensors = {name: self._made(f"sensors.{name}", self._sensor, s) for name, s in spec.sensors.items()}
        actions = {
            name: [self._made(f"behaviours.{name}.action", self._action, action) for action in behaviour.action]
            for name, behaviour in spec.behaviours.items()
        }
        try:
            model = NetworkModel(
                spec.network_sensors(), spec.network_behaviours(), spec.network_goals(), spec.network_settings()
            )
        except ValueError as error:
            raise DocumentError(f"{where}: {error}") from error
        self.robots = c.OrganisedRobots(
            model, host.rows, sensors, actions, dim=host.poses.space.dim, explained=explained
        )
        self._kept = [source for source in self._movements.values() if source.hold > 0.0]
        self.remembers = bool(spec.knowledge or self._decisions_made or self._kept)
        self.forget(np.arange(host.rows))

    @property
    def network(self) -> BehaviourNetwork:
        """The network inside."""
        return self.robots.network

    def forget(self, rows: Ints) -> None:
        """Let `rows` (K,) know and have decided what they did at first, and ask all mechanisms anew."""
        self._knowledge.reset(rows)
        for source in self._kept:
            source.forget(rows)
        for mechanism in self._decisions_made:
            mechanism.reset(rows)
        for mechanism, name in self._first_values:
            assert self._host.knowledge is not None
            mechanism.values[rows] = self._host.knowledge.values(name)[rows]

    def _mechanism(self, name: str, declared: MechanismSpec) -> Mechanism:
        where = f"{self._where}: mechanisms.{name}"
        cls = MECHANISMS.find(declared.type)
        arguments = checked_parameters(cls, declared.parameters, f"{where}.parameters")
        known = arguments.get("value")
        if isinstance(known, str):
            if known not in self.spec.expects:
                expected = f"a number or a name under expects ({', '.join(self.spec.expects) or 'there is none'})"
                raise DocumentError(f"{where}.parameters.value: expected {expected}, got {known!r}")
            del arguments["value"]
        for given, value in (("directions", self._host.directions), ("generators", self._host.generators)):
            if takes(cls, given):
                arguments[given] = value
        factory: Any = cls
        try:
            made: Mechanism = factory(self._host.buffers[declared.buffer], **arguments)
        except ValueError as error:
            raise DocumentError(f"{where}.parameters: {error}") from error
        if isinstance(known, str) and isinstance(made, DecisionMechanism):
            self._first_values.append((made, known))
        return made

    def _target(self, declared: TargetSpec) -> c.GoalSource:
        look = Filter(declared.channels, declared.static, declared.moving, declared.view_distance)
        return c.GoalSource(self._host.buffers[declared.buffer], declared.rule, look)

    def _made(self, key: str, make: Any, spec: Any) -> Any:  # noqa: ANN401  (sensors and actions alike)
        try:
            return make(spec)
        except ValueError as error:
            raise DocumentError(f"{self._where}: {key}: {error}") from error

    def _sensor(self, spec: SensorSpec) -> SensorComponent:
        match spec:
            case VectorPresentSpec():
                return c.VectorPresent(self._movement(spec.mechanism), spec.longer_than)
            case VectorLengthSpec():
                return c.VectorLength(self._movement(spec.mechanism))
            case GoalPresentSpec():
                return c.GoalPresent(self._targets[spec.target])
            case GoalReachedSpec():
                return c.GoalReached(self._targets[spec.target])
            case GoalDistanceSpec():
                return c.GoalDistance(self._targets[spec.target], spec.unseen)
            case FartherThanSpec():
                return c.FartherThan(self._targets[spec.target], spec.distance)
            case ValueSpec():
                return c.Value(self._decision(spec.mechanism))
            case StateIsSpec():
                return c.StateIs(self._decision(spec.mechanism), spec.state)
            case ChangedSpec():
                return c.Changed(self._decision(spec.mechanism))
            case KnownSpec():
                return c.Known(self._knowing(spec.name), spec.name)

    def _action(self, spec: ActionSpec) -> c.Action:
        match spec:
            case MoveSpec():
                return c.Move(self._movement(spec.mechanism))
            case TurnSpec():
                return c.Turn(self._movement(spec.mechanism) if spec.mechanism else self._targets[str(spec.target)])
            case DecideSpec():
                return c.Decide(self._decision(spec.mechanism).mechanism)
            case DecideStateSpec():
                decision = self._decision(spec.mechanism).mechanism
                return c.DecideState(decision, self._knowing(spec.name), spec.name)
            case SpreadSpec():
                spreading = self.mechanisms[spec.mechanism]
                assert isinstance(spreading, SpreadGradient)  # the document was checked
                return c.Spread(spreading)
            case SetStateSpec():
                return c.SetState(self._knowing(spec.name), spec.name, spec.value)
            case ActSpec():
                return c.Act(self._host.calls[spec.call])

    def _movement(self, name: str) -> c.MovementSource:
        mechanism = self.mechanisms[name]
        assert isinstance(mechanism, MovementMechanism)  # the document was checked
        return self._movements.setdefault(name, c.MovementSource(mechanism, self.spec.mechanisms[name].hold))

    def _decision(self, name: str) -> c.DecisionSource:
        mechanism = self.mechanisms[name]
        assert isinstance(mechanism, DecisionMechanism)  # the document was checked
        return self._decisions.setdefault(name, c.DecisionSource(mechanism))

    def _knowing(self, name: str) -> c.Knowledge:
        if name in self.spec.expects:
            assert self._host.knowledge is not None  # the host was checked
            return self._host.knowledge
        return self._knowledge
