"""The model of a coordinator: options of a goal with their configurations, as the network around sees them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from selector.configurations.configuration import ConfigurationSpec, PoseSpec
from selector.configurations.library import Library
from selector.documents.errors import DocumentError
from selector.documents.plain import must_fit
from selector.knowledge import Knowledge
from selector.strategies.problem import Problem
from selforg.network.model.behaviours import Behaviour, Effect, Interface, Sensor
from selforg.network.model.conditions import Conjunction, Disjunction, Optional, Tree


class CoordinatorModel:
    """The options of a goal, in the order of the knowledge, with their configurations.

    Attributes:
        goal: name of the self-organisation goal.
        problem: of choosing an option.
        options: (O,) names.
        scores: (O,) of the problem: by the expert, or learned.
        configurations: (O,) documents of the options.
        sensors: of all configurations; those of one name are one sensor.

    Raises:
        DocumentError: a configuration cannot be built, or two have sensors of one name and different kinds.

    """

    def __init__(self, goal: str, knowledge: Knowledge, library: Library) -> None:
        self.goal = goal
        self.problem = Problem.of(knowledge, goal)
        self.options, self.scores = self.problem.options, self.problem.scores
        self.configurations = tuple(
            library.of_option(option, f"{knowledge.source}: goals.{goal}.{option.name}")
            for option in knowledge.options(goal)
        )
        sensors: dict[str, Sensor] = {}
        for name, configuration in zip(self.options, self.configurations, strict=True):
            for sensor in configuration.network_sensors():
                if sensors.setdefault(sensor.name, sensor) != sensor:
                    other = sensors[sensor.name].kind
                    raise DocumentError(
                        f"goal {goal}: option {name}: sensor {sensor.name!r} is a {sensor.kind}, elsewhere a {other}"
                    )
        self.sensors = tuple(sensors.values())

    @property
    def sets_pose(self) -> bool:
        """Whether an option wants radii of its own for the robot's pose."""
        return any(configuration.pose != PoseSpec() for configuration in self.configurations)

    def behaviour(self, declared: Behaviour | None = None) -> Behaviour:
        """Return the coordinator as a behaviour of the network around, with the settings of `declared` if given."""
        return replace(declared or Behaviour(self.goal), alternatives=tuple(map(interface_of, self.configurations)))


def coordinator_models(goals: Iterable[str], knowledge: Knowledge, library: Library) -> tuple[CoordinatorModel, ...]:
    """Return the models of some goals, in their order; DocumentError if options of two goals want radii of the pose."""
    models = tuple(CoordinatorModel(goal, knowledge, library) for goal in goals)
    spreading = [model.goal for model in models if model.sets_pose]
    must_fit(len(spreading) < 2, "pose", "options of one goal to set radii", f"options of {', '.join(spreading)}")
    return models


def interface_of(configuration: ConfigurationSpec) -> Interface:
    """Return preconditions and effects of a configuration; of several behaviours, it is ready when one of them is.

    A configuration that only steers takes no turn of the robot's behaviours, and shows them nothing.
    """
    if configuration.steers:
        return Interface()
    faces = [Interface(tuple(b.preconditions), tuple(b.effects)) for b in configuration.network_behaviours()]
    if len(faces) == 1:
        return faces[0]
    optional = tuple(p for face in faces for p in face.preconditions if isinstance(p, Optional))
    mandatory = [tuple(p for p in face.preconditions if not isinstance(p, Optional)) for face in faces]
    trees: tuple[Tree, ...] = ()
    if all(mandatory):
        trees = (Disjunction(*(Conjunction(*parts) for parts in mandatory)),)
    effects = {(effect.sensor, effect.change): effect for face in faces for effect in face.effects}
    return Interface((*trees, *optional), tuple(Effect(sensor, change) for sensor, change in effects))
