"""The words in which YAML declares components: mechanisms, targets, sensors and actions of a configuration.

Their types and parameters are the classes of `selforg.mechanisms` and `selforg.components`. What refers to a mechanism,
a target or a piece of knowledge does so by its name in the configuration.
"""

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import BeforeValidator, Field, model_validator

from selector.documents.fields import Closed, Flag, Name, NonNegative, Number
from selforg.gradients.queries import CHOICES

DEFAULT_BUFFER = "gradients"
"""Name of the buffer that is meant where none is named."""


class MechanismSpec(Closed):
    """A registered mechanism with its parameters."""

    type: Name
    """Name of the mechanism's class."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer that it looks into and spreads to."""
    hold: NonNegative = 0.0
    """Of a movement mechanism: time for which a movement is kept before it is asked again [s]."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Keyword arguments of the mechanism."""


class TargetSpec(Closed):
    """The gradient that a query chooses."""

    rule: Literal[tuple(CHOICES)] = "nearest_attractive"  # type: ignore[valid-type]
    """How one of those in view is chosen."""
    buffer: Name = DEFAULT_BUFFER
    """Name of the host's buffer."""
    channels: tuple[Name, ...] = ()
    """Channels to look at; all without any."""
    static: Flag = True
    """Whether static gradients count."""
    moving: Flag = True
    """Whether moving gradients count."""
    view_distance: NonNegative | None = None
    """How far beyond their reach gradients are seen [m]; as the buffer says unless given."""


class OverMovement(Closed):
    """What refers to a movement mechanism."""

    mechanism: Name
    """Name of the movement mechanism."""


class VectorPresentSpec(OverMovement):
    """A fact: the mechanism gives a movement vector, and it is longer than a threshold."""

    type: Literal["VectorPresent"]
    longer_than: NonNegative = 1e-9
    """Length above which a vector counts as present [m/s]."""


class VectorLengthSpec(OverMovement):
    """A number: the length of the mechanism's movement vector, 0 without one."""

    type: Literal["VectorLength"]


class OverTarget(Closed):
    """What refers to a target."""

    target: Name
    """Name of the target."""


class GoalPresentSpec(OverTarget):
    """A fact: there is such a gradient in view."""

    type: Literal["GoalPresent"]


class GoalReachedSpec(OverTarget):
    """A fact: the own goal area touches that of the target."""

    type: Literal["GoalReached"]


class GoalDistanceSpec(OverTarget):
    """A number: clearance to the target."""

    type: Literal["GoalDistance"]
    unseen: NonNegative
    """What it reads without a target in view [m]."""


class FartherThanSpec(OverTarget):
    """A fact: the target is in view and farther than a clearance."""

    type: Literal["FartherThan"]
    distance: NonNegative
    """That clearance [m]."""


class OverDecision(Closed):
    """What refers to a decision mechanism."""

    mechanism: Name
    """Name of the decision mechanism."""


class ValueSpec(OverDecision):
    """A number: the value that would be decided now."""

    type: Literal["Value"]


class StateIsSpec(OverDecision):
    """A fact: a certain state would be decided now."""

    type: Literal["StateIs"]
    state: Name
    """That state, by name."""


class ChangedSpec(OverDecision):
    """A fact: something else would be decided now than what was spread last."""

    type: Literal["Changed"]


class KnownSpec(Closed):
    """What the robot knows under a name: a fact or a number."""

    type: Literal["Known"]
    name: Name
    """A name under `knowledge` or `expects`."""


SensorSpec: TypeAlias = Annotated[
    VectorPresentSpec | VectorLengthSpec | GoalPresentSpec | GoalReachedSpec | GoalDistanceSpec | FartherThanSpec
    | ValueSpec | StateIsSpec | ChangedSpec | KnownSpec,
    Field(discriminator="type"),
]  # fmt: skip


class MoveSpec(OverMovement):
    """The mechanism's movement vector becomes the drive command; what deposits, deposits."""

    type: Literal["Move"]


class TurnSpec(Closed):
    """Turn without moving: towards a target, or where a mechanism would go."""

    type: Literal["Turn"]
    mechanism: Name | None = None
    """Name of a movement mechanism."""
    target: Name | None = None
    """Name of a target."""

    @model_validator(mode="after")
    def _towards_one(self) -> Self:
        if (self.mechanism is None) is (self.target is None):
            raise ValueError("expected a mechanism or a target")
        return self


class DecideSpec(OverDecision):
    """Decide, keep it and spread it."""

    type: Literal["Decide"]


class DecideStateSpec(OverDecision):
    """Decide and spread; the state becomes knowledge, as its number among the mechanism's states."""

    type: Literal["DecideState"]
    name: Name
    """The knowledge."""


class SpreadSpec(Closed):
    """Spread the gradient of a SpreadGradient."""

    type: Literal["Spread"]
    mechanism: Name
    """Name of the SpreadGradient."""


class SetStateSpec(Closed):
    """When the behaviour starts, the robot knows a value under a name."""

    type: Literal["SetState"]
    name: Name
    """The knowledge."""
    value: Flag | Number
    """What it becomes."""


class ActSpec(Closed):
    """When the behaviour starts, a function of the host is called."""

    type: Literal["Act"]
    call: Name
    """Name of the function among those that the host offers."""


ActionSpec: TypeAlias = Annotated[
    MoveSpec | TurnSpec | DecideSpec | DecideStateSpec | SpreadSpec | SetStateSpec | ActSpec,
    Field(discriminator="type"),
]


def _listed(given: object) -> object:
    return [given] if isinstance(given, dict) else given


ActionSpecs: TypeAlias = Annotated[tuple[ActionSpec, ...], BeforeValidator(_listed), Field(min_length=1)]
"""One action or a list of them."""
