"""Networks inside behaviours of a robot, which decide and act while their behaviour runs."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selector.configurations.host import Host
from selector.configurations.running import RunningConfiguration
from selector.coordination.robot_network import RobotNetwork
from selforg.arrays import READ, SCRATCH, Ints
from selforg.commands import Commands
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.network import state as st
from selforg.network.network import BehaviourNetwork
from selforg.network.state import RowStates, open_states
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
        entering = Packed(Entering(self.index, self._outside, self._inside, *self._runs))
        records = entering, self.parent.packed, self.network.packed
        inside = self.configuration.robots.steps(self._runs, self._runs, commands)
        enter = Step(ACT, enter_rows, Rows.of(self._all), enter_rows, records)
        return [enter, *(step._replace(stage=max(step.stage, ACT)) for step in inside)]


class Entering(NamedTuple):
    """Which rows run a network inside a behaviour, and which readings it shares with the network around."""

    holder: int  # the behaviour of the network around
    outside: Annotated[Ints, "S", READ]  # columns of the readings there
    inside: Annotated[Ints, "S", READ]  # the same columns inside
    runs: Annotated[Ints, "R", SCRATCH]  # rows that run it, the first `length`
    length: Annotated[Ints, "1", SCRATCH]


open_entering = opening(Entering)


@lean_kernel
def enter_rows(
    now: float, rows: Ints, entering: Handle[Entering], outer: Handle[RowStates], inner: Written[RowStates]
) -> int:
    """List those of `rows` (K,) in which the holder runs, and show them its readings; a step, see `selforg.program`.

    All behaviours inside stop where the holder does not run, or has just started.
    """
    e, around, held = open_entering(entering), open_states(outer), open_states(inner)
    e.length[0] = 0
    for row in rows:
        runs = around.marks[row, st.EXECUTING, e.holder] != 0
        if not runs or around.marks[row, st.STARTED, e.holder] != 0:
            for behaviour in range(held.marks.shape[2]):
                held.marks[row, st.EXECUTING, behaviour] = 0
                held.marks[row, st.EXECUTION_TIME, behaviour] = -1
        if runs:
            e.runs[e.length[0]] = row
            e.length[0] += 1
            for k in range(len(e.inside)):
                held.readings[row, e.inside[k]] = around.readings[row, e.outside[k]]
    return 0


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
