"""The end of a mission: its task is done, or its time is over."""

from typing import Final

from clean_swarm_env.config.mission import MissionConfig
from selforg.compiler.decorators import part

NO_TICK: Final = 1 << 62
"""Tick of what never happens."""
RUNNING, COMPLETED, TIME_OVER = range(3)
"""States of a mission."""


def tick_limit(mission: MissionConfig) -> int:
    """Return the number of control periods after which a mission is over, at least one."""
    return max(round(mission.time_limit * mission.world.control_rate), 1)


@part
def mission_state(done: bool, ticks: int, limit: int) -> int:
    """Return the state of a mission after `ticks` control periods; `done`: its task is done."""
    if done:
        return COMPLETED
    return TIME_OVER if ticks >= limit else RUNNING
