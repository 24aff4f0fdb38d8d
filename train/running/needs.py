"""The check of what an evaluation or a training needs: it is refused in one line where the machine has less."""

import os
from dataclasses import dataclass
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.mission import MissionConfig
from train.running.estimate import PROCESS, needs_of

LONGEST = 7 * 86_400.0
"""Longest estimated time of a command [s]: nobody waits longer without knowing."""
LONGEST_TICK = 5.0
"""Longest estimated time of a control period [s]; the estimate is coarse, and compiled code hears no Ctrl-C."""
CONTROL_GROUP = Path("/sys/fs/cgroup/memory.max")
"""File in which Linux says how much memory the processes of a container may use together [byte]."""
DURATIONS = ((86_400.0, "days"), (3600.0, "h"), (60.0, "min"), (1.0, "s"))


@dataclass(frozen=True)
class Machine:
    """What a command may use."""

    workers: int = 1
    """Processes."""
    forced: bool = False
    """Whether to run what the machine is estimated to be too small for."""
    place: str | None = None
    """Where missions run; in processes of this machine unless given."""


ALONE = Machine()
"""One process."""


@dataclass(frozen=True)
class Workload:
    """Missions to run."""

    mission: MissionConfig
    """The largest of them."""
    missions: int
    """Their number."""
    worlds: int = 1
    """Worlds side by side in each process."""


def check_needs(workload: Workload, machine: Machine) -> None:
    """Raise ConfigurationError if missions need more memory or time than the limits, unless they are forced.

    The limits are those of memory, of the time of all missions (`LONGEST`), and of a control period (`LONGEST_TICK`).
    """
    needs, processes = needs_of(workload.mission), min(machine.workers, workload.missions)
    at_once = processes * workload.worlds
    tick_time = workload.worlds * needs.tick_time
    estimates = (
        ("memory", processes * PROCESS + at_once * needs.memory, memory_of_machine(), _bytes),
        ("time", workload.missions * needs.time / processes, LONGEST, _duration),
        ("time for a control period, in which Ctrl-C waits", tick_time, LONGEST_TICK, _duration),
    )
    for what, needed, there, in_words in estimates:
        if needed > there and not machine.forced:
            missions = f"{workload.missions} missions, {at_once} at a time"
            size = f"of up to {needs.robots} robots, {needs.items} items and {needs.ticks} ticks"
            limit = f"expected at most {in_words(there)} of {what}, got about {in_words(needed)}"
            raise ConfigurationError(f"{missions}, {size}: {limit}; --force starts them anyway")


def memory_of_machine() -> float:
    """Return the memory that the processes of this machine or container may use [byte]; infinite if unknown."""
    try:
        there = float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # not a POSIX system
        return float("inf")
    limit = CONTROL_GROUP.read_text(encoding="ascii").strip() if CONTROL_GROUP.is_file() else ""
    return min(there, float(limit)) if limit.isdecimal() else there


def _bytes(number: float) -> str:
    return f"{number / 1e9:,.1f} GB"


def _duration(seconds: float) -> str:
    size, unit = next(((size, unit) for size, unit in DURATIONS if seconds >= size), DURATIONS[-1])
    return f"{seconds / size:,.1f} {unit}"
