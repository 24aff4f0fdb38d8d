"""A mechanism configuration: the components that realise one way to serve a goal, and the parameters of an option.

Mechanisms, sensors over them, behaviours and goals have names, by which they refer to each other; the files in
`configs/mechanisms` are examples. Under `parameters` stand the values that an option may lay over; `$name` in place
of a value stands for the parameter of that name.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from selector.documents import Closed, DocumentError, Name, NonNegative, unknown
from selector.vocabulary import AnyCondition, BehaviourSpec, GoalSpec, plain_conditions
from selector.vocabulary_activators import BooleanSpec
from selforg.network.behaviours import Behaviour, Goal, Interface, Sensor, SensorKind

Content: TypeAlias = dict[str, Any]
REFERENCE = "$"


class MechanismSpec(Closed):
    """A registered mechanism with its parameters."""

    type: Name
    """Name of the mechanism's class."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Keyword arguments of the mechanism; it checks them itself when it is made."""


class PresenceSpec(Closed):
    """A fact: the mechanism gives a movement vector, and it is longer than a threshold."""

    type: Literal["Presence"]
    mechanism: Name
    """Name of the mechanism in this configuration."""
    longer_than: NonNegative = 1e-9
    """Length above which a vector counts as present [m]."""


class LengthSpec(Closed):
    """A number: the length of the mechanism's movement vector, 0 without one."""

    type: Literal["Length"]
    mechanism: Name
    """Name of the mechanism in this configuration."""


SensorSpec: TypeAlias = Annotated[PresenceSpec | LengthSpec, Field(discriminator="type")]
SENSOR_KINDS: dict[str, SensorKind] = {"Presence": "fact", "Length": "number"}


class MoveSpec(Closed):
    """While the behaviour runs, the mechanism's movement vector becomes the drive command."""

    type: Literal["Move"]
    mechanism: Name
    """Name of the mechanism in this configuration."""


class ActingBehaviourSpec(BehaviourSpec):
    """A behaviour of a configuration, with what it does."""

    action: MoveSpec
    """What the behaviour does while it runs."""


class ConfigurationSpec(Closed):
    """The components of one configuration, with every reference resolved."""

    description: str = ""
    """What it does and where it comes from."""
    mechanisms: dict[Name, MechanismSpec]
    """Mechanisms by name."""
    sensors: dict[Name, SensorSpec]
    """Sensors over the mechanisms by name."""
    behaviours: Annotated[dict[Name, ActingBehaviourSpec], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, GoalSpec] = Field(default_factory=dict)
    """Goals inside the configuration by name."""

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        for name, sensor in self.sensors.items():
            _must_know("mechanism", sensor.mechanism, self.mechanisms, f"sensors.{name}.mechanism")
        for name, behaviour in self.behaviours.items():
            where = f"behaviours.{name}"
            _must_know("mechanism", behaviour.action.mechanism, self.mechanisms, f"{where}.action.mechanism")
            self._check_conditions(behaviour.preconditions, f"{where}.preconditions")
            for effect in behaviour.effects:
                _must_know("sensor", effect.sensor, self.sensors, f"{where}.effects")
        for name, goal in self.goals.items():
            self._check_conditions(goal.conditions, f"goals.{name}.conditions")
        return self

    def _check_conditions(self, trees: Iterable[AnyCondition], where: str) -> None:
        for spec in (plain for tree in trees for plain in plain_conditions(tree)):
            _must_know("sensor", spec.sensor, self.sensors, where)
            kind = SENSOR_KINDS[self.sensors[spec.sensor].type]
            if (kind == "fact") is not isinstance(spec.activator, BooleanSpec):
                expected = "a Boolean activator on a fact, any other on a number"
                given = f"{spec.activator.type} on the {kind} {spec.sensor!r}"
                raise ValueError(f"{where}: expected {expected}, got {given}")

    def network_sensors(self) -> tuple[Sensor, ...]:
        """Return the sensors as the behaviour network declares them."""
        return tuple(Sensor(name, SENSOR_KINDS[spec.type]) for name, spec in self.sensors.items())

    def network_behaviours(self) -> tuple[Behaviour, ...]:
        """Return the behaviours as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.behaviours.items())

    def network_goals(self) -> tuple[Goal, ...]:
        """Return the goals as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.goals.items())

    def interfaces(self) -> tuple[Interface, ...]:
        """Return what each behaviour shows to the network that holds the configuration."""
        return tuple(Interface(tuple(b.preconditions), tuple(b.effects)) for b in self.network_behaviours())


def resolved(content: Content, parameters: Mapping[str, Any]) -> Content:
    """Return a configuration's content with `parameters` laid over its own and every `$name` replaced.

    Raises:
        DocumentError: a parameter that the configuration does not have, or a `$name` that it does not declare.

    """
    values = laid_over(declared_parameters(content), parameters, "parameters")
    return {key: _filled(value, values, key) for key, value in content.items() if key != "parameters"}


def declared_parameters(content: Content) -> Content:
    """Return what an option may lay over."""
    declared = content.get("parameters", {})
    if not isinstance(declared, dict):
        raise DocumentError(f"parameters: expected a mapping, got {declared!r}")
    return declared


def check_parameters_used(content: Content) -> None:
    """Raise DocumentError for a declared parameter that nothing in the configuration refers to."""
    used = set(_references([value for key, value in content.items() if key != "parameters"]))
    for name in declared_parameters(content):
        if name not in used:
            raise DocumentError(f"parameters.{name}: nothing in the configuration uses {REFERENCE}{name}")


def laid_over(base: Mapping[str, Any], changes: Mapping[str, Any], where: str) -> Content:
    """Return `base` with `changes` in its place, mapping by mapping; a key that `base` lacks is an error."""
    merged = dict(base)
    for key, value in changes.items():
        if key not in base:
            raise DocumentError(f"{where}: {unknown('parameter', key, sorted(base))}")
        below = base[key]
        if isinstance(below, Mapping) is not isinstance(value, Mapping):
            raise DocumentError(
                f"{where}.{key}: expected {'a mapping' if isinstance(below, Mapping) else 'a value'}, got {value!r}"
            )
        merged[key] = laid_over(below, value, f"{where}.{key}") if isinstance(below, Mapping) else value
    return merged


def _filled(value: Any, values: Mapping[str, Any], where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    if isinstance(value, dict):
        return {key: _filled(below, values, f"{where}.{key}") for key, below in value.items()}
    if isinstance(value, list):
        return [_filled(below, values, f"{where}.{index}") for index, below in enumerate(value)]
    for name in _references(value):
        if name not in values:
            raise DocumentError(f"{where}: {unknown('parameter', name, sorted(values))}")
        return values[name]
    return value


def _references(value: Any) -> Iterator[str]:  # noqa: ANN401  (whatever YAML holds)
    """Yield the names of the parameters that a value refers to."""
    if isinstance(value, str) and value.startswith(REFERENCE):
        yield value.removeprefix(REFERENCE)
    elif isinstance(value, dict | list):
        for below in value.values() if isinstance(value, dict) else value:
            yield from _references(below)


def _must_know(what: str, name: str, known: Mapping[str, object], where: str) -> None:
    if name not in known:
        raise ValueError(f"{where}: {unknown(what, name, sorted(known))}")
