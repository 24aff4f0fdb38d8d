"""The fingerprint of a machine: how two short missions end on it, which is equal on all machines that may take part.

All CPUs of one operating system give equal bits (docs/decisions/0160-elementary-functions.md). The check finds what
else may differ between machines: versions of libraries, sources of ours, a broken CPU.
"""

import hashlib
from functools import cache

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.warm_up import compile_once
from clean_swarm_env.world.mission import Course, MissionRun, result_of

FAMILIES = ("crowded", "table1")
"""Families whose first training scenario is run."""


@cache
def own_bits() -> str:
    """Return the fingerprint of this process; the missions take half a second, once."""
    compile_once(lambda: course_digest(FAMILIES[0]))
    return hashlib.sha256("".join(map(course_digest, FAMILIES)).encode()).hexdigest()[:16]


def course_digest(family: str) -> str:
    """Return a hash of how the first training scenario of a family ends: its figures, and where the robots are."""
    scenario = load_family(family).scenario(0, 0, "train")
    course = Course(MissionRun(scenario.mission, scenario.start, scenario.seed, {}))
    while course.in_progress:
        course.tick()
    places = course.worlds.physics.positions.tobytes()
    return hashlib.sha256(repr(result_of(course.worlds, 0)).encode() + places).hexdigest()
