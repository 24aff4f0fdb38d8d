"""Typed configuration of the robots of a mission: all alike, or groups of different models.

`robots: {count: 5}` says what all robots are. `robots: [{model: scout, count: 2}, {model: carrier, count: 3}]` says it
for each group; with settings of the whole team, the list is below `groups`.
"""

import math
import sys
from collections.abc import Sequence
from typing import Annotated, Any, Final, Literal, Self

from pydantic import AfterValidator, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from clean_swarm_env.config.delivery import EVERYWHERE
from clean_swarm_env.config.types import Index, Length, Robots
from selector.documents.errors import check_unique, impossible
from selector.documents.fields import Closed, DocumentName, Name, NonNegative, Positive

SUMMED_UP: Final = (
    "radius",
    "max_speed",
    "max_turn_rate",
    "pose_goal_radius",
    "pose_diffusion",
    "pose_noise",
    "pose_drift",
    "slip",
)
"""Settings of which a team of groups has the largest value."""


class RobotModel(Closed):
    """Number, body, drive, messages and abilities of robots that are alike."""

    model: Annotated[Name, AfterValidator(sys.intern)] = "robot"  # interned: equal missions have equal states
    """Name of these robots, unique in the mission."""
    count: Robots = 5
    """Number of them at the start."""
    radius: Length = 0.25
    """Radius of the disc [m]."""
    drive: Literal["differential", "holonomic"] = "differential"
    """Whether a robot turns into its direction, or moves in any direction at once."""
    max_speed: Positive = 1.0
    """Largest speed along the heading [m/s]."""
    max_turn_rate: Positive = 2.0
    """Largest turn rate [rad/s]."""
    turn_gain: Positive = 2.0
    """Turn rate commanded per radian of heading error [1/s]."""
    turn_in_place_beyond: Annotated[float, Field(strict=True, gt=0.0, le=math.pi)] = 1.0471975511965976
    """Heading error from which a robot turns without driving [rad]."""
    command_timeout: Positive = 1.0
    """Time without a drive command after which a robot stops [s]."""
    pose_goal_radius: NonNegative = 0.5
    """Goal radius of the repulsive gradient that each robot carries [m]."""
    pose_diffusion: NonNegative = 1.0
    """Diffusion of the repulsive gradient that each robot carries [m]."""
    pose_noise: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=100.0)] = 0.0
    """Standard deviation of each coordinate of where a robot takes itself to be, anew in each control period [m].

    Its mechanisms begin at that place, and others see its pose there.
    """
    pose_drift: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=100.0)] = 0.0
    """Standard deviation of a further error of that place, which changes slowly: it falls to 1/e in 20 s [m]."""
    slip: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1.0)] = 0.0
    """Standard deviation of the speed, and of the turn rate, that wheels give as a share of what is commanded [-].

    It is drawn anew in each control period.
    """
    document: DocumentName | Literal[""] = ""
    """Name of the document of these robots in `configs/robots`; empty: that of `network.robot`."""
    message_range: Positive = EVERYWHERE
    """Farthest receiver of what the robot spreads, if `delivery` reaches so far [m]."""
    sight: NonNegative = 0.0
    """Distance up to which the robot sees garbage [m]; 0: that of the task."""
    carries: Annotated[int, Field(strict=True, ge=0, le=100)] = 1
    """Items that the robot carries at a time; without any, it finds them for others."""
    holds: dict[Name, Name] = Field(default={})
    """Goal -> the option that these robots always hold, whatever the strategy chooses for others."""


class RobotConfig(RobotModel):
    """The robots of a mission: the settings of all of them, or groups that differ.

    With groups, `count` is the number of all robots at the start, and sizes, speeds and errors are the largest of any
    group.
    """

    capacity: Index = 0
    """Number of robots for which there is room in memory, over the whole mission; 0: as many as the events need."""
    failed_pose: Literal["unseen", "seen"] = "unseen"
    """Whether a robot that has failed still carries its gradient: others keep away from its body and its cargo."""
    groups: tuple[RobotModel, ...] = ()
    """Groups of robots that differ, in the order of their numbers; empty: all are alike."""

    @model_validator(mode="before")
    @classmethod
    def _list_of_groups(cls, given: object) -> object:
        whole = {"groups": given} if isinstance(given, list | tuple) else given
        if isinstance(given, list | tuple) and not given:
            raise impossible("groups", "at least one group of robots", "none")
        return whole

    @model_validator(mode="after")
    def _sum_up(self) -> Self:
        check_unique("groups", [group.model for group in self.groups])
        if not self.groups:
            return self
        summed = {key: max(getattr(group, key) for group in self.groups) for key in SUMMED_UP}
        summed["count"] = sum(group.count for group in self.groups)
        for key, field in RobotModel.model_fields.items():
            if key in self.model_fields_set and getattr(self, key) != summed.get(key, field.default):
                raise impossible(key, "it in each group, where there are groups", getattr(self, key))
        self.__dict__.update(summed)
        return self

    @model_serializer(mode="wrap")
    def _as_given(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        content: dict[str, Any] = whole(self)
        left_out = RobotModel.model_fields.keys() if self.groups else {"groups"}
        return {key: value for key, value in content.items() if key not in left_out}

    @property
    def models(self) -> Sequence[RobotModel]:
        """The groups, or the one model of all robots."""
        return self.groups or (self,)

    @property
    def mean_radius(self) -> float:
        """Radius of equal discs that cover as much as those of the robots at the start [m]."""
        covered = sum(group.count * group.radius**2 for group in self.groups)
        return math.sqrt(covered / self.count) if self.groups else self.radius
