"""W worlds of N cleaning robots each, stepped together: the story of one control period.

Rows are robots, R = W * N. A world depends on its own start and seed only: alone or in a batch it takes the same
course.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.frames import check_frame
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.physics import Physics
from clean_swarm_env.world.delivery import Reception, pose_history
from clean_swarm_env.world.events import Agendas
from clean_swarm_env.world.garbage import NOTHING, Garbage, handle_cargo
from clean_swarm_env.world.littering import ITEMS, store_items
from clean_swarm_env.world.robot import cargo_in_reach, robot_model
from clean_swarm_env.world.team import Team
from clean_swarm_env.world.tick_kernels import WORLD_TABLES, begin_to_act, sense
from selector.configurations.host import Host, host_memory
from selector.coordination.coordinator import Coordinator
from selector.coordination.model import CoordinatorModel
from selector.coordination.robots import hold_options
from selforg.components import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, Patrol, Pheromone
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.names import planner_named
from selforg.randomness import DirectionStream
from selforg.space import Torus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

PHEROMONES = "pheromone"  # channel
CLOCK_GRID = 2.0**-30
"""Times of the buffers are multiples of this [s]: exact up to 2^23 s, and too long by 5e-9 at most."""


class Worlds:
    """The batch of worlds of one mission.

    Call `reset` for every world, then `tick` as long as you like; between ticks `hold` says which options serve the
    coordinated goals in which robot. `ticks` (W,) counts control periods since the reset of each world; `stations`
    (W, 2, 2) [m] are the places of recycling and dump. With `explained` the robots' networks also note why each
    behaviour runs or does not; the course is the same.

    Attributes:
        coordinators: (C,) of the goals that the robot's document coordinates, in its order.

    """

    def __init__(
        self,
        mission: MissionConfig,
        coordinators: CoordinatorModel | Sequence[CoordinatorModel],
        worlds: int = 1,
        *,
        directories: Sequence[Path] = (),
        explained: bool = False,
    ) -> None:
        self.mission = mission
        self.worlds, self.robots = worlds, mission.rows
        self.rows = worlds * self.robots
        self.period = 1.0 / mission.world.control_rate
        self._substeps = mission.world.physics_steps_per_tick
        # On a grid that floats hold exactly, times are sums without rounding: how long ago something was does not
        # depend on when its world was reset. Rounded up, so that a period of whole ticks is over with the last one.
        self._clock_period = float(np.ceil(self.period / CLOCK_GRID) * CLOCK_GRID)
        self._now_ticks = 0
        self._begun: Ints = np.zeros(worlds, dtype=np.int64)  # (W,) tick of the batch at which each world was reset
        self.missions = [mission] * worlds
        self.extent = np.array([mission.world.width, mission.world.height])
        self._build_world()
        self._build_stack()
        models = (coordinators,) if isinstance(coordinators, CoordinatorModel) else tuple(coordinators)
        self._build_robots(models, directories, explained)
        self.team = Team(self)
        self.agendas = Agendas(self)
        self._commanded = np.zeros(self.rows, dtype=np.bool_)
        self._entered: Ints = np.zeros(self.rows, dtype=np.int64)
        self._vectors: Floats = np.zeros((self.rows, 2))
        self._steered: Floats | None = None
        self._in_reach: Ints = np.zeros((self.rows, 3), dtype=np.int64)
        self._commands = Commands(self._vectors, self._commanded, np.zeros(self.rows, dtype=np.bool_))
        self._picked: Ints = np.zeros((self.rows, 2), dtype=np.int64)
        self._running: Ints = np.zeros((len(self._movers), self.rows), dtype=np.int64)
        self._counts: Ints = np.zeros(len(self._movers), dtype=np.int64)
        garbage, network, commands = self.garbage, self.network, self._commands
        self._tables = WORLD_TABLES.bundle(
            self.physics.positions, self.extent, self.stations, self._limits, garbage.positions, garbage.stage,
            garbage.leftover, garbage.cargo, garbage.recycled, garbage.done, self._nearest, self._picked,
            network.readings, network.state.mark_table, self._cargo, self._transport, self._movers, commands.vectors,
            commands.commanded, commands.in_place, self._running, self._counts,
        )  # fmt: skip

    def _build_world(self) -> None:
        mission, world, robots = self.mission, self.mission.world, self.mission.robots
        self.physics = Physics(
            self.worlds, self.robots, world.width, world.height, robots.radius, world.contacts,
            1.0 / world.physics_rate, robots.mass,
        )  # fmt: skip
        self.collisions = CollisionCounter(
            self.worlds, self.robots, world.width, world.height, mission.collision_distances
        )
        self.drive = DifferentialDrive(
            self.rows, robots.max_speed, robots.max_turn_rate, robots.turn_gain, robots.turn_in_place_beyond,
            robots.command_timeout,
        )  # fmt: skip
        self.garbage = Garbage(self.worlds, mission.item_rows, self.robots)
        self.stations = np.tile([mission.stations.recycling, mission.stations.dump], (self.worlds, 1, 1))
        garbage = mission.garbage
        seen = garbage.diffusion + garbage.goal_radius + garbage.view_distance
        self._limits = np.array([seen, garbage.at_distance, mission.stations.reach, garbage.pick_distance])
        self._nearest: Ints = np.full(self.rows, NOTHING)  # (R,) item that each robot would take

    def _build_stack(self) -> None:
        mission, patrol = self.mission, self.mission.patrol
        space = Torus(mission.world.width, mission.world.height)
        self.reception = Reception(mission, self.worlds, self.rows)
        self.poses = OwnPoses(
            space, self.rows, np.repeat(np.arange(self.worlds), self.robots),
            diffusion=mission.robots.pose_diffusion, goal_radius=mission.robots.pose_goal_radius,
            history=pose_history(mission), hearing=mission.own_contents,
        )  # fmt: skip
        self.reception.hear(self.poses)
        self.directions = DirectionStream([np.random.default_rng(0)] * self.rows)
        self.items = SoBuffer(
            BufferSettings(mission.garbage.view_distance, {"DEFAULT": "new"}, aggregation_distance=0.0),
            space,
            self.poses,
        )
        self.pheromones = SoBuffer(
            BufferSettings(
                patrol.view_distance, {"DEFAULT": "max"}, patrol.aggregation_distance, patrol.min_diffusion
            ), space, self.poses, self.reception.delivery(),
        )  # fmt: skip
        self.gradients = SoBuffer(BufferSettings(), space, self.poses)
        self._buffers = {"gradients": self.gradients, "items": self.items, "pheromones": self.pheromones}
        self.to_garbage = ChemotaxisBalch(self.items, channels=(ITEMS,), directions=self.directions)
        pheromone = Pheromone(PHEROMONES, -1, patrol.diffusion, patrol.evaporation_factor, patrol.evaporation_period)
        self.patrol = Patrol(
            self.pheromones, pheromone=pheromone, min_speed=patrol.min_speed, max_speed=patrol.max_speed,
            channels=(PHEROMONES,), directions=self.directions,
        )  # fmt: skip

    def _build_robots(self, models: Sequence[CoordinatorModel], directories: Sequence[Path], explained: bool) -> None:
        model = robot_model(self.mission.network, models, directories)
        planner = planner_named(model, self.mission.network.planner)
        self.network = BehaviourNetwork(model, self.rows, planner, explained)
        self._chances = [np.random.default_rng(0)] * self.rows
        self._knowledge = host_memory((spec for m in models for spec in m.configurations), self.rows)
        host = Host(self.poses, self._buffers, self.directions, self._chances, self._knowledge)
        self.coordinators = tuple(Coordinator(m, self.network, host, explained=explained) for m in models)
        index = model.behaviour_index
        self._cargo = np.array([index[name] for name in ("PickGarbage", "Recycle", "Dump")])
        self._transport = np.array([index[name] for name in ("MoveToRecycling", "MoveToDump")])
        patrols = [index["Patrol"]] if "Patrol" in index else []  # unless that is coordinated
        self._movers = np.array([index["MoveToGarbage"], *patrols])

    @property
    def coordinator(self) -> Coordinator:
        """The first coordinator."""
        return self.coordinators[0]

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the reset of each world."""
        return self._now_ticks - self._begun

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self._now_ticks * self._clock_period

    def rows_of(self, world: int) -> Ints:
        """Rows (N,) of the robots of a world."""
        return np.arange(world * self.robots, (world + 1) * self.robots)

    def reset(
        self, world: int, start: StartConfiguration, seed: int | Sequence[int], mission: MissionConfig | None = None
    ) -> None:
        """Put a world at its start; `seed` decides everything random that follows in it.

        `mission`, if given, is what this world does until its next reset; it must have the frame of the batch's.
        """
        mission = mission or self.mission
        check_frame(mission, self.mission)
        rows, items = self.rows_of(world), np.array(start.items).reshape(-1, 2)
        if (len(start.robots), len(items)) != (mission.robots.count, mission.garbage.count):
            expected = f"{mission.robots.count} robots and {mission.garbage.count} items"
            raise ValueError(f"start {start.id!r}: expected {expected}, got {len(start.robots)} and {len(items)}")
        self.missions[world] = mission
        self._begun[world] = self._now_ticks
        self.stations[world] = mission.stations.recycling, mission.stations.dump
        self.garbage.place(world, items % self.extent)
        self.collisions.reset(world)
        for buffer in self._buffers.values():
            buffer.clear(world)
        streams = [np.random.default_rng(stream) for stream in np.random.SeedSequence(seed).spawn(2 * self.robots)]
        self.directions.reset(rows, streams[: self.robots])
        self._chances[rows[0] : rows[-1] + 1] = streams[self.robots :]
        store_items(self, world, items)
        self.team.begin(world, np.array(start.robots))
        self.reception.begin(world, mission, np.random.SeedSequence(seed))
        self.agendas.begin(world, mission, np.random.SeedSequence(seed))

    @property
    def cleaned(self) -> Flags:
        """Whether each world (W,) is clean for good: all garbage that ever comes is dumped."""
        clean: Flags = self.agendas.over & (self.garbage.done == self.garbage.arrived)
        return clean

    def begin_anew(self, rows: Ints) -> None:
        """Let the minds of `rows` (K,) forget everything."""
        self.drive.reset(rows)
        self.network.reset(rows)
        self._knowledge.reset(rows)
        for coordinator in self.coordinators:
            coordinator.reset(rows)

    def hold(self, options: Ints, rows: Ints | None = None) -> None:
        """Let `options` (K, C), or (K,) for one coordinator, serve the goals in `rows` (K,) or all from now on."""
        hold_options(self.coordinators, options, np.arange(self.rows) if rows is None else rows)

    def steer(self, vectors: Floats | None) -> None:
        """Let robots follow vectors (R, 2) [m/s] from the next tick on; None: their behaviours, as at first.

        Steered robots decide nothing by themselves but what to do with cargo: they pick, recycle and dump wherever
        their sensors say that they can.
        """
        self._steered = vectors

    def tick(self) -> Ints:
        """One control period of all worlds: sense, decide, act, move.

        Returns the collision events (R,) in which each robot took part, valid until the next tick.
        """
        if self._now_ticks >= self.agendas.due:
            self.agendas.let_happen(self._now_ticks)
        now = self.now
        self.poses.update(self.physics.positions, self.physics.headings, now)
        self.reception.listen()
        if self._steered is None:
            for coordinator in self.coordinators:
                coordinator.sense(now)
            sense(self._tables)
            self.network.step(self.team.at_work)
            self._act(now)
            self._move(self._vectors, self._commanded, now)
        else:
            sense(self._tables)
            cargo_in_reach(self.network.readings, self.team.working, self._in_reach)
            self._handle_cargo(self._in_reach, np.arange(3))
            self._move(self._steered, self.team.working, now)
        self._now_ticks += 1
        return self._entered

    def _handle_cargo(self, started: Ints, columns: Ints) -> None:
        """Let robots pick, recycle and dump that start to; `columns` (3,) of `started` (R, B)."""
        garbage = self.garbage
        picked = handle_cargo(
            started, columns, self.physics.positions, self.extent, self.mission.garbage.pick_distance, self._nearest,
            garbage.positions, garbage.stage, garbage.leftover, garbage.cargo, garbage.recycled, garbage.done,
            self._picked,
        )  # fmt: skip
        self._put_out(picked)

    def _put_out(self, picked: int) -> None:
        """Let the first `picked` items of the list be garbage no more that robots see."""
        if picked:
            rows, items = self._picked[:picked].T
            worlds = rows // self.robots
            self.items.extinguish(worlds, ITEMS, self.garbage.positions[worlds, items], self.now)

    def _act(self, now: float) -> None:
        """Let what runs act: handle cargo, and give every robot that moves a vector."""
        self._put_out(begin_to_act(self._tables, self.mission.garbage.pick_distance))
        to_garbage, *patrol = self._counts.tolist()
        if to_garbage:
            self.to_garbage.move_into(now, self._running[0, :to_garbage], self._vectors, self._commanded)
        patrolling = self._running[-1, : sum(patrol)]
        if patrol and patrol[0]:
            self.patrol.move_into(now, patrolling, self._vectors, self._commanded)
        for coordinator in self.coordinators:
            coordinator.act(now, self._commands)
        if patrol and patrol[0]:
            self.patrol.deposit(now, patrolling)
        for coordinator in self.coordinators:
            coordinator.leave(now)

    def _move(self, vectors: Floats, commanded: Flags, now: float) -> None:
        commands = (vectors, commanded, self._commands.in_place, now)
        self.physics.obey(self._substeps, commands, self.drive, self.collisions, self._entered)
