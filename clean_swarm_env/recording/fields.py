"""Gradients that lie in the world at a frame of a recording, rebuilt from the deposits of the robots."""

from typing import NamedTuple

import numpy as np

from clean_swarm_env.recording.reader import RecordedMission
from selforg.arrays import Floats, Ints

AGE_ROUNDING = 1e-6
"""Share of an evaporation period by which ages may be rounded."""


class Traces(NamedTuple):
    """Deposits that have not evaporated yet, the oldest first; D of them."""

    kind: Ints
    """(D,) which of the recording's `notes["deposits"]` each is."""
    positions: Floats
    """(D, 2) [m]."""
    diffusion: Floats
    """(D,) its diffusion then [m]."""
    robot: Ints
    """(D,) who left it."""


def traces_at(recording: RecordedMission, frame: int) -> Traces:
    """Return the deposits from before a frame that can still be perceived at it.

    A robot of the mission stores fewer: of traces within the aggregation distance it keeps one.
    """
    nothing = np.zeros(0, dtype=np.int64)
    parts = [Traces(nothing, np.zeros((0, 2)), np.zeros(0), nothing)]
    bits = recording.whole("deposit")[:frame]
    for kind, facts in enumerate(recording.notes.get("deposits", [])):
        made, robot = np.nonzero(bits & (1 << kind))
        left = np.full(len(made), float(facts["diffusion"]))
        if facts["evaporation_factor"] < 1.0:
            ages = (frame - made) * recording.period
            with np.errstate(divide="ignore", over="ignore"):  # a period of 0: what is left is gone at once
                left *= facts["evaporation_factor"] ** np.floor(ages / facts["evaporation_period"] + AGE_ROUNDING)
        there = left >= facts["min_diffusion"]
        made, robot, left = made[there], robot[there], left[there]
        places = np.stack(
            [recording.whole(name)[made, robot] / recording.channels[name].scale for name in ("x", "y")], axis=1
        )
        parts.append(Traces(np.full(len(made), kind), places, left, robot))
    return Traces(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
