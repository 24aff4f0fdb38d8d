"""Replays movement.json: mechanisms as a whole, and the terms of the flocking rules."""

from typing import Any

import numpy as np

from selforg import mechanisms
from selforg.mechanisms import Pheromone
from tests.golden.case import Case, SetAside, difference
from tests.golden.scene import Scene, channel_of

PARAMETERS = {
    "maxvel": "max_speed", "minvel": "min_speed", "angle_xy": "angle_xy", "angle_yz": "angle_yz", "moving": "moving",
    "static": "static",
}  # fmt: skip
NO_SPEEDS = ("RepulsionFernandez", "RepulsionGradient")


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    if "function" in case.inputs:
        raise NotImplementedError(case.group)
    if any(isinstance(c, float) and not np.isfinite(c) for c in case.expected.get("vector") or ()):
        raise SetAside("Q2")
    if case.group == "double_counting":
        raise SetAside("Q29")
    if "error" in case.expected:
        return replay_without_pose(case)
    scene, mechanism = build(case)
    vectors, active = mechanism.move(case.inputs["time"])
    vector = vectors[0].tolist() if active[0] else None
    if "random_vector_length" in case.expected:
        if case.group == "Patrol":
            raise SetAside("Q7")
        wrong = difference(case.expected["random_vector_length"], float(np.linalg.norm(vector or (0, 0, 0))), "length")
    else:
        wrong = difference(case.expected["vector"], vector, "vector")
    return wrong


def replay_without_pose(case: Case) -> str | None:
    """Replay a case in which the original crashes for want of an own pose: no movement is what golden/ advises."""
    _, mechanism = build(case)
    _, active = mechanism.move(case.inputs["time"])
    return "moves without an own pose" if active[0] else None


def build(case: Case) -> tuple[Scene, Any]:
    """Return the scene with all messages stored, and the mechanism."""
    scene = Scene(case.inputs["buffer"])
    for message in case.inputs["messages"]:
        scene.store(message, message["stamp"])
    return scene, mechanisms.create(case.inputs["mechanism"], scene.buffer, **keywords(case))


def keywords(case: Case) -> dict[str, Any]:
    """Return our parameters for those of the original."""
    given, name = case.inputs.get("params", {}), case.inputs["mechanism"]
    mapped = {PARAMETERS[k]: v for k, v in given.items() if k in PARAMETERS}
    if name in NO_SPEEDS:
        mapped = {}
    mapped["channels"] = [channel_of(c) for c in given.get("frames", ())]
    if name == "Patrol":
        mapped["pheromone"] = Pheromone(
            channel_of(given.get("frame", "Pheromone")), given.get("attraction", -1), given.get("ev_diffusion", 1.0),
            given.get("ev_factor", 0.9), given.get("ev_time", 30.0),
        )  # fmt: skip
    return mapped
