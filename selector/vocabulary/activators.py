"""The words in which YAML declares the activators of `selforg.network.model.activators`."""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from selector.documents.fields import Closed, Flag, NonNegative, Number, Share
from selforg.network.model import activators


class ActivatorSpec(Closed):
    """What every activator has."""

    low: Share = 0.0
    """Satisfaction while nothing is fulfilled [-]."""
    high: Share = 1.0
    """Satisfaction while all is fulfilled [-]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low > self.high:
            raise ValueError(f"expected low <= high, got {self.low} and {self.high}")
        return self


class BooleanSpec(ActivatorSpec):
    """Fulfilled while a fact is as desired."""

    type: Literal["Boolean"]
    desired: Flag = True
    """The value that is wanted."""


class ThresholdSpec(ActivatorSpec):
    """Fulfilled at or above a reading (at or below it, if not `minimum`)."""

    type: Literal["Threshold"]
    threshold: Number
    """Reading at which it is fulfilled, in the sensor's unit."""
    minimum: Flag = True
    """Whether readings above are fulfilled, not those below."""
    value_range: NonNegative = 0.0
    """What is missing when the wish is full, in the sensor's unit; 0: every wish is full."""


class LinearSpec(ActivatorSpec):
    """Satisfaction rises from one reading to another."""

    type: Literal["Linear"]
    zero: Number
    """Reading of no satisfaction, in the sensor's unit."""
    full: Number
    """Reading of full satisfaction, in the sensor's unit; may lie below `zero`."""

    @model_validator(mode="after")
    def _slope(self) -> Self:
        if self.zero == self.full:
            raise ValueError(f"expected different readings zero and full, got {self.zero} for both")
        return self


class GreedySpec(ActivatorSpec):
    """Never fulfilled, always wishes on."""

    type: Literal["Greedy"]
    maximise: Flag = True
    """Whether more is wished for, not less."""
    step_size: Number = 1.0
    """0 makes it fulfilled as well [-]."""


class EqualSpec(ActivatorSpec):
    """Fulfilled while a reading is exactly one value."""

    type: Literal["Equal"]
    value: Number
    """That value, in the sensor's unit."""


AnyActivator: TypeAlias = Annotated[
    BooleanSpec | ThresholdSpec | LinearSpec | GreedySpec | EqualSpec, Field(discriminator="type")
]


def activator(spec: AnyActivator) -> activators.Activator:
    """Return the activator that a specification declares."""
    return KINDS[spec.type](**spec.model_dump(exclude={"type"}))


KINDS: dict[str, type[activators.Activator]] = {
    "Boolean": activators.Boolean,
    "Threshold": activators.Threshold,
    "Linear": activators.Linear,
    "Greedy": activators.Greedy,
    "Equal": activators.Equal,
}
