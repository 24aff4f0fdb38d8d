"""Estimates of what missions and files of them need: memory, time and room, before anything is made for them.

The figures were measured on one core of an AMD EPYC with the shipped robot. They are right within a factor of three,
which is enough to tell a mission that a machine can run from one that it cannot.
"""

from dataclasses import dataclass
from math import ceil

from clean_swarm_env.config.mission import MissionConfig

PROCESS, PER_ROBOT, PER_MESSAGE, PER_POSE, PER_ITEM, PER_NUMBER = 200e6, 50e3, 300.0, 64.0, 200.0, 12.0
"""Memory of a process, of a robot, of what a robot knows of one other, of a remembered pose, of an item, and of a
number of a recording, as it is kept and once more as a value [byte]."""
TICK, ROBOT_TICK, HEARD_TICK, ITEM_TICK = 1e-4, 8e-6, 1e-6, 2e-8
"""Time of a tick, and of a robot, of a pair that hear each other, of a pair of robot and item in a tick [s]."""

FILE_COSTS = {
    ".webp": (0.0, 5e-8, 0.015),
    ".gif": (0.0, 2.5e-8, 0.01),
    ".webm": (0.0, 6e-8, 0.01),
    ".mp4": (0.0, 2.5e-7, 0.01),
    ".html": (6.0, 0.0, 1.5),
    ".mcap": (0.0, 1e-6, 1.0),
    "": (0.0, 2e-7, 0.4),
}
"""Memory [byte], time [s] and room on the disk [byte] of a file by its ending, or of a directory of tables: for a pixel
in each picture of a video, a byte of a recording on a page, a recorded number in tables."""


@dataclass(frozen=True)
class Needs:
    """What one mission needs."""

    robots: int
    """Rows for robots."""
    items: int
    """Rows for items."""
    ticks: int
    """Most control periods."""
    memory: float
    """Memory of its world, without that of the process [byte]."""
    tick_time: float
    """Time that a control period takes on one core [s]."""

    @property
    def time(self) -> float:
        """Time that it takes if it lasts as long as it may [s]."""
        return self.ticks * self.tick_time


def needs_of(mission: MissionConfig) -> Needs:
    """Return an estimate of what a mission needs."""
    robots, items = mission.rows, mission.item_rows
    pairs = robots**2 if mission.own_contents else 0
    remembered = ceil(mission.delivery.pose_memory * mission.world.control_rate) + mission.delay_ticks if pairs else 1
    return Needs(
        robots,
        items,
        ceil(mission.time_limit * mission.world.control_rate),
        robots * (PER_ROBOT + remembered * PER_POSE) + pairs * PER_MESSAGE + items * PER_ITEM,
        TICK + robots * ROBOT_TICK + pairs * HEARD_TICK + robots * items * ITEM_TICK,
    )
