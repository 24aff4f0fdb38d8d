"""Recordings as arrays."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.by_hand import Change
from clean_swarm_env.recording.channels import Channel, packed_bytes, unpacked_frames
from clean_swarm_env.recording.file import HEAD, PART, SUFFIX, blocks_of
from clean_swarm_env.recording.head import MOST_NUMBERS, Directory, Head
from clean_swarm_env.recording.stepping import WholeNumbers
from selector.documents.errors import validated
from selector.documents.plain import short
from selector.documents.reading import json_value
from selforg.arrays import Floats
from selforg.registry import unknown


class NoFrames(ConfigurationError):
    """A run was stopped before its first frames were written."""


class RecordedParts(Iterator[list[WholeNumbers]]):
    """The parts of a recording as they come: whole numbers (T, K) of each channel, also of a mission that still runs.

    Args:
        blocks: the blocks of the recording.
        name: begins the text of errors.

    Attributes:
        head, channels, notes, by_hand, result, frames: as those of `RecordedMission`, of the parts until now.

    """

    def __init__(self, blocks: Iterator[tuple[bytes, bytes]], name: str) -> None:
        self._blocks, self._name = blocks, name
        self.result: dict[str, Any] | None = None
        self.notes: dict[str, Any] = {}
        self.by_hand: list[Change] = []
        self.frames = 0
        kind, content = next(blocks, (b"", b""))
        if kind != HEAD:
            raise ConfigurationError(f"{name}: damaged: expected a recording that begins with its head")
        self.head = _object(content, f"{name}: head")
        listed = validated(Head, self.head, f"{name}: head").channels
        self.channels = {channel.name: Channel(**channel.model_dump()) for channel in listed}

    def __next__(self) -> list[WholeNumbers]:
        """Return the next part."""
        for kind, content in self._blocks:
            if kind == HEAD or self.result is not None:
                raise ConfigurationError(f"{self._name}: damaged: expected nothing after the end, and one head")
            if kind == PART:
                return self._frames_of(content)
            self.result = _object(content, f"{self._name}: result")
        raise StopIteration

    def _frames_of(self, content: bytes) -> list[WholeNumbers]:
        where = f"{self._name}: frames from {self.frames} on"
        length = int.from_bytes(content[:4], "little")
        given = _object(content[4 : 4 + length], where)
        directory = validated(Directory, given, where)
        self.notes = {name: note for name, note in given.items() if name not in ("first", "frames", "sizes", "by_hand")}
        self.by_hand += directory.by_hand
        rest, frames, columns = memoryview(content)[4 + length :], directory.frames, list(self.channels.values())
        if directory.first != self.frames or len(directory.sizes) != len(columns):
            raise ConfigurationError(f"{where}: damaged: a part of other channels or frames, from {directory.first} on")
        sizes = [(frames, channel.columns, *size) for channel, size in zip(columns, directory.sizes, strict=True)]
        fitting = frames * sum(channel.columns for channel in columns) <= MOST_NUMBERS
        if not fitting or any(size[2] > size[1] for size in sizes) or len(rest) != sum(map(packed_bytes, sizes)):
            raise ConfigurationError(f"{where}: damaged: the sizes of channels do not fit the content")
        found = []
        for channel, size in zip(columns, sizes, strict=True):
            try:
                whole, used = unpacked_frames(rest, size, channel.order)
            except ValueError as error:
                raise ConfigurationError(f"{where}: damaged: channel {channel.name}: {error}") from error
            rest = rest[used:]
            found.append(whole)
        self.frames += frames
        return found


def frames_from(parts: RecordedParts) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the frames of parts as they come: channel -> values of one moment."""
    for part in parts:
        values = {
            channel.name: channel.values(whole) for channel, whole in zip(parts.channels.values(), part, strict=True)
        }
        for frame in range(len(part[0])):
            yield {name: given[frame] for name, given in values.items()}


class RecordedMission(Mapping[str, NDArray[Any]]):
    """A recorded mission: channel -> values (T, ...), one frame for each control period.

    Frame i is the moment i * period: where robots are then, and what they then decide and do.

    Attributes:
        head: what the recording is about, as `docs/recordings.md` lists it.
        channels: name -> what the channel holds.
        notes: what was found out while the mission ran: the kinds of deposits.
        by_hand: what a person changed, in the order of time.
        result: the figures of the mission; None if the recording ends before the mission.
        frames: T.

    Raises:
        ConfigurationError: the file is none of ours, damaged, of a newer version, or has no frame.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        parts = RecordedParts(blocks_of(path), str(path))
        read = list(parts)
        if not read:
            raise NoFrames(f"{path}: holds no frame: the run was stopped before the first ones were written")
        self.head, self.channels, self.notes = parts.head, parts.channels, parts.notes
        self.by_hand, self.result, self.frames = parts.by_hand, parts.result, parts.frames
        joined = (np.concatenate(frames) for frames in zip(*read, strict=True))
        self._whole = dict(zip(self.channels, joined, strict=True))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the values (T, ...) of a channel, in its unit."""
        return self.channels[self._known(name)].values(self._whole[name])

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the channels."""
        return iter(self.channels)

    def __len__(self) -> int:
        """Return the number of channels."""
        return len(self.channels)

    @property
    def period(self) -> float:
        """Time from frame to frame [s]."""
        return float(self.head["period"])

    @property
    def times(self) -> Floats:
        """Times (T,) of the frames [s]."""
        return np.arange(self.frames, dtype=np.float64) * self.period

    def whole(self, name: str) -> WholeNumbers:
        """Return the whole numbers (T, K) that the file holds of a channel."""
        return self._whole[self._known(name)]

    def checksums(self) -> dict[str, int]:
        """Return the CRC-32 of the whole numbers (T, K) of each channel, as int32 in little-endian order."""
        return {name: zlib.crc32(numbers.astype("<i4").tobytes()) for name, numbers in self._whole.items()}

    def _known(self, name: str) -> str:
        if name not in self.channels:
            raise KeyError(unknown("channel", name, list(self.channels)))
        return name


def recordings_in(folder: Path) -> Iterator[RecordedMission]:
    """Yield the recordings below a directory in the order of their names, but for those without a frame."""
    for path in sorted(folder.rglob(f"*{SUFFIX}")):
        with suppress(NoFrames):
            yield RecordedMission(path)


def _object(content: bytes, where: str) -> dict[str, Any]:
    """Return a JSON object; ConfigurationError, which begins with `where`, for anything else."""
    try:
        found = json_value(content.decode(), where)
    except UnicodeDecodeError as error:
        raise ConfigurationError(f"{where}: expected text in UTF-8, got another byte at {error.start}") from error
    if not isinstance(found, dict):
        raise ConfigurationError(f"{where}: expected an object, got {short(found)}")
    return found
