"""What the nodes share: names of topics, the time of a mission, and what robots sense as text."""

import json
import os
import time
from dataclasses import asdict

from clean_swarm_env.robots.sensed import SeenItem, Sensed

RADIO = "/radio"
"""Topic of all broadcasts, `std_msgs/UInt8MultiArray`: the bytes of `clean_swarm_env.robots.radio`."""
STEADY = 20
"""Messages of a topic that wait."""
AGAIN = 0.5
"""Time after which nodes in lock step repeat what was not answered [s]."""


def stay_on_this_machine(network: bool) -> None:
    """Let ROS 2 find nodes on this machine only, unless told otherwise; call it before `rclpy.init`."""
    if not network:
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


class MissionClock:
    """Seconds since a mission began at the time `epoch` [s] of the system, `speed` times as fast.

    >>> MissionClock(epoch=time.time() - 1.0, speed=2.0).now > 1.9
    True
    """

    def __init__(self, epoch: float, speed: float = 1.0) -> None:
        self._epoch, self.speed = epoch or time.time(), speed

    @property
    def now(self) -> float:
        """Time since the mission began [s]."""
        return max((time.time() - self._epoch) * self.speed, 0.0)


def as_text(sensed: Sensed) -> str:
    """Return what a robot senses as JSON; numbers keep their bits."""
    return json.dumps(asdict(sensed))


def from_text(text: str) -> Sensed:
    """Return what a robot senses from JSON."""
    return Sensed(**sensed_in(text))


def sensed_in(text: str) -> dict:
    """Return those fields of `Sensed` that JSON has."""
    given = json.loads(text)
    fields = {
        "items": lambda items: {int(number): SeenItem(*one) for number, one in items.items()},
        "near": lambda places: tuple(tuple(one) for one in places),
        "cargo": tuple,
    }
    return {name: fields.get(name, lambda value: value)(value) for name, value in given.items()}
