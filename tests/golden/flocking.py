"""Replays the terms of the flocking rules in movement.json, one function each."""

from typing import Any

import numpy as np

from selforg.compiler.records import Packed
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.flocking import (
    BOID_COLUMNS,
    BOID_GOAL_RADIUS,
    BOID_OFFSET,
    BOID_VELOCITY,
    action,
    adjacency,
    bump,
    olfati_saber,
    sigma_norm,
)
from selforg.mechanisms.flocking_reynolds import FlockingReynolds, mean_difference, separation
from selforg.mechanisms.movement import Rule
from selforg.space import Euclidean
from tests.golden.case import Case, SetAside, difference
from tests.golden.scene import heading_of


def replay_term(case: Case) -> str | None:
    """Return how one term differs from the original, None if it agrees."""
    inputs, name = case.inputs, case.inputs["function"]
    if "error" in case.expected:
        raise SetAside("Q12")
    if case.group.startswith("FlockingRey."):
        return difference(case.expected["vector"], reynolds(name, inputs), name)
    p = inputs.get("params", {})
    if name in ("sigma_norm", "bump_function", "adjacency", "action_function"):
        return difference(case.expected["value"], scalar(name, inputs, p), name)
    if name == "vector_between":
        offset = np.subtract(inputs["qj"], inputs["qi"])
        value = offset / np.sqrt(1.0 + p["epsilon"] * offset @ offset)
    elif name == "agent_velocity":
        elapsed = inputs["newer"]["stamp"] - inputs["older"]["stamp"]
        value = np.subtract(inputs["newer"]["p"], inputs["older"]["p"]) / elapsed if elapsed else np.zeros(3)
    else:
        gradient, consensus = terms(inputs, p)
        value = {"gradient_based": gradient, "velocity_consensus": consensus, "flocking_vector": gradient + consensus}[
            name
        ]
    return difference(case.expected["vector"], value.tolist(), name)


def scalar(name: str, inputs: dict[str, Any], p: dict[str, Any]) -> float:
    """Return one of the scalar functions."""
    if name == "bump_function":
        return bump(inputs["z"], p["h"])
    z = np.array(inputs["z"]) if "z" in inputs else np.subtract(inputs["qj"], inputs["qi"])
    squared = float(z @ z)
    if name == "sigma_norm":
        return sigma_norm(squared, p["epsilon"])
    if name == "adjacency":
        return adjacency(squared, p["epsilon"], p["h"], p["view_distance"])
    return action(squared, p["epsilon"], p["a"], p["b"], p["h"], p["avoidance_distance"], p["view_distance"])


def terms(inputs: dict[str, Any], p: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return gradient term and velocity consensus of Olfati-Saber."""
    agent, neighbours = inputs["agent"], inputs["neighbours"]
    boids = np.zeros((len(neighbours), BOID_COLUMNS))
    for boid, neighbour in zip(boids, neighbours, strict=True):
        boid[BOID_OFFSET : BOID_OFFSET + 3] = np.subtract(neighbour["p"], agent["p"])
        boid[BOID_VELOCITY : BOID_VELOCITY + 3] = neighbour["v"]
    flock = rule_of(boids, p["view_distance"], p["a"], p["b"], p["epsilon"], p["h"])
    gradient, consensus = np.zeros(3), np.zeros(3)
    velocity = np.array(agent["v"], dtype=float)
    olfati_saber(len(boids), velocity, p["avoidance_distance"], gradient, consensus, flock.handle)
    return gradient, consensus


def reynolds(name: str, inputs: dict[str, Any]) -> list[float]:
    """Return one term of Reynolds."""
    agent, neighbours = inputs["agent"], inputs["neighbours"]
    boids = np.zeros((len(neighbours), BOID_COLUMNS))
    for boid, neighbour in zip(boids, neighbours, strict=True):
        boid[BOID_OFFSET : BOID_OFFSET + 3] = np.subtract(neighbour["p"], agent["p"])
        boid[BOID_VELOCITY : BOID_VELOCITY + 3] = heading_of(neighbour)
        boid[BOID_GOAL_RADIUS] = neighbour["goal_radius"]
    flock = rule_of(boids, 0.0, inputs.get("params", {}).get("r", 0.0))
    if name == "separation":
        separation(len(boids), agent["goal_radius"], 1.0, 0, flock.handle)
    elif name == "alignment":
        mean_difference(len(boids), BOID_VELOCITY, np.array(heading_of(agent)), flock.handle)
    else:
        mean_difference(len(boids), BOID_OFFSET, np.zeros(3), flock.handle)
    return flock.record.total.tolist()


def rule_of(boids: np.ndarray, view_distance: float, *parameters: float) -> Packed[Rule]:
    """Return the record of a flocking rule with the parameters of a case."""
    mechanism = FlockingReynolds(OwnPoses(Euclidean(3), 1), view_distance=view_distance)
    record = mechanism._packed.record
    return Packed(record._replace(boids=boids, parameters=np.array(parameters, dtype=float)))
