"""When a mission ends: all garbage that ever comes is dumped, or the time is over."""

from clean_swarm_env.config.mission import MissionConfig
from selforg.compiler.decorators import part

RUNNING, COMPLETED, TIME_OVER = range(3)
"""How a mission stands."""


def tick_limit(mission: MissionConfig) -> int:
    """Return the number of control periods after which a mission is over, at least one."""
    return max(round(mission.time_limit * mission.world.control_rate), 1)


@part
def mission_state(cleaned: bool, ticks: int, limit: int) -> int:
    """Return how a mission stands after `ticks` control periods; `cleaned`: its world is clean for good."""
    if cleaned:
        return COMPLETED
    return TIME_OVER if ticks >= limit else RUNNING
