"""A safety filter between what a robot decides and its wheels: it slows down and stops before what a scan shows ahead.

It knows nothing of the policy, and only ever makes a robot slower. A laboratory trusts this, and its own emergency
stop, not a trained network.
"""

from math import cos, pi
from typing import Any

from clean_swarm_env.robots.sensed import Wheels

STOP, SLOW = 0.05, 0.30
"""Gap between body and obstacle at which a robot stands, and from which it slows down [m]."""
AHEAD = pi / 3.0
"""Angle to either side of the heading that counts as ahead [rad]."""


def kept_clear(wheels: Wheels, scan: Any, radius: float) -> Wheels:  # noqa: ANN401  (a message of ROS 2, or what has its fields)
    """Return wheels that keep a robot of a `radius` [m] clear of a scan, as `sensor_msgs/LaserScan` has it.

    >>> from types import SimpleNamespace
    >>> scan = SimpleNamespace(ranges=[5.0, 0.20, 5.0], angle_min=-0.5, angle_increment=0.5, range_min=0.02)
    >>> round(kept_clear(Wheels(0.3, 0.1, (0.3, 0.0)), scan, radius=0.1).speed, 3)
    0.06
    """
    angles = (scan.angle_min + number * scan.angle_increment for number in range(len(scan.ranges)))
    beams = [(one, angle) for one, angle in zip(scan.ranges, angles, strict=True) if one >= scan.range_min]
    gap = min((one * cos(angle) - radius for one, angle in beams if abs(angle) <= AHEAD), default=SLOW)
    share = min(max((gap - STOP) / (SLOW - STOP), 0.0), 1.0)
    x, y = wheels.vector
    return wheels._replace(speed=share * wheels.speed, vector=(share * x, share * y))
