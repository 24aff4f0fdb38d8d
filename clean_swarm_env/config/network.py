"""Typed configuration of the behaviour network of each robot."""

from typing import Annotated

from pydantic import Field

from selector.documents.fields import DocumentName, Name, Positive
from selector.vocabulary.settings import SettingsSpec


class NetworkConfig(SettingsSpec):
    """The behaviour network of each robot: its document, its settings and its planner."""

    robot: DocumentName = "cleaning"
    """Name of the robot's document in `configs/robots`."""
    activation_threshold: Positive = 7.0
    """Activation that a behaviour needs to start, at the start of the mission [-]."""
    max_parallel: Annotated[int, Field(strict=True, ge=1, le=1000)] = 1
    """Number of behaviours of one robot that may run at the same time."""
    planner: Name = "built-in"
    """Planner whose plans add activation: "built-in", "off", or an engine of unified-planning."""
    transport_full_range: Positive = 1.0
    """Distance to a station from which its linear condition is fully satisfied [m]."""
