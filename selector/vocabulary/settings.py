"""Document model of `NetworkSettings`: how a network decides."""

from typing import Annotated, Literal

from pydantic import Field

from selector.documents.fields import Closed, Flag, Number, Share
from selforg.network.model.behaviours import NetworkSettings, Weights


class WeightsSpec(Closed):
    """Weight of each term of the activation of a behaviour."""

    situation: Number = 1.0
    """Satisfaction of its own preconditions [-]."""
    goal: Number = 1.0
    """Goals that its effects help [-]."""
    conflictor: Number = 1.0
    """Goals and other behaviours that its effects hinder [-]."""
    predecessor: Number = 1.0
    """Ready behaviours that help it [-]."""
    successor: Number = 1.0
    """Behaviours that it makes ready [-]."""
    plan: Number = 1.0
    """Its place in the plan [-]."""


class SettingsSpec(Closed):
    """How a network decides; `NetworkSettings` explains each field."""

    algorithm: Literal["default", "uniform"] = "default"
    """Products of effect and wish, or their Euclidean length."""
    weights: WeightsSpec = WeightsSpec()
    """Weights of the terms of the activation."""
    activation_decay: Share = 0.9
    """Share of the activation that is kept from step to step [-]."""
    activation_threshold: Number = 7.0
    """Threshold of the activation at the start [-]."""
    threshold_decay: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.8
    """Factor on the threshold while nothing runs [-]."""
    max_parallel: Annotated[int, Field(strict=True, ge=1, le=1000)] | None = None
    """Behaviours that may run at once; any number by default."""
    goal_priority: Flag = False
    """Whether goals of higher priority give more."""
    strict_progress: Flag = False
    """Whether a step of the plan is passed only when its effects were seen."""

    def build(self) -> NetworkSettings:
        """Return the settings that the document declares."""
        given = {name: getattr(self, name) for name in SettingsSpec.model_fields}  # subclasses may have further fields
        return NetworkSettings(**given | {"weights": Weights(**dict(self.weights))})
