"""A mechanism configuration: the components that realise one way to serve a goal, and the parameters of an option.

Mechanisms, targets, sensors, behaviours and goals have names, by which they refer to each other; the files in
`configs/mechanisms` are examples. Under `parameters` stand the values that an option may lay over; `$name` in place
of a value stands for the parameter of that name.
"""

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from selector.documents.fields import Closed, Flag, Name, Number
from selector.vocabulary.activators import BooleanSpec
from selector.vocabulary.components import (
    ActionSpecs,
    ActSpec,
    DecideStateSpec,
    KnownSpec,
    MechanismSpec,
    OverDecision,
    OverMovement,
    OverTarget,
    SensorSpec,
    SetStateSpec,
    SpreadSpec,
    TargetSpec,
    TurnSpec,
)
from selector.vocabulary.conditions import AnyCondition, BehaviourSpec, GoalSpec, plain_conditions
from selector.vocabulary.settings import SettingsSpec
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SpreadGradient
from selforg.mechanisms.base import Mechanism
from selforg.network.model.behaviours import Behaviour, Goal, Interface, NetworkSettings, Sensor, SensorKind
from selforg.registry import unknown

FACTS = ("VectorPresent", "GoalPresent", "GoalReached", "FartherThan", "StateIs", "Changed")
"""Sensors that read facts; what is known may be either, the others read numbers."""


class ActingBehaviourSpec(BehaviourSpec):
    """A behaviour of a configuration, with what it does."""

    action: ActionSpecs
    """What the behaviour does while it runs: one action, or several that happen together."""


class ConfigurationSpec(Closed):
    """The components of one configuration, with every reference resolved."""

    description: str = ""
    """What it does and where it comes from."""
    mechanisms: dict[Name, MechanismSpec] = Field(default_factory=dict)
    """Mechanisms by name."""
    targets: dict[Name, TargetSpec] = Field(default_factory=dict)
    """Gradients that queries choose, by name."""
    knowledge: dict[Name, Flag | Number] = Field(default_factory=dict)
    """What the robot knows because of this configuration, with the first value: a fact or a number."""
    expects: dict[Name, Literal["fact", "number"]] = Field(default_factory=dict)
    """What the robot must know whatever it holds: names in the host's knowledge."""
    sensors: dict[Name, SensorSpec] = Field(default_factory=dict)
    """Sensors by name."""
    behaviours: Annotated[dict[Name, ActingBehaviourSpec], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, GoalSpec] = Field(default_factory=dict)
    """Goals inside the configuration by name."""
    settings: SettingsSpec = SettingsSpec()
    """How its network decides."""

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        self._check_kept_apart()
        for name, mechanism in self.mechanisms.items():
            if mechanism.type not in MECHANISMS:
                raise ValueError(f"mechanisms.{name}.type: {unknown('mechanism', mechanism.type, MECHANISMS.names())}")
        for name, sensor in self.sensors.items():
            self._check_component(sensor, f"sensors.{name}")
        for name, behaviour in self.behaviours.items():
            where = f"behaviours.{name}"
            for index, action in enumerate(behaviour.action):
                self._check_component(action, f"{where}.action.{index}" if index else f"{where}.action")
            self._check_conditions(behaviour.preconditions, f"{where}.preconditions")
            for effect in behaviour.effects:
                _must_know("sensor", effect.sensor, self.sensors, f"{where}.effects")
        for name, goal in self.goals.items():
            self._check_conditions(goal.conditions, f"goals.{name}.conditions")
        return self

    def _check_kept_apart(self) -> None:
        for name in self.knowledge.keys() & self.expects.keys():
            raise ValueError(f"expects.{name}: stands under knowledge too; expected one of them")

    def _check_component(self, spec: Closed, where: str) -> None:
        """Raise ValueError for a name that the component refers to and that there is not, or not of its kind."""
        match spec:
            case OverTarget(target=target) | TurnSpec(target=str(target)):
                _must_know("target", target, self.targets, f"{where}.target")
            case OverMovement(mechanism=name) | TurnSpec(mechanism=str(name)):
                self._check_mechanism(name, MovementMechanism, "a movement mechanism", where)
            case OverDecision(mechanism=name):
                self._check_mechanism(name, DecisionMechanism, "a decision mechanism", where)
            case SpreadSpec(mechanism=name):
                self._check_mechanism(name, SpreadGradient, "a SpreadGradient", where)
        if isinstance(spec, KnownSpec | SetStateSpec | DecideStateSpec):
            _must_know("knowledge", spec.name, {**self.knowledge, **self.expects}, f"{where}.name")

    def _check_mechanism(self, name: str, kind: type[Mechanism], expected: str, where: str) -> None:
        _must_know("mechanism", name, self.mechanisms, f"{where}.mechanism")
        given = self.mechanisms[name].type
        if not issubclass(MECHANISMS.find(given), kind):
            raise ValueError(f"{where}.mechanism: expected {expected}, got {name!r}, which is a {given}")

    def _check_conditions(self, trees: Iterable[AnyCondition], where: str) -> None:
        for spec in (plain for tree in trees for plain in plain_conditions(tree)):
            _must_know("sensor", spec.sensor, self.sensors, where)
            kind = self.kind_of(self.sensors[spec.sensor])
            if (kind == "fact") is not isinstance(spec.activator, BooleanSpec):
                expected = "a Boolean activator on a fact, any other on a number"
                given = f"{spec.activator.type} on the {kind} {spec.sensor!r}"
                raise ValueError(f"{where}: expected {expected}, got {given}")

    @property
    def calls(self) -> tuple[str, ...]:
        """Names of the host's functions that the behaviours call."""
        actions = (action for behaviour in self.behaviours.values() for action in behaviour.action)
        return tuple(action.call for action in actions if isinstance(action, ActSpec))

    @property
    def buffers(self) -> tuple[str, ...]:
        """Names of the host's buffers that it looks into or spreads to, sorted."""
        users: tuple[MechanismSpec | TargetSpec, ...] = (*self.mechanisms.values(), *self.targets.values())
        return tuple(sorted({spec.buffer for spec in users}))

    def kind_of(self, sensor: SensorSpec) -> SensorKind:
        """Return what a sensor reads."""
        if isinstance(sensor, KnownSpec):
            if sensor.name in self.expects:
                return self.expects[sensor.name]
            return "fact" if isinstance(self.knowledge[sensor.name], bool) else "number"
        return "fact" if sensor.type in FACTS else "number"

    def network_sensors(self) -> tuple[Sensor, ...]:
        """Return the sensors as the behaviour network declares them."""
        return tuple(Sensor(name, self.kind_of(spec)) for name, spec in self.sensors.items())

    def network_behaviours(self) -> tuple[Behaviour, ...]:
        """Return the behaviours as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.behaviours.items())

    def network_goals(self) -> tuple[Goal, ...]:
        """Return the goals as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.goals.items())

    def network_settings(self) -> NetworkSettings:
        """Return how its network decides."""
        return self.settings.build()

    def interfaces(self) -> tuple[Interface, ...]:
        """Return what each behaviour shows to the network that holds the configuration."""
        return tuple(Interface(tuple(b.preconditions), tuple(b.effects)) for b in self.network_behaviours())


def _must_know(what: str, name: str, known: Mapping[str, object], where: str) -> None:
    if name not in known:
        raise ValueError(f"{where}: {unknown(what, name, sorted(known))}")
