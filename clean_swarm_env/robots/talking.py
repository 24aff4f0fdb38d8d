"""What one robot tells the others and hears of them: broadcasts out of the buffers of its mind, and into them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from typing import Final

import numpy as np

from clean_swarm_env.config.delivery import DeliveryConfig
from clean_swarm_env.robots.hearing import Ear
from clean_swarm_env.robots.sensed import POSE_BUFFER, Broadcast, Emitted
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.components.sources import CLOCK_TOLERANCE
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient, check_gradient
from selforg.gradients.store import columns as c

MOST_WAITING: Final = 1_000
"""Broadcasts that wait for the next control period; more are not heard."""
MOST_HEARD: Final = 20_000
"""Gradients that a buffer holds of what was heard; more are not heard."""
MOST_TOLD: Final = 400
"""The newest gradients that a robot keeps to tell at a time; a datagram has no room for more."""


class Talk:
    """What the robot of a row says, and what others have said, in the mind of that robot.

    Args:
        worlds: the mind; its buffers give what they spread to this from now on.
        names: of the team.
        row: the robot.
        delivery: of the mission; for how long poses of others count, and when the robot has its own messages, too.
        stands: whether the robot stands by its watchdog, and tells nothing.

    Attributes:
        ear: counts the broadcasts that were refused.
        others: rows of the other robots.
        ground: words for the ground.
        link: when the newest broadcast was said that counts [s].
        decided_at: when the robot decided last [s].

    """

    def __init__(
        self, worlds: Worlds, names: Sequence[str], row: int, delivery: DeliveryConfig, stands: Callable[[], bool]
    ) -> None:
        self._worlds, self._names, self._row, self._stands = worlds, names, row, stands
        self._remembered, self._delay = delivery.pose_memory + CLOCK_TOLERANCE, delivery.delay
        self.ear, self.link, self.decided_at = Ear(names, names[row]), 0.0, 0.0
        self._sequence, self._left = -1, list[Emitted]()
        self._waiting = list[tuple[float, int, Emitted]]()  # stamp [s], row, and what was said
        self._width, self._height = map(float, worlds.floor.ground.land)
        self.ground = f"a place on the ground, {self._width:g} x {self._height:g}"
        self._beyond = float(worlds.mission.of_each("radius").max())
        self.others = np.delete(np.arange(worlds.rows), row)
        self._heard_at = np.full((worlds.rows, 2), -np.inf)  # when the last two poses of each were heard [s]
        self._buffers = {name: one for name, one in worlds.minds.buffers.items() if one.shared}
        for name, buffer in self._buffers.items():
            buffer.sent = partial(self._keep, name, buffer)

    def tell(self) -> Broadcast:
        """Return what the robot left and noticed since it was asked last."""
        left, self._left = tuple(self._left), []
        self._sequence += 1
        return Broadcast(self._names[self._row], self._sequence, self._worlds.now, left)

    def hear(self, said: Broadcast, now: float) -> bool:
        """Take what another robot says, for the next control period; return whether it counts, see `Ear`.

        What says an impossible number or a pose beside the ground does not count, nor what comes while too much waits.
        """
        if len(self._waiting) > MOST_WAITING or not all(self._is_possible(one, said.stamp) for one in said.emitted):
            self.ear.refused["impossible"] += 1
            return False
        if self.ear.refuses(said, now):
            return False
        row, self.link = self._names.index(said.robot), max(self.link, min(said.stamp, now))
        self._waiting += [(one.gradient.stamp, row, one) for one in said.emitted[:MOST_WAITING]]
        return True

    def is_on_ground(self, x: float, y: float) -> bool:
        """Return whether a place [m] is on the ground, or beyond its edge by at most the largest radius of robots."""
        return max(-x, x - self._width, -y, y - self._height) <= self._beyond

    def listen(self, poses: bool) -> None:
        """Put what has arrived into buffers, and `poses` too, in the order in which it was said."""
        waiting, self._waiting = sorted(self._waiting, key=itemgetter(0, 1)), []
        for stamp, row, emitted in waiting:
            under_way = row == self._row and stamp + self._delay > self.decided_at
            if under_way or (emitted.buffer == POSE_BUFFER and not poses):
                self._waiting.append((stamp, row, emitted))
            else:
                self._put(row, *emitted)

    def forget(self) -> None:
        """Forget poses that were heard too long ago."""
        remembered = self._worlds.now - self._heard_at <= self._remembered
        table, others = self._worlds.minds.poses.row_table, self.others
        table[others, c.ROW_POSES] = np.minimum(table[others, c.ROW_POSES], remembered[others].sum(axis=1))

    def _keep(self, name: str, buffer: SoBuffer, messages: Floats, tags: Ints, now: float) -> None:
        """Keep what the robot spreads for the others, and for itself after the mission's delay, unless it stands."""
        if self._stands():
            return
        for message, tag in zip(messages, tags, strict=True):
            if tag[c.TAG_SOURCE] == self._row:
                emitted = Emitted(name, buffer.gradient_of_message(message, tag))
                self._waiting.append((now, self._row, emitted))
                self._left = [*self._left[-MOST_TOLD:], emitted]

    def _is_possible(self, emitted: Emitted, latest: float) -> bool:
        """Return whether all fields of what was said are possible, and it is of `latest` [s] or before."""
        try:
            check_gradient(emitted.gradient, 2)
        except ValueError:
            return False
        beside = emitted.buffer == POSE_BUFFER and not self.is_on_ground(*emitted.gradient.position)
        return emitted.gradient.stamp <= latest and not beside

    def _put(self, row: int, name: str, gradient: Gradient) -> None:
        """Put a gradient that a robot spread into the poses, or a buffer that knows its channel and has room.

        A pose that is as old as those that are forgotten, or older than the one that is known, does not count.
        """
        if name == POSE_BUFFER:
            recent = self._worlds.now - gradient.stamp <= self._remembered
            if recent and self._worlds.minds.poses.set_gradient(row, gradient):
                self._heard_at[row] = self._worlds.now, self._heard_at[row, 0]
            else:
                self.ear.refused["old pose"] += 1
            return
        buffer = self._buffers.get(name)
        if buffer is None or gradient.channel not in buffer.channels or len(buffer) >= MOST_HEARD:
            self.ear.refused["channel or room"] += 1
            return
        known = {key: value for key, value in gradient.payload.items() if key in buffer.keys}
        own = replace(gradient, source=row, payload=known)
        buffer.receive(own, max(gradient.stamp, self.decided_at), row=self._row)
