"""Replays movement.json: mechanisms as a whole. The terms of the flocking rules are in `flocking.py`."""

import math
from typing import Any

import numpy as np

from selforg import mechanisms
from selforg.gradients.queries import Filter, Queries
from selforg.mechanisms import Pheromone
from selforg.mechanisms.depositing import DepositingMechanism
from tests.golden.buffer import filter_of
from tests.golden.case import Case, SetAside, difference
from tests.golden.flocking import replay_term
from tests.golden.scene import Scene, channel_of
from tests.golden.ties import equally_good
from tests.selforg.gradients.objects import neighbours

PARAMETERS = {"maxvel": "max_speed", "minvel": "min_speed"}
SAME_NAME = ("angle_xy", "angle_yz", "moving", "static", "a", "b", "epsilon", "h", "max_acceleration")
NAMES = {"FlockingRey": "FlockingReynolds"}
FOLLOWED = {
    "FollowStrongest": "strongest", "FollowMin": "farthest_attractive", "FollowMinReach": "least_reach_attractive",
    "FollowMaxReach": "most_reach_attractive", "ChemotaxisGe": "nearest_attractive",
    "ChemotaxisBalch": "nearest_attractive",
}  # fmt: skip
NO_SPEEDS = ("RepulsionFernandez", "RepulsionGradient")  # they drop their keyword arguments (Q5)


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    if "function" in case.inputs:
        return replay_term(case)
    expected = case.expected
    if case.group == "Flocking.move_upstream":
        raise SetAside("Q6")
    if any(isinstance(c, float) and not np.isfinite(c) for c in expected.get("vector") or ()):
        raise SetAside("Q2")
    if case.group == "double_counting":
        raise SetAside("Q29")
    scene, mechanism = build(case)
    vector = moved(mechanism, case)
    if "error" in expected:  # the original crashes for want of an own pose: no movement is what golden/ advises
        return difference(None, vector, "vector")
    if "vector" in expected and difference(expected["vector"], vector):
        if case.group == "FlockingRey" and overlaps(scene, case.inputs["time"]):
            raise SetAside("Q12")
        if is_tie(scene, case):
            raise SetAside("B9")
    if wrong := differing_deposits(case):
        return wrong
    if "random_vector_length" not in expected:
        return difference(expected["vector"], vector, "vector")
    if case.group == "Patrol":
        raise SetAside("Q7")
    return difference(expected["random_vector_length"], float(np.linalg.norm(vector or (0, 0, 0))), "length")


def moved(mechanism: Any, case: Case) -> list[float] | None:
    """Return the vector of the mechanism, None without a movement."""
    vectors, active = mechanism.move(case.inputs["time"])
    return vectors[0].tolist() if active[0] else None


def overlaps(scene: Scene, now: float) -> bool:
    """Tell whether the goal area of a neighbour touches the own one."""
    own, others = scene.poses.gradient(0), neighbours(scene.buffer, now, Filter((scene.poses.channel,)))
    return any(math.dist(own.position, other.position) <= own.goal_radius + other.goal_radius for other in others)


def is_tie(scene: Scene, case: Case) -> bool:
    """Tell whether the answer is the original's if only one of the equally good gradients is left."""
    rule, given, messages = (
        FOLLOWED.get(case.inputs["mechanism"]),
        case.inputs.get("params", {}),
        case.inputs["messages"],
    )
    if rule is None:
        return False
    tied = {gradient.payload["id"] for gradient in equally_good(scene, rule, case.inputs["time"], filter_of(given))}
    for left in tied:
        _, mechanism = build(case, [message for message in messages if message["id"] not in tied - {left}])
        if not difference(case.expected["vector"], moved(mechanism, case)):
            return True
    return False


def build(case: Case, messages: list[dict[str, Any]] | None = None) -> tuple[Scene, Any]:
    """Return the scene with all messages (or those given) stored, and the mechanism."""
    scene = Scene(case.inputs["buffer"])
    for message in case.inputs["messages"] if messages is None else messages:
        scene.store(message, message["stamp"])
    name = case.inputs["mechanism"]
    return scene, mechanisms.MECHANISMS.find(NAMES.get(name, name))(scene.buffer, **keywords(case))


def keywords(case: Case) -> dict[str, Any]:
    """Return our parameters for those of the original."""
    given, name = case.inputs.get("params", {}), case.inputs["mechanism"]
    mapped = {PARAMETERS.get(k, k): v for k, v in given.items() if k in PARAMETERS or k in SAME_NAME}
    if name in NO_SPEEDS:
        mapped = {}
    mapped["channels"] = [channel_of(c) for c in given.get("frames", ())]
    if name.startswith("Flocking") and "frame" in given:
        mapped["channels"] = [channel_of(given["frame"])]
    if name == "Patrol" or name.startswith("DepositPheromones"):
        patrol = name == "Patrol"
        mapped["pheromone"] = Pheromone(
            channel_of(given.get("frame", "Pheromone")), given.get("attraction", -1 if patrol else 1),
            given.get("ev_diffusion", 1.0) if patrol else given.get("maxvel", 1.0),
            given.get("ev_factor", 0.9), given.get("ev_time", 30.0 if patrol else 5.0),
        )  # fmt: skip
    return mapped


def differing_deposits(case: Case) -> str | None:
    """Return how the deposit differs; it is made into an empty buffer, because in the full one it may aggregate."""
    own = [
        m for m in case.inputs["messages"] if m["frame"] == "robot" and m.get("parent") == case.inputs["buffer"]["id"]
    ]
    case.inputs["buffer"]["min_diffusion"] = 0.0
    scene, mechanism = build(case, own)
    if not isinstance(mechanism, DepositingMechanism):
        return difference(case.expected.get("messages", []), [], "messages")
    mechanism.deposit(case.inputs["time"])
    left = [
        {
            "attraction": g.attraction, "diffusion": g.diffusion, "ev_factor": g.evaporation_factor,
            "ev_time": g.evaporation_period, "frame": g.channel, "goal_radius": g.goal_radius, "moving": g.moving,
            "p": list(g.position), "parent": g.source, "stamp": g.stamp, "direction": list(g.heading),
        }
        for g in Queries(scene.buffer).gradients(0, case.inputs["time"], Filter(view_distance=np.inf))
    ]  # fmt: skip
    # q is that of the robot and of no effect, since the direction is zero; the payload is empty
    keys = left[0].keys() if left else ()
    return difference([{k: m[k] for k in keys} for m in case.expected["messages"]], left, "messages")
