"""The check of what a command needs: it is refused in one line where the machine has less."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import disk_usage

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from train.running.estimate import FILE_COSTS, PER_NUMBER, PROCESS, needs_of

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


def check_needs(workload: Workload, machine: Machine, hint: str = "--force starts them anyway") -> None:
    """Raise ConfigurationError if missions need more memory or time than the limits, unless they are forced.

    The limits are those of memory, of the time of all missions (`LONGEST`), and of a control period (`LONGEST_TICK`);
    `hint` ends the text.
    """
    if machine.forced:
        return
    needs, processes = needs_of(workload.mission), min(machine.workers, workload.missions)
    at_once = processes * workload.worlds
    tick_time = workload.worlds * needs.tick_time
    estimates = (
        ("memory", processes * PROCESS + at_once * needs.memory, memory_of_machine(), _bytes),
        ("time", workload.missions * needs.time / processes, LONGEST, _duration),
        ("time for a control period, in which Ctrl-C waits", tick_time, LONGEST_TICK, _duration),
    )
    size = f"{needs.robots} robots, {needs.items} items and {needs.ticks} ticks"
    _check(f"{workload.missions} missions, {at_once} at a time, of up to {size}", estimates, hint)


def check_file(output: Path, amount: float, what: str, hint: str) -> str:
    """Return what a file is estimated to need, in words. `FILE_COSTS` says of what `amount` is; `what` tells of it.

    Raises:
        ConfigurationError: it is more memory, time or room than there is.

    """
    memory, time, room = (amount * each for each in FILE_COSTS.get(output.suffix.lower(), FILE_COSTS[""]))
    place = next(folder for folder in output.absolute().parents if folder.exists())
    limits = (memory_of_machine(), LONGEST, float(disk_usage(place).free))
    names, words = ("memory", "time", "room on the disk"), (_bytes, _duration, _bytes)
    _check(f"{output}: {what}", list(zip(names, (PROCESS + memory, time, room), limits, words, strict=True)), hint)
    return f"{what}, about {_duration(time)} and {_bytes(room)}"


def most_numbers() -> float:
    """Return how many numbers of recordings fit into the memory of this machine."""
    return max(memory_of_machine() - PROCESS, 0.0) / PER_NUMBER


def _check(what: str, estimates: Sequence[tuple[str, float, float, Callable[[float], str]]], hint: str) -> None:
    """Compare what is needed with what is there, of memory, time and more; each is said in words of its own."""
    for name, needed, there, in_words in estimates:
        if needed > there:
            text = f"expected at most {in_words(there)} of {name}, got about {in_words(needed)}"
            raise ConfigurationError(f"{what}: {text}; {hint}")


def memory_of_machine() -> float:
    """Return the memory that the processes of this machine or container may use [byte]; infinite if unknown."""
    try:
        there = float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # not a POSIX system
        return float("inf")
    limit = CONTROL_GROUP.read_text(encoding="ascii").strip() if CONTROL_GROUP.is_file() else ""
    return min(there, float(limit)) if limit.isdecimal() else there


def _bytes(number: float) -> str:
    return f"{number / 1e9:,.1f} GB" if number >= 1e8 else f"{number / 1e6:,.1f} MB"


def _duration(seconds: float) -> str:
    size, unit = next(((size, unit) for size, unit in DURATIONS if seconds >= size), DURATIONS[-1])
    return f"{seconds / size:,.1f} {unit}"
