"""One robot by itself, as a process of a laboratory runs it: sensors in, a command for the wheels out.

Its mind is that of the simulation: a world of the mission in which only this robot decides. Bodies stand where it has
sensed them or heard of them, and no physics runs. So documents, coordinators, mechanisms, deciders and observations are
those of missions. In lock step a mission by processes has the bits of one process (tests).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.delivery import EVERYWHERE, DeliveryConfig
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import GivenMission, mission_from
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.physics.drive import update_drives
from clean_swarm_env.physics.motion import wrapped_angle
from clean_swarm_env.physics.tick import start_tick
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.hearing import EARLIEST
from clean_swarm_env.robots.items import check_cargo, handled, put_items
from clean_swarm_env.robots.sensed import POSE_BUFFER, Broadcast, Emitted, Sensed, Wheels, is_finite, is_whole
from clean_swarm_env.robots.talking import Talk
from clean_swarm_env.tasks.cleaning.task import Cleaning
from selector.documents.errors import within
from selector.documents.plain import DocumentError, must_fit, short
from selforg.program import AFTER_MOVING, COMMANDING, COUNTING, DECIDE, LEAD, MOVE, SENSE, STARTING, Program, Step

EARLY: Final = 1e-6
"""Share of a control period by which a call may come before it."""


class RobotProcess:
    """One robot of a mission: call `sense` with what it senses, `hear` with what others say, and `step` at any rate.

    In each control period of the mission it decides once; between these its wheels follow its newest heading. `say`
    returns what it has to tell the others. A robot that stands by its watchdog tells no pose. In lock step `decide` and
    `act` are the two halves of `step`, between which grippers work.

    Args:
        mission: the mission, as an environment takes it; its robots are the team.
        number: which of them this is, from 0 on.
        strategy: what chooses its options, as in `evaluate --strategy`.
        goal: the goal, or goals joined by `+`, for which the strategy chooses; unless given, the one it is made for.
        start: where robots and items are at first; it counts for the places of things only.
        seed: of the mission, from which all that is random follows.
        timeout: age of the pose at which the wheels stop [s]; that of the robot's model unless given.
        link_timeout: time without any broadcast of another robot after which they stop [s].
        directories: the user's own configurations.
        record: where what it knows is recorded, a mission with one robot that works; nowhere unless given. Its file
            gets a number behind its name where there is one already. Call `close` in the end.

    Attributes:
        mission, name, names: the mission, `robot_N`, and those of the whole team.
        worlds: its mind.
        ear: counts the broadcasts that were refused.

    >>> robot = RobotProcess("table1", 0)
    >>> robot.sense(Sensed(stamp=0.0, x=1.0, y=2.0, heading=0.0))
    >>> robot.step(0.0).stopped, robot.step(5.0).stopped
    ('', 'pose')

    """

    def __init__(
        self,
        mission: GivenMission,
        number: int,
        strategy: str = "MaxScore",
        *,
        goal: str | None = None,
        start: StartConfiguration | None = None,
        seed: int = 0,
        timeout: float = 0.0,
        link_timeout: float = np.inf,
        directories: Sequence[Path] = (),
        record: RecordSettings | None = None,
    ) -> None:
        must_fit(bool(mission), "robot: mission", "a name, a path, or keys of a mission", mission)
        named, whole = decider_named(strategy, directories), mission_from(mission, tuple(directories))
        self.mission = known_alone(whole)
        self.names = tuple(f"robot_{row}" for row in range(whole.rows))
        must_fit(
            is_whole(number) and number < whole.rows, "robot", f"a number from 0 to {whole.rows - 1}", repr(number)
        )
        must_fit(is_whole(seed), "robot: seed", "a whole number from 0 on", short(seed))
        must_fit(isinstance(record, RecordSettings | None), "robot: record", "RecordSettings", repr(record))
        self.row, self.name = number, self.names[number]
        scenario = Scenario(self.name, seed, self.mission, start or random_start(self.mission, seed, 0))
        self._batch = Batch(
            self.mission,
            source=lambda world: scenario,
            observation=named.observation(usual_terms(self.mission)),
            action=ActionConfig(mode=named.mode),
            directories=directories,
            record=record and replace(record, kept=True),
        )
        self.worlds = self._batch.worlds
        self._task: Any = self.worlds.task
        self._decided = DecidedGoal(self._batch, named.decides(goal))
        with within(strategy):
            named.check_team(self.mission.robots.count)
            self._decider = named.build(self._decided.problem, np.zeros(whole.rows, dtype=np.int64))
        leads = self._decider.is_baseline or (named.mode == "velocity" and not self._task.thinks_when_driven)
        must_fit(not leads, strategy, "a strategy that chooses options of the robot", "another")
        self._cleans = isinstance(self._task, Cleaning)
        check_cargo(self.worlds.task)
        fits = is_finite(timeout) and timeout >= 0.0
        must_fit(fits, "robot: timeout", "seconds, 0 for that of its model", short(timeout))
        may_wait = isinstance(link_timeout, Real) and link_timeout > 0.0
        must_fit(may_wait, "robot: link_timeout", "more than 0 s", short(link_timeout))
        self._talk = Talk(self.worlds, self.names, self.row, whole.delivery, self._stands)
        self.ear = self._talk.ear
        self._start(seed, timeout, link_timeout)

    def _start(self, seed: int, timeout: float, link_timeout: float) -> None:
        """Begin the mission in a mind in which the others are only heard of."""
        worlds, poses = self.worlds, self.worlds.minds.poses
        self._timeout = timeout or float(self.mission.of_each("command_timeout")[self.row])
        self._link_timeout = link_timeout
        self._batch.reset()
        self._decider.reset(worlds.rows_of(0), seed)
        worlds.team.fail(self._talk.others[worlds.team.working[self._talk.others]])
        poses.silence(self._talk.others)
        self._thinking, self._acting = Program(self._thinking_steps), Program(self._acting_steps)
        self._ending = Program(self._ending_steps)
        self._sensed: Sensed | None = None
        self._now = 0.0  # [s]
        self._decided_in = self._chosen_in = self._spread_in = -1  # control period, decision period, control period

    def sense(self, sensed: Sensed) -> None:
        """Believe what the robot senses; call it as often as there is something new."""
        must_fit(isinstance(sensed, Sensed), f"{self.name}: sense", "Sensed", sensed)
        physics, counts, row, ground = self.worlds.physics, self.worlds.collisions, self.row, self.worlds.floor.ground
        items = ((f"item {number}", one) for number, one in sensed.items.items())
        for what, (x, y, *_) in (("pose", (sensed.x, sensed.y)), *items):
            must_fit(self._talk.is_on_ground(x, y), f"sensed: {what}", self._talk.ground, (x, y))
        if self._cleans:
            put_items(self._task, row, sensed)
        physics.positions[row] = ground.space.wrap(np.array([sensed.x, sensed.y]))
        physics.headings[row] = wrapped_angle(sensed.heading)
        counts.entered_in_tick[row] += sensed.collisions
        near = np.reshape(sensed.near[: len(self._talk.others)], (-1, 2))
        physics.present[self._talk.others] = np.arange(len(self._talk.others)) < len(near)
        physics.positions[self._talk.others[: len(near)]] = ground.space.wrap(near)
        if self._sensed is None and self._batch.recorder is not None:
            self._batch.recorder.note_poses()
        self._sensed = sensed

    def tell(self, now: float) -> Broadcast:
        """Return what the robot left and noticed in the control period before that of `now` [s]; see `say`."""
        self._end(now)
        return self._talk.tell()

    def say(self, now: float) -> Broadcast:
        """Return all that the robot tells the others at `now` [s]: its pose, too, unless that is old.

        Call it once in a control period, after `sense`. In lock step call `tell` first, and let everybody hear that: it
        decides about options by what it has heard before it says where it is.
        """
        self._turn(now)
        told = self.tell(now)
        if self._spread_in < self.worlds.world.tick:
            return told
        pose = Emitted(POSE_BUFFER, self.worlds.minds.poses.gradient(self.row))
        return replace(told, emitted=(pose, *told.emitted))

    def hear(self, said: Broadcast) -> bool:
        """Take what another robot says, for the next control period; return whether it counts, see `Talk`."""
        fits = isinstance(said, Broadcast) and isinstance(said.stamp, Real)
        must_fit(fits, f"{self.name}: hear", "a Broadcast, as `Radio.decode` returns", said)
        return self._talk.hear(said, self._now)

    def step(self, now: float) -> Wheels:
        """Return what the wheels do from `now` [s] on, a time since the mission began."""
        self._turn(now)
        if self._decided_in == self.worlds.world.tick:
            return self._wheels(now, now)
        handles = self.decide(now)
        return self.act(now)._replace(handles=handles)

    def decide(self, now: float) -> tuple[str, ...]:
        """Decide for the control period of `now` [s]; return which of HANDLING begin."""
        self._turn(now)
        self._decided_in, self._talk.decided_at = self.worlds.world.tick, self.worlds.now
        self._talk.listen(poses=True)
        self._talk.forget()
        self._thinking.run(self.worlds.now)
        return handled(self._task, self.row) if self._cleans and not self._why_stopped(now) else ()

    def act(self, now: float) -> Wheels:
        """Return what the wheels do, once it is decided and items are handled."""
        self._acting.run(self.worlds.now)
        return self._wheels(now, self.worlds.now)

    def close(self) -> None:
        """Write what is not in the recording yet; a process that is killed loses at most the last 250 periods of it."""
        self._batch.close()

    def _end(self, now: float) -> None:
        """End the last control period if `now` [s] is in a later one."""
        if not is_finite(now):
            raise DocumentError(f"{self.name}: expected a finite time since the mission began, got {short(now)}")
        worlds, self._now = self.worlds, now
        behind = int(now / worlds.period + EARLY) - worlds.world.tick
        if behind > 0:
            ended = worlds.now
            self._record_missed(behind - 1)
            worlds.clock.packed.record.ticks[0] += behind - 1
            self._ending.run(ended)
            worlds.collisions.entered_in_tick[:] = 0

    def _record_missed(self, missed: int) -> None:
        """Let the recording, if there is one, keep the time: a frame for each control period that was missed."""
        if self._batch.recorder is not None:
            for _ in range(min(missed, int(self.worlds.world.limits[0]) - self.worlds.world.tick - 1)):
                self._batch.recorder.record()

    def _turn(self, now: float) -> None:
        """End the last control period, choose options by what was heard since, and spread the own pose at `now` [s]."""
        self._end(now)
        worlds, tick = self.worlds, self.worlds.world.tick
        if self._spread_in < tick:
            self._talk.listen(poses=False)
        if self._chosen_in < tick // self._batch.ticks_per_step:
            self._chosen_in = tick // self._batch.ticks_per_step
            self._choose()
        if self._spread_in < tick and not self._why_stopped(now):
            self._spread_in = tick
            worlds.minds.poses.update(worlds.physics.positions, worlds.physics.headings, worlds.now)

    def _choose(self) -> None:
        """Choose options for a decision period."""
        batch = self._batch
        batch.observer.observe(batch.observations)
        batch.choices.apply(self.worlds, self._decided.decide(self._decider, batch.observations))
        batch.progress.reset_period()

    def _stands(self) -> bool:
        """Return whether the wheels have to stand now."""
        return bool(self._why_stopped(self._now))

    def _why_stopped(self, now: float) -> str:
        """Return why the wheels have to stand at `now` [s]; empty if they need not."""
        if now < self.worlds.now - self.worlds.period or now < self.ear.wrong_until:
            return "clock"
        if self._sensed is None or not -EARLIEST <= now - self._sensed.stamp <= self._timeout:
            return "pose"
        return "link" if now - self._talk.link > self._link_timeout else ""

    def _wheels(self, now: float, at: float) -> Wheels:
        """Return what the wheels do by the last command, and the heading at `now` [s]; `at`: time of the drive [s]."""
        floor, given, row = self.worlds.floor, self.worlds.minds.commands, self.row
        if why := self._why_stopped(now):
            return Wheels(0.0, 0.0, (0.0, 0.0), (), why)
        update_drives(*given.packed.record, floor.physics.headings, at, floor.drive.packed.handle)
        x, y = given.vectors[row].tolist() if given.commanded[row] and not given.in_place[row] else (0.0, 0.0)
        return Wheels(float(floor.drive.speed[row]), float(floor.drive.turn_rate[row]), (x, y))

    def _thinking_steps(self) -> list[Step]:
        return [*self.worlds.steps_of(STARTING, STARTING), *self.worlds.steps_of(SENSE, DECIDE)]

    def _ending_steps(self) -> list[Step]:
        return [step for step in self._batch.program.steps if AFTER_MOVING <= step.stage <= COUNTING]

    def _acting_steps(self) -> list[Step]:
        """Return the steps of a tick after handling, but those that move bodies or let a baseline lead."""
        steps = self.worlds.steps_of(COMMANDING, MOVE)
        return [step for step in steps if step.stage != LEAD and step.kernel is not start_tick]


def known_alone(mission: MissionConfig) -> MissionConfig:
    """Return a mission as a robot knows it that hears the others by radio: their messages arrive, nothing else comes.

    Raises:
        DocumentError: walls or zones that stop messages, which a radio does by itself.

    """
    exact = {"message_range": EVERYWHERE, "pose_noise": 0.0, "pose_drift": 0.0, "slip": 0.0}
    robots = mission.robots.model_copy(
        update=exact
        | {"capacity": mission.rows, "groups": tuple(one.model_copy(update=exact) for one in mission.robots.groups)}
    )
    heard = DeliveryConfig(pose_memory=mission.delivery.pose_memory)
    alone = mission.model_copy(update={"robots": robots, "delivery": heard, "events": ()})
    must_fit(not alone.own_contents, f"mission {mission.name}", "walls and zones that let messages pass", "others")
    return alone
