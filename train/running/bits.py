"""The fingerprint of a machine: how two short missions end on it, which is equal on all machines that may take part.

All CPUs of one operating system give equal bits (docs/decisions/0160-elementary-functions.md). The check finds what
else may differ between machines: versions of libraries, sources of ours, a broken CPU.
"""

import hashlib
from functools import cache

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import mission_begun, run_out

FAMILIES = ("crowded", "table1")
"""Families whose first training scenario is run."""


@cache
def own_bits() -> str:
    """Return the fingerprint of this process; the missions take half a second, once."""
    return hashlib.sha256("".join(map(course_digest, FAMILIES)).encode()).hexdigest()[:16]


def course_digest(family: str) -> str:
    """Return a hash of how the first training scenario of a family ends: its figures, and where the robots are."""
    scenario = load_family(family).scenario(0, 0, "train")
    batch = mission_begun(scenario.mission, scenario.start, scenario.seed)
    result = run_out(batch)
    return hashlib.sha256(repr(result).encode() + batch.worlds.physics.positions.tobytes()).hexdigest()
