"""What the robots of W worlds know and decide: poses, buffers, messages, networks, coordinators, knowledge.

Rows are robots, R = W * N. Bodies, items and stations are on the `floor`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.cleaning_robot import CargoMemory, robot_network
from clean_swarm_env.world.reception import Localisation, Reception, pose_history
from clean_swarm_env.world.records import MINDS, FloorRecord, MindsRecord
from clean_swarm_env.world.tick_kernels import begin_commands, read_sensors
from selector.configurations.host import Host, host_memory
from selector.coordination.coordinator import Coordinator
from selector.coordination.inner_network import inner_networks
from selector.coordination.model import CoordinatorModel
from selforg.arrays import Flags, Floats, Ints, Lasting, together
from selforg.commands import Commands
from selforg.compiler.records import Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, MovementMechanism, Patrol, Pheromone
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.names import planner_named
from selforg.randomness import DirectionStream
from selforg.registry import unknown
from selforg.space import Torus

ITEM_CHANNEL: Final = "garbage"
"""Channel of the items."""
PHEROMONES: Final = "pheromone"
"""Channel of the pheromones that patrolling robots deposit."""
STATION_CHANNELS: Final = ("recycling", "dump")
"""Channels of the stations, by their kinds."""


class Inner(Protocol):
    """A coordinator or a nested network, inside a behaviour of the robots' network."""

    def act(self, now: float, commands: Commands) -> None:
        """Decide and act where the robots' network runs this behaviour."""

    def steer(self, now: float, commands: Commands) -> None:
        """Change commands, once all movements of the robots are known."""

    def leave(self, now: float) -> None:
        """Spread and deposit what other robots perceive from the next tick on."""

    def reset(self, rows: Ints) -> None:
        """Begin anew in `rows` (K,)."""

    def lasting(self) -> Lasting:
        """Return what it hands on to the next tick."""

    def restore(self) -> None:
        """Go on from what has been written to those arrays."""


class Minds:
    """The owner of all arrays of poses, buffers, networks and knowledge.

    Attributes:
        poses: the pose gradients of the robots.
        reception: the delivery of messages.
        items, pheromones, gradients: the buffers: garbage, traces of the patrol, everything else; `buffers` has them
            by name, and that of the stations.
        directions: random directions, one stream a row.
        network: the robots' behaviour networks.
        coordinators: (C,) one for each goal that the robot's document coordinates, in its order.
        nested: the networks inside other behaviours of the robot's document.
        to_garbage, patrol: the mechanisms of MoveToGarbage and Patrol, unless a coordinator or a network inside the
            behaviour moves the robots.
        commands: the commands to the robots in this tick.
        cargo_memory: what configurations know of the robots' cargo, and ask for.
        packed: the record that compiled code takes.

    """

    def __init__(
        self,
        mission: MissionConfig,
        models: Sequence[CoordinatorModel],
        worlds: int,
        directories: Sequence[Path] = (),
        explained: bool = False,
    ) -> None:
        self.rows = worlds * mission.rows
        self._garbage = mission.garbage
        self._station_kinds: Ints = np.array(mission.stations.kinds, dtype=np.int64)
        self._build_buffers(mission, worlds)
        self._build_network(mission, models, directories, explained)
        self.commands = Commands.none(self.rows, 2)
        index = self.network.model.behaviour_index
        self.packed: Packed[MindsRecord] = MINDS.pack(
            MindsRecord(
                readings=self.network.readings,
                marks=self.network.state.mark_table,
                handling=np.array([index[name] for name in ("PickGarbage", "Recycle", "Dump")], dtype=np.int64),
                transport=np.array([index[name] for name in ("MoveToRecycling", "MoveToDump")], dtype=np.int64),
                movers=np.array([index[name] for name in self._movers], dtype=np.int64),
                starting=np.zeros((self.rows, 3), dtype=np.bool_),
                running=np.zeros((len(self._movers), self.rows), dtype=np.int64),
                counts=np.zeros(len(self._movers), dtype=np.int64),
            )
        )

    def _build_buffers(self, mission: MissionConfig, worlds: int) -> None:
        space = Torus(mission.world.width, mission.world.height)
        self.reception = Reception(mission, worlds, self.rows)
        self._localisation = Localisation(mission, self.rows)
        self.poses = OwnPoses(
            space,
            self.rows,
            np.repeat(np.arange(worlds), mission.rows),
            diffusion=mission.robots.pose_diffusion,
            goal_radius=mission.robots.pose_goal_radius,
            history=pose_history(mission),
            hearing=mission.own_contents,
        )
        self._pose_delivery = self.reception.of_poses(self.poses)
        self.directions = DirectionStream([np.random.default_rng(0)] * self.rows)
        patrol, seen = mission.patrol, mission.garbage.view_distance
        newest = BufferSettings(seen, {"DEFAULT": "new"}, aggregation_distance=0.0)
        strongest = BufferSettings(
            patrol.view_distance, {"DEFAULT": "max"}, patrol.aggregation_distance, patrol.min_diffusion
        )
        self.items = SoBuffer(newest, space, self.poses)
        self.pheromones = SoBuffer(strongest, space, self.poses, self.reception.delivery())
        self.gradients = SoBuffer(BufferSettings(), space, self.poses)
        self.buffers = {"gradients": self.gradients, "items": self.items, "pheromones": self.pheromones}
        self.buffers["stations"] = SoBuffer(replace(newest, view_distance=np.inf), space, self.poses)
        self.to_garbage = ChemotaxisBalch(self.items, channels=(ITEM_CHANNEL,), directions=self.directions)
        self.patrol = Patrol(
            self.pheromones,
            pheromone=Pheromone(PHEROMONES, -1, patrol.diffusion, patrol.evaporation_factor, patrol.evaporation_period),
            min_speed=patrol.min_speed,
            max_speed=patrol.max_speed,
            channels=(PHEROMONES,),
            directions=self.directions,
        )

    def _build_network(
        self, mission: MissionConfig, models: Sequence[CoordinatorModel], directories: Sequence[Path], explained: bool
    ) -> None:
        robot = robot_network(mission.network, models, directories)
        planner = planner_named(robot.model, mission.network.planner)
        self.network = BehaviourNetwork(robot.model, self.rows, planner, explained)
        configurations = [configuration for model in models for configuration in model.configurations]
        self._chances = [np.random.default_rng(0)] * self.rows
        self._memory = host_memory([*configurations, *robot.all_specs()], self.rows)
        self.cargo_memory = CargoMemory(self._memory)
        host = Host(self.poses, self.buffers, self.directions, self._chances, self._memory)
        self.coordinators = tuple(
            Coordinator(m, self.network, host, during=robot.during.get(m.goal, ()), explained=explained) for m in models
        )
        self.nested = inner_networks(robot, self.network, host, explained=explained)
        self._movers = {
            name: mechanism
            for name, mechanism in (("MoveToGarbage", self.to_garbage), ("Patrol", self.patrol))
            if name in robot.model.behaviour_index and name not in robot.inner
        }
        self._inner: tuple[Inner, ...] = (*self.coordinators, *self.nested)

    def coordinator_of(self, goal: str) -> Coordinator:
        """Return the coordinator of a goal; KeyError if the robot's document does not coordinate it."""
        by_goal = {coordinator.model.goal: coordinator for coordinator in self.coordinators}
        if goal not in by_goal:
            raise KeyError(unknown("coordinated goal", goal, list(by_goal)))
        return by_goal[goal]

    def reset(self, world: int, mission: MissionConfig, rows: Ints, seed: np.random.SeedSequence) -> None:
        """Clear the buffers of a world whose robots are `rows` (N,), and begin its random draws from `seed`."""
        for buffer in self.buffers.values():
            buffer.clear(world)
        streams = [np.random.default_rng(stream) for stream in seed.spawn(2 * len(rows))]
        self.directions.reset(rows, streams[: len(rows)])
        self._chances[rows[0] : rows[-1] + 1] = streams[len(rows) :]
        self.reception.reset(world, mission, seed)
        self._localisation.reset(rows, seed)

    @property
    def generators(self) -> tuple[list[Any], ...]:
        """The random draws of the rows (R,): directions, chances of mechanisms, losses of messages, errors of poses."""
        return self.directions.generators, self._chances, self.reception.generators, self._localisation.generators

    def lasting(self) -> Lasting:
        """Return what robots hand on to the next tick, but for the buffers and the random draws."""
        own = Lasting((self.poses.own, self.poses.row_table, self.directions.vectors, self.directions.cursor))
        inner = (part.lasting() for part in self._inner)
        return together((own, self.network.lasting(), self._memory.lasting(), *inner))

    def restore(self) -> None:
        """Go on from what has been written to those arrays."""
        self.directions.restore()
        for inner in self._inner:
            inner.restore()

    def reset_rows(self, rows: Ints) -> None:
        """Clear the networks and the knowledge of `rows` (K,), and what they alone have received."""
        for buffer in self.buffers.values():
            buffer.clear_rows(rows)
        self.network.reset(rows)
        self._memory.reset(rows)
        for inner in self._inner:
            inner.reset(rows)

    def show_items(self, worlds: int | Ints, positions: Floats, now: float) -> None:
        """Store the gradients of items that lie at `positions` (M, 2) [m] of one world, or of `worlds` (M,)."""
        garbage = self._garbage
        self.items.store_static(
            np.broadcast_to(worlds, len(positions)),
            ITEM_CHANNEL,
            positions,
            now,
            diffusion=garbage.diffusion,
            goal_radius=garbage.goal_radius,
        )

    def hide_items(self, worlds: Ints, positions: Floats, now: float) -> None:
        """Delete the gradients of items that lay at `positions` (M, 2) [m] of `worlds` (M,)."""
        self.items.extinguish(worlds, ITEM_CHANNEL, positions, now)

    def show_stations(self, world: int, places: Floats, now: float) -> None:
        """Store the gradients of the stations, which are at `places` (K, 2) [m], in place of those stored before."""
        buffer = self.buffers["stations"]
        buffer.clear(world)
        for kind, channel in enumerate(STATION_CHANNELS):
            buffer.store_static(world, channel, places[self._station_kinds == kind], now)

    def spread_poses(self, positions: Floats, headings: Floats, now: float) -> None:
        """Spread the poses that robots at positions (R, 2) [m] with headings (R,) [rad] take for their own."""
        self.poses.update(self._localisation.believed(positions), headings, now)

    def receive(self, now: float) -> None:
        """Deliver the messages that arrive now, by the delivery of each mission."""
        if self._pose_delivery is not None:
            self._pose_delivery.deliver()
            self.pheromones.deliver(now)

    def sense(self, floor: Packed[FloorRecord], now: float) -> None:
        """Write all sensors into the readings: those of coordinators and nested networks, and the robots' own."""
        self.sense_floor(floor)
        self.cargo_memory.tell(floor.record.recycled, floor.record.leg, self.network.readings)
        for coordinator in self.coordinators:
            coordinator.sense(now)

    def sense_floor(self, floor: Packed[FloorRecord]) -> None:
        """Write the robots' own sensors into the readings."""
        read_sensors(floor.words, self.packed.words)

    def decide(self, rows: Ints | None) -> None:
        """Step the networks of `rows` (K,), or all, so that they decide which behaviours run."""
        self.network.step(rows)

    def act(self, floor: Packed[FloorRecord], now: float) -> None:
        """Write a movement vector for every robot in which a behaviour that moves runs, and steer those that do."""
        commands = self.commands
        begin_commands(floor.words, self.packed.words, commands.packed.words)
        for mechanism, rows in self._moved():
            mechanism.move_into(now, rows, commands.vectors, commands.commanded)
        for inner in self._inner:
            inner.act(now, commands)
        for inner in self._inner:
            inner.steer(now, commands)

    def _moved(self) -> Iterator[tuple[MovementMechanism, Ints]]:
        """Return the mechanisms of this tick, and the rows that they move."""
        record = self.packed.record
        for mechanism, rows, count in zip(self._movers.values(), record.running, record.counts.tolist(), strict=True):
            if count:
                yield mechanism, rows[:count]

    def leave(self, now: float) -> None:
        """Deposit and spread what others perceive from the next tick on: pheromones of the patrol, and gradients."""
        for mechanism, rows in self._moved():
            if mechanism is self.patrol:
                self.patrol.deposit(now, rows)
        for inner in self._inner:
            inner.leave(now)

    def follow(self, vectors: Floats, rows: Flags) -> None:
        """Command the robots marked in `rows` (R,) to follow vectors (R, 2) [m/s] in place of what they decide."""
        np.copyto(self.commands.vectors, vectors)
        np.copyto(self.commands.commanded, rows)
        self.commands.in_place[:] = False
