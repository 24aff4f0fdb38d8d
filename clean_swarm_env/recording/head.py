"""The required content of a recording: the JSON objects of its blocks as models; further keys are for readers."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from clean_swarm_env.recording.by_hand import ByHand
from clean_swarm_env.recording.channels import MOST_NUMBERS, Amount, Channel, Text
from selector.documents.fields import Flag, NonNegative, Number, Positive, Share


class _Object(BaseModel):
    """A JSON object that may have further keys."""

    model_config = ConfigDict(extra="allow", frozen=True)


class Head(_Object):
    """The head of a recording."""

    channels: Annotated[tuple[Channel, ...], Field(min_length=1)]
    """The content of every frame."""
    period: Positive
    """Time from frame to frame [s]."""
    width: Positive
    height: Positive
    robots: Amount
    items: Amount
    minds: Flag
    """Whether it includes the decisions of the robots' networks."""
    about: dict[str, Any]
    """What the recording is of."""
    options: dict[str, tuple[Text, ...]]
    """Options by goal."""
    views: dict[str, tuple[NonNegative, ...]]
    """View distances of the options [m]."""
    mission: dict[str, Any]

    @model_validator(mode="after")
    def _unique(self) -> Self:
        if len({channel.name for channel in self.channels}) < len(self.channels):
            raise ValueError("channels: a name is there twice")
        return self


class _Deposit(_Object):
    """A kind of deposits."""

    diffusion: NonNegative
    evaporation_factor: Share
    evaporation_period: NonNegative
    min_diffusion: Number


class Directory(_Object):
    """The directory of a part."""

    first: Annotated[int, Field(strict=True, ge=0)]
    """Number of the first frame."""
    frames: Annotated[int, Field(strict=True, ge=1, le=MOST_NUMBERS)]
    sizes: tuple[tuple[Amount, Literal[1, 2, 4]], ...]
    """For each channel how many columns change, and the width of a number."""
    deposits: Annotated[tuple[_Deposit, ...], Field(max_length=63)] = ()
    by_hand: tuple[ByHand, ...] = ()
    """What was done by hand before these frames were decided."""
