"""What a recording must hold to be read: the JSON objects of its blocks as models; further keys are for readers."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from clean_swarm_env.recording.by_hand import ByHand
from selector.documents.fields import Flag, NonNegative, Number, Positive, Share

MOST_NUMBERS = 2**28
"""Numbers of a part, in all its frames: a gigabyte of memory; the parts that we write take a twentieth of it."""
Amount = Annotated[int, Field(strict=True, ge=0, le=MOST_NUMBERS)]
Text = Annotated[str, Field(strict=True)]


class _Object(BaseModel):
    """A JSON object that may have further keys."""

    model_config = ConfigDict(extra="allow", frozen=True)


class _Channel(BaseModel):
    """A channel; see `Channel`."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: Text
    axes: tuple[Text, ...]
    shape: tuple[Amount, ...]
    scale: Annotated[int, Field(strict=True, ge=1, le=10**9)]
    order: Literal[1, 2]
    unit: Text
    about: Text

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if len(self.axes) != len(self.shape) or math.prod(self.shape) > MOST_NUMBERS:
            raise ValueError(f"expected axes {self.axes} of a length each and at most {MOST_NUMBERS} numbers together")
        return self


class Head(_Object):
    """The head of a recording."""

    channels: Annotated[tuple[_Channel, ...], Field(min_length=1)]
    """What every frame holds."""
    period: Positive
    """Time from frame to frame [s]."""
    width: Positive
    height: Positive
    robots: Amount
    items: Amount
    minds: Flag
    """Whether it holds what the robots' networks decided."""
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
