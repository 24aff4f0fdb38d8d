"""What the robots of W worlds know and decide: poses, buffers, messages, networks, coordinators, knowledge.

Rows are robots, R = W * N. Bodies are on the `floor`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.errors import Errors
from clean_swarm_env.physics.motion import RobotMotion, open_robot_motion
from clean_swarm_env.physics.physics import Physics
from clean_swarm_env.physics.rays import BodiesAround
from clean_swarm_env.world.ground import Ground, walls_of
from clean_swarm_env.world.reception import Reception, pose_history
from selector.configurations.host import Host, host_memory
from selector.coordination.coordinator import Coordinator
from selector.coordination.model import CoordinatorModel
from selector.coordination.robots import CoordinatedRobots
from selector.documents.errors import DocumentError
from selforg.arrays import KEPT, Flags, Floats, Ints
from selforg.commands import Commands
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Written
from selforg.components.facts import SHARED_FACTS, FactRule, SharedFact
from selforg.components.memory import RobotMemory
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import PoseDelivery
from selforg.gradients.poses import OwnPoses, update_poses
from selforg.gradients.store.records import Poses
from selforg.network.planning.planner import planner_named
from selforg.program import BEGINNING, Rows, Step
from selforg.randomness import DirectionStream
from selforg.registry import unknown

POSE_NOISE, POSE_DRIFT = 0xFFFFFFFC, 0xFFFFFFF7
"""Spawn keys of the streams of errors of poses in a world; other streams have other keys."""
POSE_DRIFT_TIME = 20.0
"""Time in which a drift falls to 1/e [s]."""


class Minds:
    """The owner of all arrays of poses, buffers, networks and knowledge.

    Attributes:
        poses: the pose gradients of the robots.
        reception: the delivery of messages.
        buffers: by name; those of the task, and that of the facts, if there are any.
        facts: what robots tell each other, by name: those of their documents, and what `share` adds.
        memory: knowledge of every robot, shared by all options.
        known: returns what robots know from the start on: name -> (R,).
        surroundings: what rays from the robots meet; the worlds say what that is.
        directions: random directions, one stream a row.
        robot: the network of a robot as it is declared.
        robots: networks, coordinators and nested networks of the robots.
        network: the robots' behaviour networks.
        coordinators: (C,) one for each goal that the robot's document coordinates, in its order.
        nested: the networks inside other behaviours of the robot's document.
        commands: the commands to the robots in this tick.

    """

    _chances: Annotated[list[np.random.Generator], "R", KEPT]  # of mechanisms

    def __init__(
        self,
        mission: MissionConfig,
        models: Sequence[CoordinatorModel],
        worlds: int,
        task: Any,  # noqa: ANN401  (a class of `Task`, which stands above this module)
        directories: Sequence[Path] = (),
        explained: bool = False,
    ) -> None:
        self.rows = worlds * mission.rows
        self.known: Callable[[], Mapping[str, Floats]] = dict
        self.surroundings = BodiesAround()
        self._build_buffers(mission, worlds, task)
        self._build_network(mission, models, task, directories, explained)
        self.commands = Commands(self.rows, 2)

    def _build_buffers(self, mission: MissionConfig, worlds: int, task: Any) -> None:  # noqa: ANN401
        space = Ground.of(mission).space
        self.reception = Reception(mission, worlds, self.rows)
        noise, drift = (np.tile(mission.of_each(key), worlds) for key in ("pose_noise", "pose_drift"))
        lasting = POSE_DRIFT_TIME * mission.world.control_rate
        each = Errors(POSE_NOISE, noise), Errors(POSE_DRIFT, drift, lasting)
        self._pose_errors = [one for one in each if not one.none]
        self.poses = OwnPoses(
            space,
            self.rows,
            np.repeat(np.arange(worlds), mission.rows),
            diffusion=np.tile(mission.of_each("pose_diffusion"), worlds),
            goal_radius=np.tile(mission.of_each("pose_goal_radius"), worlds),
            history=pose_history(mission),
            hearing=mission.own_contents,
            walls=walls_of(mission) if mission.world.has_walls else None,
        )
        own, delay = self.reception.own_contents, self.reception.delay_ticks
        self._pose_delivery = PoseDelivery(self.poses, self.reception.delivery(), delay) if own else None
        self.directions = DirectionStream([np.random.default_rng(0)] * self.rows)
        self.buffers: dict[str, SoBuffer] = task.buffers(mission, self.poses, self.reception)
        self._delayed = [buffer for buffer in self.buffers.values() if buffer.delivery.delay > 0.0]

    def _build_network(
        self,
        mission: MissionConfig,
        models: Sequence[CoordinatorModel],
        task: Any,  # noqa: ANN401
        directories: Sequence[Path],
        explained: bool,
    ) -> None:
        robot = self.robot = task.robot(mission, models, directories)
        self.facts: dict[str, SharedFact] = {}
        planner = planner_named(robot.model, mission.network.planner)
        configurations = [configuration for model in models for configuration in model.configurations]
        self._chances = [np.random.default_rng(0)] * self.rows
        specs = [*configurations, *robot.all_specs()]
        self.memory: RobotMemory = host_memory(specs, self.rows)
        named = [model.document or mission.network.robot for model in mission.robots.models]
        order = list(dict.fromkeys([mission.network.robot, *named]))
        of_model = np.array([order.index(name) for name in named], dtype=np.int64)
        documents = np.tile(of_model[mission.models], self.rows // mission.rows)
        lacking = [left_out.facts for left_out in robot.left_out] or [()]
        told = {*task.notices, *(name for spec in specs for name in spec.referred("fact", "behaviours"))}
        for name, rule in robot.facts.items():
            if name not in told:
                why = f"no action tells it and no robot notices it: {unknown('fact', name, sorted(told))}"
                raise DocumentError(f"robots of {mission.network.robot}: facts: {why}")
            self.share({name: rule}, np.array([name not in lacks for lacks in lacking])[documents])
        host = Host(
            self.poses,
            self.buffers,
            self.directions,
            self._chances,
            self.memory,
            facts=self.facts,
            surroundings=self.surroundings,
        )
        self.robots = CoordinatedRobots(
            models, host, network=robot, planner=planner, explained=explained, documents=documents
        )
        self.network, self.coordinators, self.nested = self.robots.network, self.robots.coordinators, self.robots.inner

    def share(self, rules: Mapping[str, FactRule], knows: Flags | None = None) -> None:
        """Let robots, those marked in `knows` (R,) if given, tell each other facts that they do not tell yet.

        Do so before the first tick.
        """
        for name, rule in rules.items():
            if not self.facts:
                buffer = self.buffers["facts"] = SoBuffer(
                    SHARED_FACTS, self.poses.space, self.poses, self.reception.delivery()
                )
                if buffer.delivery.delay > 0.0:
                    self._delayed.append(buffer)
            if name not in self.facts:
                self.facts[name] = SharedFact(self.buffers["facts"], name, rule, knows)

    def tell(self, noticed: Mapping[str, Flags], now: float) -> None:
        """Let robots tell at `now` [s] the facts that they know and have `noticed`, by name (R,)."""
        for name, rows in noticed.items():
            if name in self.facts:
                self.facts[name].tell(now, np.flatnonzero(rows))

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
        for errors in self._pose_errors:
            errors.reset(rows, seed)

    def reset_rows(self, rows: Ints) -> None:
        """Clear the networks and the knowledge of `rows` (K,), and what they alone have received."""
        for buffer in self.buffers.values():
            buffer.clear_rows(rows)
        self.memory.reset(rows)
        for name, values in self.known().items():
            if name in self.memory.kinds:
                self.memory[name].values[rows] = values[rows]
        self.robots.reset(rows)

    def spread_poses(self, positions: Floats, headings: Floats, now: float) -> None:
        """Spread the poses that robots at positions (R, 2) [m] with headings (R,) [rad] take for their own."""
        self.reception.locate(positions)
        for errors in self._pose_errors:
            positions = positions + errors.draw()
        self.poses.update(positions, headings, now)

    def receive(self, now: float) -> None:
        """Deliver the messages that arrive now, by the delivery of each mission."""
        if self._pose_delivery is not None:
            self._pose_delivery.deliver()
        for buffer in self._delayed:
            buffer.deliver(now)

    def beginning(self, physics: Physics) -> list[Step]:
        """Return the steps of a program that do as `spread_poses` and `receive` do."""
        rows = Rows.of(np.arange(self.rows))

        def spread(now: float, rows: Ints, not_finite: int = 0) -> None:
            self.spread_poses(physics.positions, physics.headings, now)

        steps = [Step(BEGINNING, spread, rows)]
        if not self._pose_errors and not self.reception.in_zones:
            records = physics.motion, self.poses.packed
            steps = [Step(BEGINNING, spread, rows, spread_bodies, records), *self.poses.noting_walls(rows)]
        if self.reception.own_contents:
            steps.append(Step(BEGINNING, lambda now, _: self.receive(now), rows))
        return steps

    def follow(self, vectors: Floats, rows: Flags) -> None:
        """Command the robots marked in `rows` (R,) to follow vectors (R, 2) [m/s] in place of their decisions."""
        np.copyto(self.commands.vectors, vectors)
        np.copyto(self.commands.commanded, rows)
        self.commands.in_place[:] = False


@lean_kernel
def spread_bodies(now: float, rows: Ints, motion: Handle[RobotMotion], poses: Written[Poses]) -> int:
    """Spread the pose of every body at `now` [s]; a step, see `selforg.program`.

    The result is 1 if one is not finite.
    """
    m = open_robot_motion(motion)
    return int(update_poses(m.positions, m.headings, True, now, poses) >= 0)
