"""The air between robots that are processes: range, losses and delay of a mission say who hears what, and when.

The world decides, by the rules, places and random numbers of its mission: each process is handed what the mission
delivers to its robot. So in lock step a mission with losses has, bit for bit, the course that it has in one process.
Two cases differ: flocking looks back, in one process, at poses that were lost on the way; and poses that are late by
more than the mission's `pose_memory` do not count for a process.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import POSE_BUFFER, Broadcast, Emitted
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Ints
from selforg.gradients.delivery import address
from selforg.gradients.rows import write_gradient
from selforg.gradients.store import columns as c


@dataclass(frozen=True)
class Letter:
    """A gradient under way."""

    arrival: float
    """[s]."""
    sender: int
    """Number of the robot that left it."""
    receivers: Ints
    """(K,) numbers of the robots that it reaches."""
    said: Emitted


class MissionAir:
    """Brings what robots say to those that hear it, by the delivery of the mission of `worlds`.

    In each control period call `carry_left`, then `carry_said`. Nobody is handed what it said itself: a robot keeps
    that for the mission's delay by itself.
    """

    def __init__(self, worlds: Worlds) -> None:
        self._worlds, self._minds = worlds, worlds.minds
        self._delay = self._minds.reception.delay_ticks
        self._under_way: list[Letter] = []
        self._poses: deque[dict[int, Emitted]] = deque(maxlen=self._delay + 1)  # by robot, the newest period last

    def carry_left(self, told: Sequence[Broadcast], robots: Sequence[RobotProcess]) -> None:
        """Send what robots left in the control period before; without a delay it is heard at once."""
        self._send(told)
        if self._delay == 0:
            self._hand_over(0, self._arrived(), robots)

    def carry_said(self, said: Sequence[Broadcast], robots: Sequence[RobotProcess]) -> None:
        """Let robots hear the poses, and what they left, that arrive now."""
        worlds, minds = self._worlds, self._minds
        minds.spread_poses(worlds.physics.positions, worlds.physics.headings, worlds.now)
        minds.receive(worlds.now)
        spoken = enumerate(said)
        self._poses.append({row: one for row, own in spoken for one in own.emitted if one.buffer == POSE_BUFFER})
        self._send(said)
        self._hand_over(1, [*self._poses_now(), *self._arrived()], robots)

    def _send(self, said: Sequence[Broadcast]) -> None:
        """Send all but poses; who is in range is measured, and losses are drawn, as they are sent."""
        for row, broadcast in enumerate(said):
            for one in broadcast.emitted:
                if one.buffer == POSE_BUFFER:
                    continue
                buffer = self._minds.buffers[one.buffer]
                messages, tags = buffer.blank(1, one.gradient.channel)
                write_gradient(one.gradient, buffer.space, buffer.keys, messages, tags)
                tags[:, c.TAG_SOURCE] = row
                _, copies = address(messages, tags, buffer.poses, buffer.delivery)
                arrival = one.gradient.stamp + buffer.delivery.delay
                self._under_way.append(Letter(arrival, row, copies[:, c.TAG_SPACE], one))

    def _arrived(self) -> list[Letter]:
        """Return what has arrived by now, in the order in which it was sent."""
        now = self._worlds.now
        arrived = [letter for letter in self._under_way if letter.arrival <= now]
        self._under_way = [letter for letter in self._under_way if letter.arrival > now]
        return arrived

    def _poses_now(self) -> Iterable[Letter]:
        """Return the poses that arrive now, said as long ago as the delay is."""
        count, table = self._worlds.rows, self._minds.poses.row_table
        reached = np.ones((count, count), dtype=bool)  # receiver, sender
        if self._minds.reception.own_contents:
            reached = table[:, c.ROW_HEARD : c.ROW_HEARD + count] == self._delay
        if len(self._poses) <= self._delay:
            return
        for row, pose in self._poses[0].items():
            yield Letter(self._worlds.now, row, np.flatnonzero(reached[:, row]), pose)

    def _hand_over(self, part: int, letters: Sequence[Letter], robots: Sequence[RobotProcess]) -> None:
        """Let robots hear letters, as broadcasts of this half, 0 or 1, of the control period."""
        now, number = self._worlds.now, 2 * self._worlds.world.tick + part
        for row, robot in enumerate(robots):
            for sender, name in enumerate(robot.names):
                own = tuple(one.said for one in letters if one.sender == sender and row in one.receivers)
                if own and sender != row:
                    robot.hear(Broadcast(name, number, now, own))
