"""Cleaning: robots find garbage, carry it to a recycling station, then the rest of it to a dump.

Items and stations lie on the floor (`world.floor`); behaviours carry out what compiled stages of the tick do with them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.world.cleaning.cleaning_robot import CargoMemory, robot_network
from clean_swarm_env.world.cleaning.garbage import LYING
from clean_swarm_env.world.cleaning.tick_kernels import (
    begin_commands,
    handle_cargo_as_decided,
    handle_cargo_in_reach,
    read_sensors,
)
from clean_swarm_env.world.minds import ITEM_CHANNEL
from clean_swarm_env.world.reception import Reception
from clean_swarm_env.world.task import Task, trail_settings
from clean_swarm_env.world.task_parts import Measure, TaskState
from clean_swarm_env.world.view import World
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_network import RobotNetwork
from selforg.arrays import Flags, Floats, Ints
from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, MovementMechanism, Patrol, Pheromone
from selforg.randomness import DirectionStream

PHEROMONES: Final = "pheromone"
"""Channel of the pheromones that patrolling robots deposit."""


@TASKS.register
class Cleaning(Task[TaskSettings, TaskState]):
    """All garbage has to be recycled and dumped; see `docs/cost.md` for what a mission costs.

    Attributes:
        cargo_memory: what configurations know of the robots' cargo, and ask for.

    """

    story = "robots find garbage, carry it to the recycling station and what is left to the dump, and keep clear"
    measures = (Measure("duration", "s", "lower", 600.0, "a minute an item"),)
    baseline = ""
    thinks_when_driven = False
    handling = ("PickGarbage", "Recycle", "Dump")
    transport = ("MoveToRecycling", "MoveToDump")

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.cargo_memory = CargoMemory(world.memory)

    @classmethod
    def robot(
        cls, mission: MissionConfig, models: Sequence[CoordinatorModel], directories: Sequence[Path]
    ) -> RobotNetwork:
        """Return the network of the robot's document."""
        return robot_network(mission.network, models, directories)

    @classmethod
    def buffers(cls, mission: MissionConfig, poses: OwnPoses, reception: Reception) -> dict[str, SoBuffer]:
        """Return the buffers of garbage, of traces of the patrol, of stations, and of everything else."""
        space = poses.space
        newest = BufferSettings(mission.garbage.view_distance, {"DEFAULT": "new"}, aggregation_distance=0.0)
        items = SoBuffer(newest, space, poses)
        pheromones = SoBuffer(trail_settings(mission.patrol), space, poses, reception.delivery())
        return {
            "gradients": SoBuffer(BufferSettings(), space, poses),
            "items": items,
            "pheromones": pheromones,
            "stations": SoBuffer(replace(newest, view_distance=np.inf), space, poses),
        }

    @classmethod
    def movers(
        cls, mission: MissionConfig, buffers: Mapping[str, SoBuffer], directions: DirectionStream
    ) -> dict[str, MovementMechanism]:
        """Return the mechanisms of MoveToGarbage and Patrol."""
        patrol = mission.patrol
        pheromone = Pheromone(PHEROMONES, -1, patrol.diffusion, patrol.evaporation_factor, patrol.evaporation_period)
        return {
            "MoveToGarbage": ChemotaxisBalch(buffers["items"], channels=(ITEM_CHANNEL,), directions=directions),
            "Patrol": Patrol(
                buffers["pheromones"],
                pheromone=pheromone,
                min_speed=patrol.min_speed,
                max_speed=patrol.max_speed,
                channels=(PHEROMONES,),
                directions=directions,
            ),
        }

    def reset(self, world: int, rows: slice) -> None:
        """Show items and stations of a world."""
        floor, minds, now = self.world.floor, self.world.minds, self.world.now
        garbage = floor.garbage
        minds.show_items(world, garbage.positions[world, garbage.stage[world] == LYING], now)
        minds.show_stations(world, floor.stations[world], now)

    def sense(self) -> None:
        """Write the robots' own sensors into the readings."""
        floor, minds = self.world.floor, self.world.minds
        read_sensors(floor.packed.words, minds.packed.words)
        record = floor.packed.record
        self.cargo_memory.tell(record.recycled, record.leg, minds.network.readings)

    def after_deciding(self) -> None:
        """Pick, recycle and dump where these behaviours have just started."""
        self._hide(handle_cargo_as_decided(self.world.floor.packed.words, self.world.minds.packed.words))

    def follow(self, vectors: Floats, working: Flags) -> None:
        """Drive robots by vectors (R, 2) [m/s]; those `working` (R,) pick, recycle and dump wherever they can."""
        floor, minds = self.world.floor, self.world.minds
        read_sensors(floor.packed.words, minds.packed.words)
        self._hide(handle_cargo_in_reach(floor.packed.words, minds.packed.words, working))

    def command(self, commands: Commands) -> None:
        """Command the ways to the nearest stations, and list the rows in which each mover runs."""
        begin_commands(self.world.floor.packed.words, self.world.minds.packed.words, commands.packed.words)

    def after_acting(self, commands: Commands) -> None:
        """Leave the commands as they are."""

    def after_leaving(self) -> None:
        """Put down the cargo for which options have asked, unless the robot stands after a collision."""
        asked = self.cargo_memory.handed
        if asked is None:
            return
        floor = self.world.floor
        for row in np.flatnonzero(asked).tolist():
            place, blind = floor.physics.positions[row], max(round(asked[row] / self.world.period), 1)
            if not floor.consequences.standing[row] and floor.garbage.hand_over(row, place, blind):
                self.world.minds.show_items(row // floor.robots, place[None], self.world.now)
        asked[:] = 0.0

    def hide_items(self, worlds: Ints, places: Floats) -> None:
        """Delete the gradients of items that lay at `places` (K, 2) [m] of `worlds` (K,), unless others lie there."""
        minds, now = self.world.minds, self.world.now
        minds.hide_items(worlds, places, now)
        others = self.world.floor.left_at(worlds, places)  # their gradients were one
        if len(others[0]):
            minds.show_items(*others, now)

    def done(self) -> Flags:
        """Return where all garbage that has come is dumped."""
        garbage = self.world.floor.garbage
        done: Flags = garbage.done == garbage.arrived
        return done

    def result(self) -> dict[str, Floats]:
        """Return the time of each mission so far."""
        return {"duration": self.world.seconds}

    def _hide(self, picked: int) -> None:
        """Hide the first `picked` items picked in this tick."""
        if picked:
            self.hide_items(*self.world.floor.picked(picked))


def cleaning_of(task: Task[Any, Any]) -> Cleaning:
    """Return the task as one of cleaning; ValueError for any other."""
    if not isinstance(task, Cleaning):
        raise ValueError(f"expected the task Cleaning, got {task.name}")
    return task
