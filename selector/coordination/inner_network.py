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


class InnerNetwork:
    """R rows of a network inside the behaviour `holder` of the network `parent`.

    Call in every control period `act` after the step of the parent, and `leave` when all movements are known, as of a
    coordinator. The network decides in every step in which its holder runs, with a decision guaranteed. When the
    holder stops, all behaviours inside stop; activations and memory stay. The network follows no plan.

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
        self._all = np.arange(parent.rows)

    @property
    def network(self) -> BehaviourNetwork:
        """The network itself, without the networks inside."""
        return self.configuration.network

    def reset(self, rows: Ints) -> None:
        """Clear network and memory of `rows` (K,)."""
        self.network.reset(rows)
        self.configuration.forget(rows)

    def act(self, now: float, commands: Commands) -> None:
        """Sense, decide and act at `now` [s] where the parent runs the holder; movements go into `commands`."""
        runs = self.parent.executing[:, self.index] == 1
        self.network.halt(self._all[~runs | (self.parent.started[:, self.index] == 1)])
        rows = self._all[runs]
        if len(rows):
            self.network.readings[np.ix_(rows, self._inside)] = self.parent.readings[np.ix_(rows, self._outside)]
            self.configuration.robots.sense(now, rows)
            self.network.step(rows, guarantee=True)
            self.configuration.robots.act(now, rows, commands)

    def steer(self, now: float, commands: Commands) -> None:
        """Change `commands` at `now` [s], once all movements of the robots are known."""
        self.configuration.robots.steer(now, commands)

    def leave(self, now: float) -> None:
        """Spread and deposit, at `now` [s], what others perceive from the next control period on."""
        self.configuration.robots.leave(now)


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
