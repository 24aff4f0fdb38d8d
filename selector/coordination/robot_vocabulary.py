"""The words in which YAML declares the networks of a robot: the root, and those inside behaviours."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from selector.configurations.acting_network import ActingBehaviourSpec, ActingNetworkSpec
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Name, Share
from selector.vocabulary.components import ActionSpecs, SensorSpec
from selector.vocabulary.conditions import AnyCondition, BehaviourSpec, GoalSpec
from selector.vocabulary.settings import SettingsSpec
from selforg.network.model.behaviours import Behaviour, Goal, NetworkSettings, Sensor
from selforg.network.model.model import NetworkModel
from selforg.registry import unknown

Coordinators = Mapping[str, CoordinatorModel]


class HoldingBehaviourSpec(BehaviourSpec):
    """A behaviour that may hold a network, or a coordinator that holds the configuration chosen for its goal."""

    type: Literal["Behaviour", "Coordinator"] = "Behaviour"
    """A coordinator's preconditions and effects come on top of those of the configuration that it holds."""
    goal: Name | None = None
    """Of a coordinator: the self-organisation goal that it serves, by whose name it goes."""
    network: Name | None = None
    """Of a behaviour: name of the network that decides while it runs."""

    @model_validator(mode="after")
    def _holds_one_thing(self) -> Self:
        if self.type == "Coordinator" and (self.goal is None or self.network is not None):
            raise ValueError("expected a coordinator with a goal and without a network")
        if self.type == "Behaviour" and self.goal is not None:
            raise ValueError("expected a goal for a coordinator only (type: Coordinator)")
        return self

    def build_with(self, name: str, coordinators: Coordinators) -> Behaviour:
        """Return the behaviour this declares, as a coordinator with the alternatives of its goal."""
        plain = self.build(name)
        if self.goal is None:
            return plain
        where = f"behaviours.{name}.goal"
        if self.goal not in coordinators:
            raise DocumentError(f"{where}: {unknown('coordinated goal', self.goal, sorted(coordinators))}")
        if self.goal != name:
            raise DocumentError(f"{where}: expected the name of the coordinator, got {self.goal!r}")
        settings = {field: getattr(plain, field) for field in Behaviour.__dataclass_fields__}
        return coordinators[self.goal].behaviour(
            **{field: value for field, value in settings.items() if field not in ("name", "alternatives")}
        )


class ReachableGoalSpec(GoalSpec):
    """A goal that may be content with less than full satisfaction."""

    satisfaction_threshold: Share = 1.0
    """Satisfaction from which it counts as reached [-]."""

    def build(self, name: str) -> Goal:
        """Return the goal this declares."""
        plain = super().build(name)
        return Goal(name, plain.conditions, plain.priority, plain.permanent, self.satisfaction_threshold)


class NetworkSpec(Closed):
    """One network, its named conditions already in their places."""

    sensors: Annotated[dict[Name, Literal["fact", "number"]], Field(min_length=1)]
    """What each sensor reads."""
    conditions: dict[Name, AnyCondition] = Field(default_factory=dict)
    """Conditions to be used by name."""
    behaviours: Annotated[dict[Name, HoldingBehaviourSpec], Field(min_length=1)]
    """Behaviours by name, in order of registration."""
    goals: dict[Name, ReachableGoalSpec] = Field(default_factory=dict)
    """Goals by name."""
    settings: SettingsSpec = SettingsSpec()
    """How it decides."""

    def build(self, coordinators: Coordinators, settings: NetworkSettings | None) -> NetworkModel:
        """Return the model this declares, decided by `settings` if given; coordinators' sensors come after its own."""
        behaviours = [spec.build_with(name, coordinators) for name, spec in self.behaviours.items()]
        held = [spec.goal for spec in self.behaviours.values() if spec.goal is not None]
        sensors = [
            *(Sensor(name, kind) for name, kind in self.sensors.items()),
            *(sensor for goal in held for sensor in coordinators[goal].sensors),
        ]
        goals = [spec.build(name) for name, spec in self.goals.items()]
        return NetworkModel(sensors, behaviours, goals, settings or self.settings.build())


class InnerBehaviourSpec(HoldingBehaviourSpec, ActingBehaviourSpec):
    """A behaviour of an inner network, which may act, hold another network, or both."""

    action: ActionSpecs = ()
    """What the behaviour does while it runs: one action, or several that happen together."""


def _kind_of_sensor(given: Any) -> str:  # noqa: ANN401  (whatever YAML holds)
    return "kind" if isinstance(given, str) else "sensor"


InnerSensor = Annotated[
    Annotated[Literal["fact", "number"], Tag("kind")] | Annotated[SensorSpec, Tag("sensor")],
    Discriminator(_kind_of_sensor),
]
"""What a sensor of that name reads in the network around, or a sensor of its own."""


class InnerNetworkSpec(ActingNetworkSpec[InnerSensor, InnerBehaviourSpec, ReachableGoalSpec]):
    """A network inside a behaviour, its named conditions already in their places."""

    conditions: dict[Name, AnyCondition] = Field(default_factory=dict)
    """Conditions to be used by name."""

    def network_sensors(self) -> tuple[Sensor, ...]:
        """Return all sensors as the behaviour network declares them, those of the network around too."""
        kinds = {name: self.kind_of(one) if isinstance(one, SensorSpec) else one for name, one in self.sensors.items()}
        return tuple(Sensor(name, kind) for name, kind in kinds.items())

    def network_behaviours(self) -> tuple[Behaviour, ...]:
        """Return the behaviours as the behaviour network declares them; none of them is a coordinator."""
        return tuple(spec.build_with(name, {}) for name, spec in self.behaviours.items())
