"""States of worlds: all that the course of a world depends on, as bytes from which this or another world goes on.

The other world may be in another batch and at another time of the clock: its further course has the same bits. Both
batches have one frame, one robot and the same options; `sealing` makes bytes of a state.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.frames import check_frame
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.clock import Clock
from clean_swarm_env.world.events import Agenda, Agendas
from clean_swarm_env.world.floor import Floor
from clean_swarm_env.world.minds import Minds
from clean_swarm_env.world.task import Task
from clean_swarm_env.world.team_changes import Team
from selforg.arrays import together
from selforg.gradients.store.columns import POSE_STAMP, ROW_TEAM
from selforg.gradients.team_state import TeamState, put_team_state, state_of_team
from selforg.sealing import check_alike

Streams = list[dict[str, Any] | None]
"""States of random generators, None where there is none."""


class WorldState(NamedTuple):
    """All that the course of one world depends on."""

    likeness: dict[str, Any]  # what both batches must have in common beside the frame of the mission
    mission: MissionConfig
    ticks: int  # since the reset
    now: float  # time of the clock [s]
    rows: bytes  # of the arrays (R, ...), one after the other
    world: bytes  # of the arrays (W, ...)
    agenda: Agenda | None
    buffers: tuple[TeamState, ...]
    streams: tuple[Streams, ...]


class WorldStates:
    """Takes states out of the worlds of a batch, and puts them in."""

    def __init__(
        self, floor: Floor, minds: Minds, team: Team, task: Task[Any, Any], agendas: Agendas, clock: Clock
    ) -> None:
        self._floor, self._minds, self._team, self._agendas, self._clock = floor, minds, team, agendas, clock
        lasting = together((floor.lasting(), minds.lasting(), team.lasting()))
        self._rows, self._times = (*lasting.values, *task.of_rows(), *lasting.times), lasting.times
        self._worlds = (*floor.of_worlds(), *minds.reception.of_worlds(), team.joined, agendas.over, *task.of_worlds())
        self._likeness = {
            "options": tuple((one.model.goal, one.model.options) for one in minds.coordinators),
            "behaviours": tuple(behaviour.name for behaviour in minds.network.model.behaviours),
            "arrays": likeness_of((*self._rows, *self._worlds)),
        }

    def get(self, world: int, mission: MissionConfig) -> WorldState:
        """Return the state of a world, whose mission is `mission`."""
        rows = self._slice(world)
        return WorldState(
            self._likeness,
            mission,
            int(self._clock.ticks[world]),
            self._clock.now,
            bytes_of(self._rows, rows),
            bytes_of(self._worlds, slice(world, world + 1)),
            self._agendas.of(world),
            tuple(state_of_team(buffer, world) for buffer in self._minds.buffers.values()),
            tuple(states_of(generators[rows]) for generators in self._minds.generators),
        )

    def check(self, state: WorldState, batch: MissionConfig) -> None:
        """Raise ValueError unless a world of the `batch` can go on from a state."""
        check_frame(state.mission, batch)
        check_alike(self._likeness, state.likeness)

    def put(self, world: int, state: WorldState) -> None:
        """Make a world go on from a state that `check` has let pass."""
        rows, later, minds = self._slice(world), self._clock.now - state.now, self._minds
        fill(self._rows, rows, state.rows)
        fill(self._worlds, slice(world, world + 1), state.world)
        for times in (*self._times, minds.poses.own[:, :, POSE_STAMP]):
            times[rows] += later
        minds.poses.row_table[rows, ROW_TEAM] = world
        for buffer, saved in zip(minds.buffers.values(), state.buffers, strict=True):
            put_team_state(buffer, world, saved, later)
        for generators, streams in zip(minds.generators, state.streams, strict=True):
            generators[rows] = [generator_at(stream) for stream in streams]
        self._clock.reset(world, state.ticks)
        self._agendas.put(world, state.agenda)
        self._floor.restore(world)
        minds.restore()
        self._team.restore()

    def _slice(self, world: int) -> slice:
        return slice(world * self._floor.robots, (world + 1) * self._floor.robots)


def likeness_of(arrays: Iterable[NDArray[Any]]) -> tuple[tuple[tuple[int, ...], str], ...]:
    """Return the shape of one row and the type of each array."""
    return tuple((array.shape[1:], array.dtype.str) for array in arrays)


def bytes_of(arrays: Iterable[NDArray[Any]], part: slice) -> bytes:
    """Return a part of each array, one after the other."""
    return b"".join([array[part].tobytes() for array in arrays])


def fill(arrays: Iterable[NDArray[Any]], part: slice, data: bytes) -> None:
    """Write into arrays what `bytes_of` took."""
    begin = 0
    for array in arrays:
        place = array[part]
        place[:] = np.frombuffer(data, array.dtype, place.size, begin).reshape(place.shape)
        begin += place.nbytes


def states_of(generators: Sequence[np.random.Generator | None]) -> Streams:
    """Return the states of generators."""
    return [None if generator is None else dict(generator.bit_generator.state) for generator in generators]


def generator_at(state: dict[str, Any] | None) -> np.random.Generator | None:
    """Return a new generator in a state."""
    if state is None:
        return None
    made: Any = np.random.PCG64(0)
    made.state = state
    return np.random.Generator(made)
