"""Networks inside behaviours of a robot, which decide and act while their behaviour runs."""

from __future__ import annotations

import numpy as np

from selector.configurations.host import Host
from selector.configurations.running import RunningConfiguration
from selector.coordination.robot_network import RobotNetwork
from selforg.commands import Commands
from selforg.components.robot import Turning
from selforg.network.network import BehaviourNetwork
from selforg.program import Rows, Step


class InnerNetwork(RunningConfiguration):
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

    """

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
        super().__init__(held.spec, host, f"network in {self.name}", explained=explained)
        self._columns = held.shared_columns(parent.model)

    def serving(self, commands: Commands) -> list[Step]:
        """Return the steps that sense, decide and act where the holder runs; movements go into `commands`."""
        rows = self.parent.rows
        room = (np.zeros(length, dtype=np.int64) for length in (rows, rows, rows, 1))
        turning = Turning(np.array([self.index]), 1, *self._columns, *room)
        return self.inside(self.parent, turning, Rows.of(np.arange(rows)), commands, late=True)


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
