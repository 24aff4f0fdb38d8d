"""Typed configuration of the behaviour network of each robot."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from clean_swarm_env.config_types import Count
from selector.documents import Closed, Number, Positive, Share


class WeightsConfig(Closed):
    """Weights of the terms that make up a behaviour's activation step."""

    situation: Number = 1.0
    """Weight of the precondition satisfaction [-]."""
    goal: Number = 1.0
    """Weight of the goals served [-]."""
    conflictor: Number = 1.0
    """Weight of the inhibition by goals and by conflictors that are hindered [-]."""
    predecessor: Number = 1.0
    """Weight of what the predecessors give [-]."""
    successor: Number = 1.0
    """Weight of what the successors give [-]."""
    plan: Number = 1.0
    """Weight of the place on the plan [-]."""


def _planner(given: object) -> object:
    """Read a truth value, which is what YAML makes of a bare `off`, as "built-in" or "off"."""
    return ("built-in" if given else "off") if isinstance(given, bool) else given


class NetworkConfig(Closed):
    """The behaviour network of each robot."""

    robot: Annotated[str, Field(strict=True, min_length=1)] = "cleaning"
    """Name of the robot's document in `configs/robots`."""
    activation_threshold: Positive = 7.0
    """Activation that a behaviour needs to start, at the start of the mission [-]."""
    threshold_decay: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.8
    """Factor on the threshold when nothing runs, and its divisor when something starts [-]."""
    activation_decay: Share = 0.9
    """Share of a behaviour's activation that stays from one step to the next [-]."""
    max_parallel: Count = 1
    """Number of behaviours of one robot that may run at the same time."""
    planner: Annotated[str, BeforeValidator(_planner), Field(strict=True, min_length=1)] = "built-in"
    """Whose plan adds to the activation of its next behaviours: "built-in", "off", or an engine of unified-planning."""
    transport_full_range: Positive = 1.0
    """Distance to a station from which its linear condition is fully satisfied [m]."""
    weights: WeightsConfig = WeightsConfig()
    """Weights of the terms of the activation step."""
