"""What an evaluation or a training needs, said in words, and refused where the machine has less."""

import os
from dataclasses import dataclass
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.needs import PROCESS, needs_of

LONGEST = 7 * 86_400.0
"""Longest estimated time of a command [s]: nobody waits longer without knowing."""
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


def check_needs(plan: Workload, machine: Machine) -> None:
    """Raise ConfigurationError if a plan needs more memory than there is, or more than `LONGEST`; not if forced."""
    needs, processes = needs_of(plan.mission), min(machine.workers, plan.missions)
    memory = processes * (PROCESS + plan.worlds * needs.memory)
    time = plan.missions * needs.time / processes
    there = memory_of_machine()
    if machine.forced or (memory <= there and time <= LONGEST):
        return
    size = f"{plan.missions} missions of up to {needs.robots} robots, {needs.items} items and {needs.ticks} ticks"
    at_once = f"{processes * plan.worlds} at a time" if plan.worlds > 1 or processes > 1 else "one at a time"
    what = f"{_bytes(memory)} of memory" if memory > there else _duration(time)
    limit = _bytes(there) if memory > there else _duration(LONGEST)
    raise ConfigurationError(f"{size}, {at_once}: expected at most {limit}, got about {what}; --force runs them anyway")


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
