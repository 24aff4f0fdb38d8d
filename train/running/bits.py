"""What CPUs make of missions: two short missions end with equal bits on all CPUs that may take part in a run.

All CPUs of one operating system give equal bits (docs/decisions/0160-elementary-functions.md). The check finds what
else may differ between machines: versions of libraries, sources of ours, a broken CPU.
"""

import hashlib
import platform
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.warm_up import compile_once
from clean_swarm_env.world.mission import Course, MissionRun, result_of
from selector.documents.plain import short
from train.running.run_folder import MANIFEST, WORKERS, read_manifest

FAMILIES = ("crowded", "table1")
"""Families whose first training scenario is run."""
CPU_FILE = Path("/proc/cpuinfo")


class WorkerBits:
    """The CPUs that took part in a run elsewhere, by the fingerprints of the missions that they ran.

    Args:
        mixed: whether CPUs may differ.

    """

    def __init__(self, *, mixed: bool = False) -> None:
        self.cpus: dict[str, str] = {}
        self.mixed = mixed

    def add(self, cpus: Mapping[str, str]) -> None:
        """Note fingerprint -> CPU; ConfigurationError for one that differs from those before, unless they are mixed."""
        known = {**self.cpus, **cpus}
        if len(known) > 1 and not self.mixed:
            first, *others = known.values()
            differ = f"{', '.join(others)}: missions end differently than on {first}"
            raise ConfigurationError(f"{differ}; --any-bits takes them")
        self.cpus = known


def noted_bits(directory: Path) -> dict[str, str]:
    """Return fingerprint -> CPU as the manifest of a run folder notes them; nothing without a manifest."""
    noted = read_manifest(directory).get(WORKERS, {}) if (directory / MANIFEST).exists() else {}
    if not (isinstance(noted, dict) and all(isinstance(cpu, str) for cpu in noted.values())):
        where = f"{directory / MANIFEST}: {WORKERS}"
        raise ConfigurationError(f"{where}: expected fingerprints with CPUs, got {short(noted)}")
    return noted


@cache
def own_bits() -> dict[str, str]:
    """Return fingerprint -> CPU of this process; the missions take half a second, once."""
    compile_once(lambda: course_digest(FAMILIES[0]))
    digest = hashlib.sha256("".join(map(course_digest, FAMILIES)).encode()).hexdigest()[:16]
    return {digest: cpu_name()}


def course_digest(family: str) -> str:
    """Return a hash of how the first training scenario of a family ends: its figures, and where the robots are."""
    scenario = load_family(family).scenario(0, 0, "train")
    course = Course(MissionRun(scenario.mission, scenario.start, scenario.seed, {}))
    while course.in_progress:
        course.tick()
    places = course.worlds.physics.positions.tobytes()
    return hashlib.sha256(repr(result_of(course.worlds, 0)).encode() + places).hexdigest()


def cpu_name() -> str:
    """Return the name of the CPU, as exactly as the operating system tells it."""
    lines = CPU_FILE.read_text(encoding="utf-8").splitlines() if CPU_FILE.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()} ({platform.node()}, {platform.system()})"
