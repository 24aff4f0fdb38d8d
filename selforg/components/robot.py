"""Robots whose network senses and acts through components: as steps of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, READ, SCRATCH, Floats, Ints
from selforg.commands import Commands
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.components.actions import Action
from selforg.components.sensors import SensorComponent
from selforg.components.sources import Source
from selforg.network import state as st
from selforg.network.model.packed import PackedModel
from selforg.network.network import BehaviourNetwork
from selforg.network.state import RowStates, list_running, open_states, reset_rows
from selforg.program import ACT, SENSE, Rows, Step

Actions = Mapping[str, Action | Sequence[Action]]


class Turning(NamedTuple):
    """In which rows a network runs that lies inside behaviours of another one, and which readings it gets from that."""

    behaviours: Annotated[Ints, "B", READ]  # those outside with which it runs; without any it always does
    stops: int  # 1: all behaviours inside stop where it does not run
    outside: Annotated[Ints, "S", READ]  # columns of the readings outside
    columns: Annotated[Ints, "S", READ]  # the same inside
    stale: Annotated[Ints, "R", KEPT]  # 1: the network has to be reset
    renewed: Annotated[Ints, "R", SCRATCH]  # room for the rows to reset
    acting: Annotated[Ints, "R", SCRATCH]  # rows that act, the first `length`
    length: Annotated[Ints, "1", SCRATCH]


open_turning = opening(Turning)


@lean_kernel
def list_turns(
    now: float,
    rows: Ints,
    turning: Written[Turning],
    outer: Handle[RowStates],
    model: Handle[PackedModel],
    inner: Written[RowStates],
) -> int:
    """List those of `rows` (K,) that act, and restart the networks inside that are stale.

    This is a step, see `selforg.program`. A row acts where one of the behaviours outside runs; without any, all rows
    act. Where such a behaviour has just started, and with `stops` where none runs, all behaviours inside are stopped.
    """
    t, around, held = open_turning(turning), open_states(outer), open_states(inner)
    acting, renewed = 0, 0
    for row in rows:
        runs, starts = t.behaviours.shape[0] == 0, False
        for behaviour in t.behaviours:
            runs = runs or around.marks[row, st.EXECUTING, behaviour] != 0
            starts = starts or around.marks[row, st.STARTED, behaviour] != 0
        if (runs and starts) or (t.stops == 1 and not runs):
            for b in range(held.marks.shape[2]):
                held.marks[row, st.EXECUTING, b] = 0
                held.marks[row, st.EXECUTION_TIME, b] = -1
        if not runs:
            continue
        t.acting[acting] = row
        acting += 1
        if t.stale[row]:
            t.stale[row] = 0
            t.renewed[renewed] = row
            renewed += 1
        for k in range(len(t.columns)):
            held.readings[row, t.columns[k]] = around.readings[row, t.outside[k]]
    t.length[0] = acting
    if renewed > 0:
        reset_rows(t.renewed[:renewed], model, inner)
    return 0


class OrganisedRobots:
    """N robots with one network; a sensor may read through a component, a behaviour may act through components.

    Sources that only actions read are asked only for the rows that act.

    Args:
        network: of the robots.
        sensors: components by name; the host writes the other readings into `network.readings`.
        actions: one or several by behaviour.

    Attributes:
        sensors: each component with its column of the readings.
        actions: each component with the number of its behaviour.

    Raises:
        ValueError: the model lacks a sensor or behaviour, or a sensor has another kind than its component.

    """

    _shown: Annotated[Ints, "S", READ]
    _shown_in: Annotated[Floats, "N T", READ]

    def __init__(self, network: BehaviourNetwork, sensors: Mapping[str, SensorComponent], actions: Actions) -> None:
        self.network, model = network, network.model
        self.sensors = [(model.sensor(name, "sensor component"), component) for name, component in sensors.items()]
        for column, component in self.sensors:
            sensor = model.sensors[column]
            if sensor.kind != component.kind:
                what = f"{type(component).__name__} reads a {component.kind}"
                raise ValueError(f"sensor {sensor.name!r} is a {sensor.kind}, but {what}")
        unknown = [name for name in actions if name not in model.behaviour_index]
        if unknown:
            raise ValueError(f"action: unknown behaviour {unknown[0]!r} (known: {', '.join(model.behaviour_index)})")
        each = [(name, [act] if isinstance(act, Action) else list(act)) for name, act in actions.items()]
        self.actions = [(model.behaviour_index[name], action) for name, all_of in each for action in all_of]
        self._sensed = _each_once([], [component for _, component in self.sensors])
        self._asked_late = [_each_once(self._sensed, [action]) for _, action in self.actions]
        self._shown, self._shown_in = np.arange(network.readings.shape[1]), network.readings

    def steps(self, sensing: Rows, acting: Rows, commands: Commands, guarantee: bool = True) -> list[Step]:
        """Return the steps that write the readings of some rows, decide and act in others, which may be the same.

        Movements go into `commands`. With `guarantee` some behaviour runs wherever one is able to.
        """
        network, state = self.network, self.network.state
        steps = [step for source in self._sensed for step in source.asking(SENSE, sensing)]
        for column, sensor in self.sensors:
            shown = self._shown_in, int(self._shown[column])
            steps.append(sensor.reading(sensing, network.readings, column, *shown))
        listing = Step(ACT, list_running, acting, list_running, (network.packed,), always=True)
        steps += [network.deciding(ACT, acting, guarantee), listing]
        for (number, action), sources in zip(self.actions, self._asked_late, strict=True):
            running, started = map(Rows, state.running[number], state.counts[number])
            steps += [step for source in sources for step in source.asking(ACT, running)]
            steps += action.steps(running, started, commands)
        return steps

    def inside(
        self, outer: BehaviourNetwork, turning: Turning, members: Rows, commands: Commands, *, late: bool = False
    ) -> list[Step]:
        """Return the steps of those of `members` whose network runs inside behaviours of the network `outer`.

        All of them sense before they act; with `late` only those that act do, and not before it is known who does.
        """
        records = Packed(turning), outer.packed, self.network.model.packed, self.network.packed
        acting = Rows(turning.acting, turning.length)
        steps = [Step(ACT, list_turns, members, list_turns, records, always=True)]
        steps += self.steps(acting if late else members, acting, commands)
        return [step._replace(stage=max(step.stage, ACT)) for step in steps] if late else steps

    def show_in(self, readings: Floats, columns: Ints) -> None:
        """Write all readings also into `readings` (N, T), those of sensor k into column columns[k], from now on."""
        self._shown_in, self._shown = readings, columns


def _each_once(known: Sequence[Source], components: Sequence[SensorComponent | Action]) -> list[Source]:
    """Return the sources of all components, without those `known`, in order and each once."""
    found: list[Source] = []
    for component in components:
        each = (one for source in component.sources for one in (*source.parts, source))
        found += [one for one in each if not any(one is other for other in (*known, *found))]
    return found
