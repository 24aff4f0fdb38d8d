"""Robots with a network, coordinators and inner networks: the steps of a tick, and a whole tick in one call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np

from selector.configurations.host import Host
from selector.coordination.coordinator import Coordinator, hold_options
from selector.coordination.inner_network import InnerNetwork, inner_networks
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_network import RobotNetwork
from selector.vocabulary.components import SensorSpec
from selforg.arrays import READ, Ints
from selforg.commands import Commands
from selforg.components import SensorComponent
from selforg.network.model.behaviours import NetworkSettings
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from selforg.program import DECIDE, SENSE, STEER, Program, Rows, Step


class CoordinatedRobots:
    """R robots that serve the goals of some coordinators.

    Args:
        models: of the coordinators, C of them.
        host: gives buffers, memory and functions to the configurations; its rows are the robots.
        network: of a robot document, with all coordinators among its behaviours; None: a network of the coordinators
            only, of which all that are ready run.
        planner: plans for the network.
        explained: whether the networks note why each behaviour runs or does not.
        documents: (R,) the number of each robot's document, where the network is for several.

    Attributes:
        network: decides which coordinators run; a host writes the readings of its own sensors into `readings`.
        coordinators: (C,).
        inner: the networks inside behaviours at any depth, each before those inside it.

    """

    _all: Annotated[Ints, "R", READ]
    _documents: Annotated[Ints, "R", READ]

    def __init__(
        self,
        models: CoordinatorModel | Sequence[CoordinatorModel],
        host: Host,
        *,
        network: RobotNetwork | None = None,
        planner: Planner | None = None,
        explained: bool = False,
        documents: Ints | None = None,
    ) -> None:
        listed = (models,) if isinstance(models, CoordinatorModel) else tuple(models)
        robot = network or RobotNetwork(network_of(listed))
        self.network = BehaviourNetwork(robot.model, host.rows, planner, explained)
        self.coordinators = tuple(
            Coordinator(model, self.network, host, during=robot.during.get(model.goal, ()), explained=explained)
            for model in listed
        )
        self.inner = inner_networks(robot, self.network, host, explained=explained)
        self._inside: tuple[Coordinator | InnerNetwork, ...] = (*self.coordinators, *self.inner)
        self._commands, self._program = Commands(host.rows, host.poses.space.dim), Program(self._whole_tick)
        self._all: Ints = np.arange(host.rows)
        column, made = self.network.model.sensor_index, robot.sensors.items()
        self._sensors = [(column[name], component_of(spec, host)) for name, spec in made]
        self._left_out = robot.left_out
        self._documents = np.zeros(host.rows, dtype=np.int64) if documents is None else documents
        self._leave_out(self._all)

    def steps(self, commands: Commands) -> list[Step]:
        """Return all steps of a tick except the decision of the network; movements go into `commands`."""
        everyone, readings, steps = Rows.of(self._all), self.network.readings, list[Step]()
        if self.network.explained:
            steps.append(Step(STEER, lambda now, _: np.copyto(commands.wishes, commands.vectors), everyone))
        for column, sensor in self._sensors:
            steps += [step for source in sensor.sources for step in source.asking(SENSE, everyone)]
            steps.append(sensor.reading(everyone, readings, column, readings, column))
        return [*steps, *(step for inside in self._inside for step in inside.serving(commands))]

    def reset(self, rows: Ints | None = None) -> None:
        """Clear all networks of `rows` (K,) or of all rows; each row keeps the options that it holds."""
        chosen = self._all if rows is None else rows
        self.network.reset(chosen)
        self._leave_out(chosen)
        for inside in self._inside:
            inside.reset(chosen)

    def _leave_out(self, rows: Ints) -> None:
        """Take behaviours and goals that are not in the documents of `rows` (K,) out of their networks."""
        model = self.network.model
        for number, left_out in enumerate(self._left_out):
            own = rows[self._documents[rows] == number]
            for name in left_out.behaviours:
                self.network.remove(own, model.behaviour_index[name])
            for name in left_out.goals:
                self.network.enable_goal(own, model.goal_index[name], False)

    def hold(self, options: Ints, rows: Ints | None = None) -> None:
        """Give `options` (K, C), or (K,) for one coordinator, to the coordinators in `rows` (K,) or in all rows."""
        hold_options(self.coordinators, options, self._all if rows is None else rows)

    def tick(self, now: float) -> Commands:
        """Sense, decide and act at `now` [s] in all robots; return their commands, which hold until the next tick."""
        self._commands.clear()
        self._program.run(now)
        return self._commands

    def _whole_tick(self) -> list[Step]:
        return [*self.steps(self._commands), self.network.deciding(DECIDE, Rows.of(self._all), True)]


def component_of(spec: SensorSpec, host: Host) -> SensorComponent:
    """Return a sensor of a fact, which the host knows."""
    given = spec.given
    ((parameter, _, name),) = spec.references()
    cls: Any = spec.component
    sensor: SensorComponent = cls(**given | {parameter: host.facts[name]})
    return sensor


def network_of(models: Sequence[CoordinatorModel], settings: NetworkSettings | None = None) -> NetworkModel:
    """Return a network whose only behaviours are the coordinators."""
    sensors = [sensor for model in models for sensor in model.sensors]
    return NetworkModel(sensors, [model.behaviour() for model in models], [], settings)
