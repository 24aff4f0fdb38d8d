"""What commands need of memory, time and room; a command is refused in one line where the machine has less.

The figures were measured on one core of an AMD EPYC with the shipped robot. They are right within a factor of three,
which is enough to tell a mission that a machine can run from one that it cannot.
"""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from shutil import disk_usage

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import item_rows
from clean_swarm_env.config.types import ConfigurationError

PROCESS, PER_ROBOT, PER_MESSAGE, PER_POSE, PER_ITEM, PER_NUMBER = 200e6, 50e3, 300.0, 64.0, 200.0, 12.0
"""Memory of a process, of a robot, of what a robot knows of one other, of a remembered pose, of an item, and of a
number of a recording, as it is kept and once more as a value [byte]."""
TICK, ROBOT_TICK, HEARD_TICK, ITEM_TICK = 1e-4, 8e-6, 1e-6, 2e-8
"""Time of a tick, and of a robot, of a pair that hear each other, of a pair of robot and item in a tick [s]."""

FILE_COSTS = {
    ".webp": (0.0, 5e-8, 0.015),
    ".gif": (0.0, 2.5e-8, 0.01),
    ".html": (6.0, 0.0, 1.5),
}
"""Memory [byte], time [s] and room on the disk [byte] of a file by its ending: for a pixel in each picture of a video,
for a byte of a recording on a page, which may have any ending."""

LONGEST = 7 * 86_400.0
"""Longest estimated time of a command [s], unless the user forces it."""
LONGEST_TICK = 5.0
"""Longest estimated time of a control period [s]; the estimate is coarse, and compiled code hears no Ctrl-C."""
CONTROL_GROUP = Path("/sys/fs/cgroup/memory.max")
"""File in which Linux says how much memory the processes of a container may use together [byte]."""
DURATIONS = ((86_400.0, "days"), (3600.0, "h"), (60.0, "min"), (1.0, "s"))


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
    """Return an estimate of the needs of a mission."""
    robots, items = mission.rows, item_rows(mission)
    pairs = robots**2 if mission.own_contents else 0
    remembered = ceil(mission.delivery.pose_memory * mission.world.control_rate) + mission.delay_ticks if pairs else 1
    return Needs(
        robots,
        items,
        ceil(mission.time_limit * mission.world.control_rate),
        robots * (PER_ROBOT + remembered * PER_POSE) + pairs * PER_MESSAGE + items * PER_ITEM,
        TICK + robots * ROBOT_TICK + pairs * HEARD_TICK + robots * items * ITEM_TICK,
    )


@dataclass(frozen=True)
class Machine:
    """What a command may use."""

    workers: int = 1
    """Processes."""
    forced: bool = False
    """Whether to run even if the machine is estimated to be too small."""
    place: str | None = None
    """Where missions run; in processes of this machine unless given."""
    threads: int = 1
    """Threads of a training that steps its worlds in one process."""


ALONE = Machine()
"""One process."""


def check_needs(
    largest: MissionConfig,
    missions: int,
    machine: Machine,
    worlds: int = 1,
    hint: str = "--force starts them anyway",
) -> None:
    """Raise ConfigurationError if missions need more memory or time than the limits, unless they are forced.

    The limits are those of memory, of the time of all missions (`LONGEST`), and of a control period (`LONGEST_TICK`).

    Args:
        largest: the largest of the missions.
        missions: their number.
        machine: what they may use.
        worlds: worlds side by side in each process.
        hint: end of the text.

    """
    if machine.forced:
        return
    needs, processes = needs_of(largest), min(machine.workers, missions)
    at_once = processes * worlds
    tick_time = worlds * needs.tick_time
    estimates = (
        ("memory", processes * PROCESS + at_once * needs.memory, memory_of_machine(), _bytes),
        ("time", missions * needs.time / processes, LONGEST, _duration),
        ("time for a control period, in which Ctrl-C waits", tick_time, LONGEST_TICK, _duration),
    )
    size = f"{needs.robots} robots, {needs.items} items and {needs.ticks} ticks"
    _check(f"{missions} missions, {at_once} at a time, of up to {size}", estimates, hint)


def check_file(output: Path, amount: float, what: str, hint: str) -> str:
    """Return the estimated needs of a file, in words. `FILE_COSTS` says of what `amount` is; `what` tells of it.

    Raises:
        ConfigurationError: it is more memory, time or room than there is.

    """
    memory, time, room = (amount * each for each in FILE_COSTS.get(output.suffix.lower(), FILE_COSTS[".html"]))
    place = next(folder for folder in output.absolute().parents if folder.exists())
    limits = (memory_of_machine(), LONGEST, float(disk_usage(place).free))
    names, words = ("memory", "time", "room on the disk"), (_bytes, _duration, _bytes)
    _check(f"{output}: {what}", list(zip(names, (PROCESS + memory, time, room), limits, words, strict=True)), hint)
    return f"{what}, about {_duration(time)} and {_bytes(room)}"


def most_numbers() -> float:
    """Return how many numbers of recordings fit into the memory of this machine."""
    return max(memory_of_machine() - PROCESS, 0.0) / PER_NUMBER


def _check(what: str, estimates: Sequence[tuple[str, float, float, Callable[[float], str]]], hint: str) -> None:
    """Compare needs with the machine's memory, time and more; each is said in words of its own."""
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
