"""Typed configuration of the behaviour network of each robot."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from clean_swarm_env.config.types import Count
from selector.documents.fields import Positive
from selector.vocabulary.settings import SettingsSpec


def _planner(given: object) -> object:
    """Read a truth value, which is what YAML makes of a bare `off`, as "built-in" or "off"."""
    return ("built-in" if given else "off") if isinstance(given, bool) else given


class NetworkConfig(SettingsSpec):
    """The behaviour network of each robot: its document, its settings and its planner."""

    robot: Annotated[str, Field(strict=True, min_length=1)] = "cleaning"
    """Name of the robot's document in `configs/robots`."""
    activation_threshold: Positive = 7.0
    """Activation that a behaviour needs to start, at the start of the mission [-]."""
    max_parallel: Count = 1
    """Number of behaviours of one robot that may run at the same time."""
    planner: Annotated[str, BeforeValidator(_planner), Field(strict=True, min_length=1)] = "built-in"
    """Planner whose plans add activation: "built-in", "off", or an engine of unified-planning."""
    transport_full_range: Positive = 1.0
    """Distance to a station from which its linear condition is fully satisfied [m]."""
