"""Networks inside behaviours of a robot, which decide and act while their behaviour runs."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from selector.configurations.host import Host
from selector.configurations.running import RunningConfiguration
from selector.coordination.robot_network import RobotNetwork
from selforg.arrays import READ, Ints
from selforg.commands import Commands
from selforg.network.network import BehaviourNetwork
from selforg.program import ACT, Rows, Step


class InnerNetwork:
    """R rows of a network inside the behaviour `holder` of the network `parent`.

    Its steps follow the step of the parent. The network decides in every step in which its holder runs, with a decision
    guaranteed. When the holder stops, all behaviours inside stop; activations and memory stay. The network follows no
    plan.

    Args:
        held: the models and components.
        holder: name of the behaviour.
        parent: the network around.
        host: gives buffers, memory and functions to the components.
        path: names of the behaviours around, from the outside in.
        explained: whether the networks note why each behaviour runs or does not.

    Attributes:
        name: the behaviours around and the holder, as in `Tidy/Approach`.
        configuration: the network at work with its components.

    """

    _all: Annotated[Ints, "R", READ]

    def __init__(
        self,
        held: RobotNetwork,
        holder: str,
        parent: BehaviourNetwork,
        host: Host,
        path: tuple[str, ...] = (),
        *,
        explained: bool = False,
    ) -> None:
        self.name = "/".join((*path, holder))
        self.parent = parent
        self.index = parent.model.behaviour_index[holder]
        assert held.spec is not None  # only the root has none
        self.configuration = RunningConfiguration(held.spec, host, f"network in {self.name}", explained=explained)
        self._outside, self._inside = held.shared_columns(parent.model)
        self._all, self._runs = np.arange(parent.rows), Rows.of(np.zeros(parent.rows, dtype=np.int64))

    @property
    def network(self) -> BehaviourNetwork:
        """The network itself, without the networks inside."""
        return self.configuration.network

    def reset(self, rows: Ints) -> None:
        """Clear network and memory of `rows` (K,)."""
        self.network.reset(rows)
        self.configuration.forget(rows)

    def steps(self, commands: Commands) -> list[Step]:
        """Return the steps that sense, decide and act where the holder runs; movements go into `commands`."""
        inside = self.configuration.robots.steps(self._runs, self._runs, commands)
        entering = Step(ACT, lambda now, _: self._enter(), Rows.of(self._all))
        return [entering, *(step._replace(stage=max(step.stage, ACT)) for step in inside)]

    def _enter(self) -> None:
        """List the rows in which the parent runs the holder, with its readings; behaviours inside others stop."""
        runs = self.parent.executing[:, self.index] == 1
        self.network.halt(self._all[~runs | (self.parent.started[:, self.index] == 1)])
        rows = self._all[runs]
        self._runs.fill(rows)
        self.network.readings[np.ix_(rows, self._inside)] = self.parent.readings[np.ix_(rows, self._outside)]


def inner_networks(
    robot: RobotNetwork, parent: BehaviourNetwork, host: Host, path: tuple[str, ...] = (), *, explained: bool = False
) -> tuple[InnerNetwork, ...]:
    """Return the networks inside the behaviours of a robot at any depth, each before those inside it.

    They are in the order of the document of the robot; `parent` runs its root.
    """
    found: list[InnerNetwork] = []
    for holder, held in robot.inner.items():
        inner = InnerNetwork(held, holder, parent, host, path, explained=explained)
        found += [inner, *inner_networks(held, inner.network, host, (*path, holder), explained=explained)]
    return tuple(found)
