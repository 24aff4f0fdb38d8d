"""Recordings as arrays."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.channels import Channel, unpacked_frames
from clean_swarm_env.recording.file import CLOSING, HEAD, blocks_of
from clean_swarm_env.recording.stepping import WholeNumbers
from selforg.arrays import Floats
from selforg.registry import unknown


class RecordedMission(Mapping[str, NDArray[Any]]):
    """A recorded mission: channel -> values (T, ...), one frame for each control period.

    Frame i is the moment i * period: where robots are then, and what they then decide and do.

    Attributes:
        head: what the recording is about, as `docs/recordings.md` lists it.
        channels: name -> what the channel holds.
        notes: what was found out while the mission ran: the kinds of deposits.
        result: the figures of the mission; None if the recording ends before the mission.
        frames: T.

    Raises:
        ConfigurationError: the file is none of ours, damaged, of a newer version, or has no frame.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.result: dict[str, Any] | None = None
        self.notes: dict[str, Any] = {}
        parts: list[list[WholeNumbers]] = []
        blocks = blocks_of(path)
        kind, content = next(blocks, (b"", b""))
        if kind != HEAD:
            raise ConfigurationError(f"{path}: damaged: expected a recording that begins with its head")
        self.head: dict[str, Any] = json.loads(content)
        listed = [Channel(**{**c, "axes": tuple(c["axes"]), "shape": tuple(c["shape"])}) for c in self.head["channels"]]
        self.channels = {channel.name: channel for channel in listed}
        for kind, content in blocks:
            if kind == CLOSING:
                self.result = json.loads(content)
            else:
                parts.append(self._frames_of(content))
        if not parts:
            raise ConfigurationError(f"{path}: holds no frame: the run was stopped before the first ones were written")
        joined = (np.concatenate(frames) for frames in zip(*parts, strict=True))
        self._whole = dict(zip(self.channels, joined, strict=True))
        self.frames = len(next(iter(self._whole.values())))

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

    def _frames_of(self, content: bytes) -> list[WholeNumbers]:
        (length,) = struct.unpack_from("<I", content)
        directory = json.loads(content[4 : 4 + length])
        self.notes = {name: note for name, note in directory.items() if name not in ("first", "frames", "sizes")}
        rest, found = memoryview(content)[4 + length :], []
        for channel, (changing, width) in zip(self.channels.values(), directory["sizes"], strict=True):
            sizes = (directory["frames"], channel.columns, changing, width)
            whole, used = unpacked_frames(rest, sizes, channel.order)
            rest = rest[used:]
            found.append(whole)
        return found
