"""The file of a recording: blocks that are written one after the other, so that a killed run leaves whole blocks.

`docs/recordings.md` describes the bytes.
"""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, Final

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.channels import Channel, packed_frames
from clean_swarm_env.recording.stepping import WholeNumbers

SUFFIX: Final = ".swarm"
MAGIC: Final = b"\x93SWARM\r\n"
FORMAT_VERSION: Final = 1
HEAD, PART, CLOSING = b"HEAD", b"DATA", b"DONE"
BLOCK: Final = struct.Struct("<4sII")
"""Kind of a block, length of its content, and the CRC-32 of the content."""
MOST_BYTES: Final = 2**30
"""Largest content of a block; those that we write take a twentieth of it."""
LEVEL: Final = 2
"""Level of compression of zlib: level 6 takes three times as long for files that are 13 % smaller."""


class RecordingFile:
    """A recording that is being written.

    Args:
        path: the file; one that exists is replaced.
        head: what the recording is about.
        channels: the channels of every frame.

    """

    def __init__(self, path: Path, head: Mapping[str, Any], channels: Sequence[Channel]) -> None:
        self.path, self._channels = path, channels
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: IO[bytes] = path.open("wb")
        except OSError as error:
            raise ConfigurationError(f"{path}: cannot be written ({error.strerror})") from error
        self._file.write(MAGIC + struct.pack("<I", FORMAT_VERSION))
        self._write(HEAD, _json({**head, "channels": [channel.as_mapping() for channel in channels]}))

    def add(self, first: int, whole: Sequence[WholeNumbers], notes: Mapping[str, Any]) -> None:
        """Append frames from number `first` on: whole numbers (T, K) for each channel; `notes` is plain data."""
        sizes, contents = [], []
        for channel, numbers in zip(self._channels, whole, strict=True):
            changing, width, content = packed_frames(numbers, channel.order)
            sizes.append((changing, width))
            contents.append(content)
        directory = _json({"first": first, "frames": len(whole[0]), "sizes": sizes, **notes})
        self._write(PART, struct.pack("<I", len(directory)) + directory + b"".join(contents))

    def close(self, result: Mapping[str, Any] | None = None) -> None:
        """End the file; `result` is that of a mission that ended."""
        if result is not None:
            self._write(CLOSING, _json(result))
        self._file.close()

    def _write(self, kind: bytes, content: bytes) -> None:
        small = zlib.compress(content, LEVEL)
        self._file.write(BLOCK.pack(kind, len(small), zlib.crc32(small)) + small)
        self._file.flush()


def blocks_of(path: Path) -> Iterator[tuple[bytes, bytes]]:
    """Yield kind and content of each whole block; a last block that was cut off is left out.

    Raises:
        ConfigurationError: no file, no recording, a recording of a newer version, or a damaged one.

    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read ({error.strerror})") from error
    if data[: len(MAGIC)] != MAGIC or len(data) < len(MAGIC) + 4:
        raise ConfigurationError(f"{path}: expected a recording of a mission ({SUFFIX}), got another kind of file")
    (version,) = struct.unpack_from("<I", data, len(MAGIC))
    if version != FORMAT_VERSION:
        raise ConfigurationError(
            f"{path}: expected a recording of version {FORMAT_VERSION}, got version {version}; "
            "record the mission again, or read it with the Clean Swarm that wrote it"
        )
    at = len(MAGIC) + 4
    while at + BLOCK.size <= len(data):
        kind, length, checksum = BLOCK.unpack_from(data, at)
        begin, at = at + BLOCK.size, at + BLOCK.size + length
        if kind not in (HEAD, PART, CLOSING):
            raise ConfigurationError(f"{path}: damaged at byte {begin - BLOCK.size}: expected a block, got {kind!r}")
        if at > len(data):
            return
        if zlib.crc32(data[begin:at]) != checksum:
            raise ConfigurationError(f"{path}: damaged: the checksum of the block at byte {begin} is wrong")
        yield kind, _unpacked(data[begin:at], f"{path}: damaged: the block at byte {begin}")


def _unpacked(small: bytes, where: str) -> bytes:
    """Return the content of a block; ConfigurationError, which begins with `where`, for one that is none."""
    unpacking = zlib.decompressobj()
    try:
        content = unpacking.decompress(small, MOST_BYTES)
    except zlib.error as error:
        raise ConfigurationError(f"{where} is not packed by zlib") from error
    if not unpacking.eof:
        raise ConfigurationError(f"{where} is cut, or holds more than {MOST_BYTES} bytes")
    return content


def _json(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()
