"""The file of a recording: blocks that are written one after the other, so that a killed run leaves whole blocks.

The models at the end have the required content of the JSON objects in the blocks; further keys are for readers.
`docs/recordings.md` describes the bytes.
"""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Annotated, Any, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, model_validator

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.channels import MOST_NUMBERS, Amount, Channel, PackedFrames, Text
from clean_swarm_env.world.by_hand import Change, change_of
from selector.documents.fields import Flag, NonNegative, Number, Positive, Share
from selector.documents.writing import writing_to

SUFFIX: Final = ".swarm"
MAGIC: Final = b"\x93SWARM\r\n"
FORMAT_VERSION: Final = 1
HEAD, PART, CLOSING = b"HEAD", b"DATA", b"DONE"
BLOCK: Final = struct.Struct("<4sII")
"""Kind of a block, length of its content, and the CRC-32 of the content."""
MOST_BYTES: Final = 2**30
"""Largest content of a block; those that we write take a twentieth of it."""
MOST_AT_ONCE: Final = 2**20
"""Bytes that are read at once."""
LEVEL: Final = 2
"""Level of compression of zlib: level 6 takes three times as long for files that are 13 % smaller."""


class RecordingFile:
    """A recording that is being written.

    Args:
        path: the file; one that exists is replaced.
        head: what the recording is about.
        channels: the channels of every frame.

    Attributes:
        beginning: the bytes with which the recording begins.
        frames: how many frames have been written.

    """

    def __init__(self, path: Path, head: Mapping[str, Any], channels: Sequence[Channel]) -> None:
        self.path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb", buffering=0)  # a buffer would be written once more at the end
        except OSError as error:
            raise ConfigurationError(f"{path}: cannot be written ({error.strerror})") from error
        self.frames = 0
        described = {**head, "channels": [vars(channel) for channel in channels]}
        self.beginning = MAGIC + struct.pack("<I", FORMAT_VERSION) + _block(HEAD, _json(described))
        with writing_to(path, anew=True):
            self._write(self.beginning)

    def add(self, packed: PackedFrames, notes: Mapping[str, Any]) -> None:
        """Append frames; `notes` is plain data."""
        self._write(part_of(self.frames, packed, notes))
        self.frames += packed.frames

    def close(self, result: Mapping[str, Any] | None = None) -> None:
        """End the file; `result` is that of a mission that ended."""
        if result is not None:
            self._write(end_of(result))
        self._file.close()

    def _write(self, data: bytes) -> None:
        """Write a block; where it cannot be written whole, nothing of it stays."""
        begin, rest = self._file.tell(), memoryview(data)
        with writing_to(self.path):
            try:
                while rest:
                    rest = rest[self._file.write(rest) :]
            except OSError:
                self._file.truncate(begin)
                self._file.seek(begin)
                raise


def part_of(first: int, packed: PackedFrames, notes: Mapping[str, Any]) -> bytes:
    """Return the block of frames from number `first` on; `notes` is plain data."""
    directory = _json({"first": first, "frames": packed.frames, "sizes": packed.sizes, **notes})
    return _block(PART, struct.pack("<I", len(directory)) + directory + packed.content)


def end_of(result: Mapping[str, Any]) -> bytes:
    """Return the block with which the recording of a mission that has ended ends."""
    return _block(CLOSING, _json(result))


def blocks_of(path: Path) -> Iterator[tuple[bytes, bytes]]:
    """Yield kind and content of each whole block of a file; a last block that was cut off is left out.

    Raises:
        ConfigurationError: no file, no recording, a recording of a newer version, or a damaged one.

    """
    try:
        with path.open("rb") as file:
            yield from blocks_in(file, str(path))
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read ({error.strerror})") from error


def blocks_in(source: IO[bytes], name: str) -> Iterator[tuple[bytes, bytes]]:
    """Yield the blocks of a recording as they come, also of one that is still running; `name` begins its errors."""
    begins = source.read(len(MAGIC) + 4)
    if begins[: len(MAGIC)] != MAGIC or len(begins) < len(MAGIC) + 4:
        raise ConfigurationError(f"{name}: expected a recording of a mission ({SUFFIX}), got another kind of file")
    (version,) = struct.unpack_from("<I", begins, len(MAGIC))
    if version != FORMAT_VERSION:
        raise ConfigurationError(
            f"{name}: expected a recording of version {FORMAT_VERSION}, got version {version}; "
            "record the mission again, or read it with the Clean Swarm that wrote it"
        )
    at = len(begins)
    while len(facts := source.read(BLOCK.size)) == BLOCK.size:
        kind, length, checksum = BLOCK.unpack(facts)
        if kind not in (HEAD, PART, CLOSING):
            raise ConfigurationError(f"{name}: damaged at byte {at}: expected a block, got {kind!r}")
        small, at = _read(source, length), at + BLOCK.size
        if len(small) < length:
            return
        if zlib.crc32(small) != checksum:
            raise ConfigurationError(f"{name}: damaged: the checksum of the block at byte {at} is wrong")
        yield kind, _unpacked(small, f"{name}: damaged: the block at byte {at}")
        at += length


def _read(source: IO[bytes], length: int) -> bytes:
    """Return `length` bytes, or fewer at the end of the file; a damaged length takes no more memory than the file."""
    pieces = []
    while length and (piece := source.read(min(length, MOST_AT_ONCE))):
        pieces.append(piece)
        length -= len(piece)
    return b"".join(pieces)


def _block(kind: bytes, content: bytes) -> bytes:
    small = zlib.compress(content, LEVEL)
    return BLOCK.pack(kind, len(small), zlib.crc32(small)) + small


def _unpacked(small: bytes, where: str) -> bytes:
    """Return the content of a block; ConfigurationError, which begins with `where`, for one that is none."""
    unpacking = zlib.decompressobj()
    try:
        content = unpacking.decompress(small, MOST_BYTES)
    except zlib.error as error:
        raise ConfigurationError(f"{where} is not packed by zlib") from error
    if not unpacking.eof:
        raise ConfigurationError(f"{where} is cut, or has more than {MOST_BYTES} bytes")
    return content


def _json(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


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
    events: tuple[dict[str, Text], ...] = ()
    """Of the task itself: channel `of` numbers which go up when the `event` happens, and what it is `about`."""

    @model_validator(mode="after")
    def _unique(self) -> Self:
        if len({channel.name for channel in self.channels}) < len(self.channels):
            raise ValueError("channels: a name is there twice")
        for axis, count in (("robot", self.robots), ("item", self.items)):
            lengths = {
                length
                for channel in self.channels
                for name, length in zip(channel.axes, channel.shape, strict=True)
                if name == axis
            } or {0}
            if lengths != {count}:  # readers make room for as many
                raise ValueError(f"{axis}s: expected the length of all axes {axis}, {sorted(lengths)}, got {count}")
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
    by_hand: tuple[Annotated[Change, PlainValidator(change_of)], ...] = ()
    """What was done by hand before these frames were decided."""
