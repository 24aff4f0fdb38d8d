"""The bodies of a mission whose robots decide elsewhere, one process each: what they sense, and how they move.

In lock step the mission has, bit for bit, the course that it has in one process.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.given import GivenMission, mission_from
from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import HANDLING, SeenItem, Sensed, Wheels
from clean_swarm_env.tasks.cleaning.garbage import LYING
from clean_swarm_env.tasks.cleaning.task import Cleaning
from clean_swarm_env.world.mission import MissionResult, result_of
from clean_swarm_env.world.mission_end import RUNNING, mission_state
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from examples.robots.air import MissionAir
from selector.configurations.library import library_of
from selector.documents.errors import DocumentError
from selforg.network import state as st
from selforg.program import AFTER_DECIDING, MOVE, SENSE, STARTING, TELLING, Program, Step

NEAR: Final = 2.0
"""Distance up to which a robot senses other bodies [m]."""


class ServedBodies:
    """One world of a mission, with the physics and grippers of its robots, but without their minds.

    In each control period call `sense`, `handle` with what robots begin to handle, and `move` with their wheels.

    >>> bodies = ServedBodies("table1")
    >>> robots = [RobotProcess("table1", number) for number in range(5)]
    >>> while bodies.running:
    ...     tick_together(bodies, robots)

    Attributes:
        worlds: the world.
        air: what brings robots what others say.

    With `record` a recording is written that `clean-swarm replay` plays.

    """

    def __init__(
        self,
        mission: GivenMission,
        start: StartConfiguration | None = None,
        seed: int = 0,
        directories: Sequence[Path] = (),
        record: RecordSettings | None = None,
    ) -> None:
        given, own = mission_from(mission, tuple(directories)), tuple(directories)
        if any(given.of_each(key).any() for key in ("pose_noise", "pose_drift", "slip")):
            raise DocumentError(
                f"mission {given.name}: expected exact poses and wheels, which the bodies decide; got errors"
            )
        models = coordinators_of(given, knowledge_of(given, own), library_of(own), own)
        self.worlds = worlds = Worlds(given, models, 1, directories=own)
        worlds.reset(0, start or random_start(given, seed, 0), seed)
        self._task: Any = worlds.task
        self._any_way = np.array([model.drive == "holonomic" for model in given.robots.models])[given.models]
        self.air = MissionAir(worlds)
        self._recorder = MissionRecorder(worlds, record) if record else None
        if self._recorder:
            self._recorder.open(0, {"seed": seed})
        self._handling, self._moving = Program(self._handling_steps), Program(self._moving_steps)

    @property
    def running(self) -> bool:
        """Whether the mission is not over."""
        worlds = self.worlds
        state = mission_state(bool(worlds.done[0]), int(worlds.ticks[0]), int(worlds.world.limits[0]))
        return bool(state == RUNNING)

    @property
    def result(self) -> MissionResult:
        """The figures of the mission."""
        return result_of(self.worlds, 0)

    def sense(self) -> list[Sensed]:
        """Return what each robot senses at the beginning of a control period."""
        self.worlds.agendas.apply_due()
        return [self._sensed(row, int(self.worlds.collisions.entered_in_tick[row])) for row in range(self.worlds.rows)]

    def handle(self, begun: Sequence[Sequence[str]]) -> list[Sensed]:
        """Let robots handle items as they have `begun` (N,), in their order; return what each senses then."""
        worlds = self.worlds
        if isinstance(self._task, Cleaning):
            columns = self._task.movers.packed.record.handling
            for layer in (st.STARTED, st.EXECUTING):
                worlds.network.state.marks[:, layer, columns] = [[name in one for name in HANDLING] for one in begun]
        self._handling.run(worlds.now)
        return [self._sensed(row, 0) for row in range(worlds.rows)]

    def move(self, wheels: Sequence[Wheels]) -> None:
        """Let robots drive for a control period."""
        worlds, drive = self.worlds, self.worlds.floor.drive
        given = worlds.minds.commands
        given.clear()
        given.vectors[:] = [one.vector for one in wheels]
        given.commanded[:] = self._any_way & given.vectors.any(axis=1)
        drive.speed[:], drive.turn_rate[:] = [one.speed for one in wheels], [one.turn_rate for one in wheels]
        drive.packed.record.commanded_at[:] = worlds.now
        self._moving.run(worlds.now)
        self.record()

    def show_options(self, held: Sequence[Sequence[int]]) -> None:
        """Let the recording, if there is one, have the options (N, C) that robots hold."""
        if self._recorder:
            self.worlds.hold(np.array(held))

    def record(self) -> None:
        """Record the control period that has ended, if that was asked for; a mission that is over ends its file."""
        if self._recorder:
            self._recorder.record()

    def close(self) -> None:
        """Write what is not in the recording yet."""
        if self._recorder:
            self._recorder.close()

    def _handling_steps(self) -> list[Step]:
        """Return the steps of a tick in which items are handled."""
        worlds = self.worlds
        own = [step for step in self._task.steps(worlds.minds.commands) if step.stage in (SENSE, AFTER_DECIDING)]
        return [*worlds.steps_of(STARTING, STARTING), *own]

    def _moving_steps(self) -> list[Step]:
        """Return the steps of a tick from driving on."""
        return self.worlds.steps_of(MOVE, TELLING)

    def _sensed(self, row: int, collisions: int) -> Sensed:
        """Return what a robot senses now."""
        physics, task, worlds = self.worlds.physics, self._task, self.worlds
        others = np.flatnonzero(physics.present & (np.arange(worlds.rows) != row))
        away = worlds.floor.ground.distances(physics.positions[row], physics.positions[others])
        held: dict[str, Any] = {}
        if isinstance(task, Cleaning):
            garbage = task.garbage
            lying = np.flatnonzero(garbage.stage[0] == LYING).tolist()
            places, leftover = garbage.positions[0].tolist(), garbage.leftover[0].astype(bool).tolist()
            held["items"] = {item: SeenItem(*places[item], leftover[item]) for item in lying}
            held["cargo"], held["recycled"] = tuple(garbage.load(row).tolist()), bool(garbage.recycled[row])
        return Sensed(
            worlds.now,
            *physics.positions[row].tolist(),
            float(physics.headings[row]),
            collisions,
            tuple((x, y) for x, y in physics.positions[others[away <= NEAR]].tolist()),
            **held,
        )


def tick_together(bodies: ServedBodies, robots: Sequence[RobotProcess]) -> None:
    """Run one control period of bodies and all their robots in lock step, who hear what the mission delivers."""
    now = bodies.worlds.now
    for robot, sensed in zip(robots, bodies.sense(), strict=True):
        robot.sense(sensed)
    bodies.air.carry_left([robot.tell(now) for robot in robots], robots)
    bodies.air.carry_said([robot.say(now) for robot in robots], robots)
    begun = [robot.decide(now) for robot in robots]
    bodies.show_options([[one.held[robot.row] for one in robot.worlds.coordinators] for robot in robots])
    for robot, sensed in zip(robots, bodies.handle(begun), strict=True):
        robot.sense(sensed)
    bodies.move([robot.act(now) for robot in robots])
