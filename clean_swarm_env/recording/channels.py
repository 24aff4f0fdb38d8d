"""Channels of a recording: what each holds, and how its numbers become bytes and numbers again.

A channel has one frame for each control period. Its numbers are kept as whole numbers, rounded multiples of 1 / scale,
as differences in time. `docs/recordings.md` describes the bytes.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Annotated, Final, Literal, NamedTuple, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator
from pydantic.dataclasses import dataclass

from clean_swarm_env.recording.stepping import WholeNumbers
from clean_swarm_env.world.parts.shown import AnyArray

LARGEST_WHOLE: Final = 2**30 - 1
"""Largest whole number that a channel holds; what is beyond is kept as this number."""
MILLI: Final = 1000
"""Steps of a metre, of a radian, and of the numbers of a network."""
MOST_NUMBERS: Final = 2**28
"""Numbers of a part, in all its frames: a gigabyte of memory; the parts that we write take a twentieth of it."""
Amount = Annotated[int, Field(strict=True, ge=0, le=MOST_NUMBERS)]
Text = Annotated[str, Field(strict=True)]


@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Channel:
    """A channel: its name, axes, steps, unit and meaning; one that is read from a file is checked."""

    name: Text
    axes: tuple[Text, ...]
    """Names of the axes of a frame."""
    shape: tuple[Amount, ...]
    """Their lengths."""
    scale: Annotated[int, Field(strict=True, ge=1, le=10**9)]
    """Steps of a unit: values are whole numbers divided by this."""
    order: Literal[1, 2]
    """How often differences are taken in time."""
    unit: Text
    """Unit of the values, - for pure numbers."""
    about: Text
    """One line for readers."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if len(self.axes) != len(self.shape) or prod(self.shape) > MOST_NUMBERS:
            raise ValueError(f"expected axes {self.axes} of a length each and at most {MOST_NUMBERS} numbers together")
        return self

    @property
    def columns(self) -> int:
        """How many numbers a frame has, K."""
        return prod(self.shape)

    def whole(self, values: AnyArray) -> WholeNumbers:
        """Return values (T, ...) as whole numbers (T, K); NaN is 0."""
        flat = values.reshape(len(values), self.columns)
        if flat.dtype.kind in "bi" and self.scale == 1:
            return flat.astype(np.int32)
        steps = np.nan_to_num(flat * float(self.scale), posinf=LARGEST_WHOLE, neginf=-LARGEST_WHOLE)
        return np.rint(steps).clip(-LARGEST_WHOLE, LARGEST_WHOLE).astype(np.int32)

    def values(self, whole: WholeNumbers) -> AnyArray:
        """Return whole numbers (T, K) as values (T, ...): floats, or whole numbers where the scale is 1."""
        shaped = whole.reshape(len(whole), *self.shape)
        return shaped if self.scale == 1 else shaped / self.scale


def channel_of(
    name: str, axes: Mapping[str, int], about: str, scale: int = 1, unit: str = "-", order: Literal[1, 2] = 1
) -> Channel:
    """Return a channel by its axes with their lengths; of whole numbers unless a scale is given."""
    return Channel(name, tuple(axes), tuple(axes.values()), scale, order, unit, about)


class PackedFrames(NamedTuple):
    """T >= 1 frames as bytes: of each channel the first frame, which columns change, and their differences in time."""

    frames: int
    """T."""
    sizes: list[tuple[int, int]]
    """For each channel how many columns change, and the width of a number."""
    content: bytes


def packed_bytes(sizes: tuple[int, int, int, int]) -> int:
    """Return how many bytes `pack_steps` makes of a channel; `sizes` as in `unpacked_frames`."""
    frames, count, changed, width = sizes
    return 4 * count + -(-count // 8) + changed * (frames - 1) * width


def unpacked_frames(content: memoryview, sizes: tuple[int, int, int, int], order: int) -> tuple[WholeNumbers, int]:
    """Return the whole numbers (T, K) of a channel that `pack_steps` packed, and the number of bytes that they took.

    sizes: T, K, how many columns change, and the width of a number.
    """
    frames, count, changed, width = sizes
    at = 4 * count
    first = np.frombuffer(content[:at], dtype="<i4")
    bits = np.frombuffer(content[at : at + -(-count // 8)], dtype=np.uint8)
    at += len(bits)
    changing = np.unpackbits(bits, count=count, bitorder="little").astype(np.bool_)
    if changing.sum() != changed:
        raise ValueError(f"expected {changed} columns that change, got marks of {changing.sum()}")
    end = at + changed * (frames - 1) * width
    planes = np.frombuffer(content[at:end], dtype=np.uint8).reshape(width, -1)
    steps = np.ascontiguousarray(planes.T).view(f"<i{width}").reshape(changed, frames - 1).T.astype(np.int32)
    for _ in range(order):
        steps = np.cumsum(steps, axis=0, dtype=np.int32)
    whole = np.tile(first.astype(np.int32), (frames, 1))
    whole[1:, changing] += steps
    return whole, end
