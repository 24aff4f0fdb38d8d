"""Document models of networks that sense and act through components; every reference in them is checked.

A mechanism configuration is such a network, whose components realise one way to serve a goal. Mechanisms, targets,
sensors, behaviours and goals have names, by which they refer to each other; the files in `configs/mechanisms` are
examples. `parameters` lists the values that an option may override; `$name` in place of a value stands for the
parameter of that name.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Generic, Literal, Self, TypeVar

from pydantic import Field, model_validator

from selector.documents.fields import Closed, Flag, Name, NonNegative, Number
from selector.documents.plain import must_know
from selector.vocabulary.components import ActionSpecs, ComponentSpec, MechanismSpec, SensorSpec, TargetSpec
from selector.vocabulary.conditions import AnyCondition, BehaviourSpec, GoalSpec, plain_conditions
from selector.vocabulary.settings import SettingsSpec
from selforg.components import HandOver, Steer
from selforg.mechanisms import MECHANISMS
from selforg.network.model.activators import BOOLEAN_RULE
from selforg.network.model.behaviours import Behaviour, Goal, Sensor, SensorKind
from selforg.network.model.model import NetworkModel

BESIDE = {Steer.__name__, HandOver.__name__}
"""Types of the actions that robots do beside what other behaviours command."""
DECLARED_BY = {"fact": "; the robots' document declares facts, under `facts`"}
"""Kind of what a configuration may name -> end of the message where there is none of the name."""


class ActingBehaviourSpec(BehaviourSpec):
    """A behaviour with its actions."""

    action: ActionSpecs
    """What the behaviour does while it runs: one action or several."""


AnySensor = TypeVar("AnySensor")
AnyBehaviour = TypeVar("AnyBehaviour", bound=ActingBehaviourSpec)


class ActingNetworkSpec(Closed, Generic[AnySensor, AnyBehaviour]):
    """A network with the components by which it senses and acts; every name to which a component refers exists."""

    description: str = ""
    """What the network does and where it comes from."""
    mechanisms: dict[Name, MechanismSpec] = Field(default_factory=dict)
    """Mechanisms by name."""
    targets: dict[Name, TargetSpec] = Field(default_factory=dict)
    """Gradients that queries choose, by name."""
    knowledge: dict[Name, Flag | Number] = Field(default_factory=dict)
    """What robots remember for this network, with the first value, which is a fact or a number."""
    expects: dict[Name, Literal["fact", "number"]] = Field(default_factory=dict)
    """Names in the memory of the host that the network needs."""
    sensors: dict[Name, AnySensor] = Field(default_factory=dict)
    """Sensors by name."""
    behaviours: Annotated[dict[Name, AnyBehaviour], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, GoalSpec] = Field(default_factory=dict)
    """Goals inside the network by name."""
    settings: SettingsSpec = SettingsSpec()
    """How the network decides."""

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        for name in self.knowledge.keys() & self.expects.keys():
            raise ValueError(f"expects.{name}: is under knowledge too; expected one of them")
        for where, spec in self._components():
            self._check_component(spec, where)
        return self

    @property
    def own_sensors(self) -> dict[str, SensorSpec]:
        """The sensors that are components of this network."""
        return {name: spec for name, spec in self.sensors.items() if isinstance(spec, SensorSpec)}

    @property
    def steers(self) -> bool:
        """Whether all that the behaviours do is done beside what others command, so that they need no turn."""
        return all(action.type in BESIDE for behaviour in self.behaviours.values() for action in behaviour.action)

    def referred(self, what: str, part: str = "") -> tuple[str, ...]:
        """Return the names of the host's functions ("call") or facts ("fact") to which components of a part refer."""
        specs = (spec for key, spec in self._components() if key.startswith(part))
        references = (reference for spec in specs for reference in spec.references())
        return tuple(name for _, reference, name in references if reference.what == what)

    @property
    def buffers(self) -> tuple[str, ...]:
        """Names of the host's buffers that the network reads or spreads to, sorted."""
        users: tuple[MechanismSpec | TargetSpec, ...] = (*self.mechanisms.values(), *self.targets.values())
        return tuple(sorted({spec.buffer for spec in users}))

    def kind_of(self, sensor: SensorSpec) -> SensorKind:
        """Return the reading of a sensor."""
        cls = sensor.component
        if cls.kind_of is None:
            return cls.kind
        name = sensor.given[cls.kind_of]
        if name in self.expects:
            return self.expects[name]
        return "fact" if isinstance(self.knowledge[name], bool) else "number"

    def network_sensors(self) -> tuple[Sensor, ...]:
        """Return the sensors as the behaviour network declares them."""
        return tuple(Sensor(name, self.kind_of(spec)) for name, spec in self.own_sensors.items())

    def network_behaviours(self) -> tuple[Behaviour, ...]:
        """Return the behaviours as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.behaviours.items())

    def network_goals(self) -> tuple[Goal, ...]:
        """Return the goals as the behaviour network declares them."""
        return tuple(spec.build(name) for name, spec in self.goals.items())

    def network_model(self) -> NetworkModel:
        """Return the behaviour network; ValueError for parts that do not fit together."""
        return NetworkModel(
            self.network_sensors(), self.network_behaviours(), self.network_goals(), self.settings.build()
        )

    def _components(self) -> Iterator[tuple[str, ComponentSpec[Any]]]:
        """Yield the key and the specification of every sensor and action."""
        for name, sensor in self.own_sensors.items():
            yield f"sensors.{name}", sensor
        for name, behaviour in self.behaviours.items():
            for index, action in enumerate(behaviour.action):
                yield f"behaviours.{name}.action{f'.{index}' if index else ''}", action

    def _check_component(self, spec: ComponentSpec[Any], where: str) -> None:
        """Raise ValueError if the component refers to something that does not exist or is of another kind."""
        declared: dict[str, Mapping[str, object]] = {
            "mechanism": self.mechanisms,
            "target": self.targets,
            "knowledge": {**self.knowledge, **self.expects},
        }
        for parameter, reference, name in spec.references():
            if reference.what not in declared:
                continue  # a call or a fact: the host is checked for it
            must_know(reference.what, name, sorted(declared[reference.what]), f"{where}.{parameter}")
            if reference.what == "mechanism":
                given = self.mechanisms[name].type
                if not issubclass(MECHANISMS.find(given), reference.mechanism):
                    expected = f"expected {reference.expected}, got {name!r}, which is a {given}"
                    raise ValueError(f"{where}.{parameter}: {expected}")


class PoseSpec(Closed):
    """The radii of a robot's own pose gradient; those of the host unless given."""

    diffusion: NonNegative | None = None
    """Diffusion [m]."""
    goal_radius: NonNegative | None = None
    """Goal radius [m]."""


class ConfigurationSpec(ActingNetworkSpec[SensorSpec, ActingBehaviourSpec]):
    """The components of one configuration, after every `$name` was replaced."""

    pose: PoseSpec = PoseSpec()
    """What a robot spreads of itself while it holds the configuration."""

    @model_validator(mode="after")
    def _conditions_fit(self) -> Self:
        for name, behaviour in self.behaviours.items():
            self._check_conditions(behaviour.preconditions, f"behaviours.{name}.preconditions")
            for effect in behaviour.effects:
                must_know("sensor", effect.sensor, sorted(self.sensors), f"behaviours.{name}.effects")
        for name, goal in self.goals.items():
            self._check_conditions(goal.conditions, f"goals.{name}.conditions")
        return self

    def _check_conditions(self, trees: Iterable[AnyCondition], where: str) -> None:
        for spec in (plain for tree in trees for plain in plain_conditions(tree)):
            must_know("sensor", spec.sensor, sorted(self.sensors), where)
            kind = self.kind_of(self.sensors[spec.sensor])
            if (kind == "fact") is not (spec.activator.component.kind == BOOLEAN_RULE):
                expected = "a Boolean activator on a fact, any other on a number"
                given = f"{spec.activator.type} on the {kind} {spec.sensor!r}"
                raise ValueError(f"{where}: expected {expected}, got {given}")
