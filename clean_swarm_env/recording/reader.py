"""Recordings as arrays, and as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.channels import MOST_NUMBERS, Channel, packed_bytes, unpacked_frames
from clean_swarm_env.recording.file import HEAD, PART, SUFFIX, Directory, Head, blocks_of
from clean_swarm_env.recording.stepping import WholeNumbers
from clean_swarm_env.world.by_hand import Change
from clean_swarm_env.world.parts.shown import AnyArray
from selector.documents.errors import validated, within
from selector.documents.plain import short
from selector.documents.reading import json_value
from selforg.arrays import Floats
from selforg.registry import unknown

TableColumns = dict[str, AnyArray]
"""The columns of a table by their names, all of one length."""
Beginnings = tuple[str, ...] | Callable[[Mapping[str, Any]], tuple[str, ...]]
"""How the names of channels begin; or a function that finds that in the head."""


class NoFrames(ConfigurationError):
    """A run was stopped before its first frames were written."""


class RecordedStretch(Mapping[str, NDArray[Any]]):
    """Frames of a recorded mission that follow each other: channel -> values (T, ...), one frame a control period.

    Args:
        head: what the recording is about, as `docs/recordings.md` lists it.
        channels: name -> what the channel holds.
        whole: name -> whole numbers (T, K) of the channel.
        first: number of the first frame in the mission.

    Attributes:
        frames: T.

    """

    def __init__(
        self, head: dict[str, Any], channels: Mapping[str, Channel], whole: Mapping[str, WholeNumbers], first: int = 0
    ) -> None:
        self.head, self.channels, self.first, self._whole = head, dict(channels), first, whole
        self.frames = len(next(iter(whole.values()), ()))

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
        return np.arange(self.first, self.first + self.frames, dtype=np.float64) * self.period

    def whole(self, name: str) -> WholeNumbers:
        """Return the whole numbers (T, K) that the file holds of a channel."""
        return self._whole[self._known(name)]

    def at(self, frame: int, names: Iterable[str] | None = None) -> dict[str, NDArray[Any]]:
        """Return the values of channels, of all unless some are named, in a frame from 0."""
        own = slice(frame, frame + 1)
        return {name: self.channels[name].values(self.whole(name)[own])[0] for name in names or self}

    def _known(self, name: str) -> str:
        if name not in self.channels:
            raise KeyError(unknown("channel", name, list(self.channels)))
        return name


class RecordedParts(Iterator[RecordedStretch]):
    """The parts of a recording as they come, also of a mission that still runs; we write at most 250 frames in one.

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
        self.channels = {channel.name: channel for channel in listed}

    def __next__(self) -> RecordedStretch:
        """Return the next part."""
        for kind, content in self._blocks:
            if kind == HEAD or self.result is not None:
                raise ConfigurationError(f"{self._name}: damaged: expected nothing after the end, and one head")
            if kind == PART:
                return self._frames_of(content)
            self.result = _object(content, f"{self._name}: result")
        raise StopIteration

    def _frames_of(self, content: bytes) -> RecordedStretch:
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
        found = {}
        for channel, size in zip(columns, sizes, strict=True):
            with within(f"{where}: damaged: channel {channel.name}"):
                whole, used = unpacked_frames(rest, size, channel.order)
            rest = rest[used:]
            found[channel.name] = whole
        self.frames += frames
        return RecordedStretch(self.head, self.channels, found, directory.first)


def frames_from(parts: RecordedParts) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the frames of parts as they come: channel -> values of one moment."""
    for part in parts:
        values = dict(part)  # each channel is decoded once
        for frame in range(part.frames):
            yield {name: given[frame] for name, given in values.items()}


class RecordedMission(RecordedStretch):
    """A recorded mission.

    Frame i is the moment i * period: where robots are then, and what they then decide and do.

    Args:
        path: the file.
        only: how the names of the channels begin that are kept; all are unless it is given, and none by ().
        most: how many numbers may be kept: a small file can hold more than fit into the memory.

    Attributes:
        head: what the recording is about, as `docs/recordings.md` lists it.
        channels: name -> what the channel holds.
        notes: what was found out while the mission ran: the kinds of deposits.
        by_hand: what a person changed, in the order of time.
        result: the figures of the mission; None if the recording ends before the mission.
        frames: T.

    Raises:
        ConfigurationError: the file is none of ours, damaged, of a newer version, has no frame, or holds too much.

    """

    def __init__(self, path: Path, only: Beginnings = ("",), most: float = math.inf) -> None:
        self.path = path
        parts = RecordedParts(blocks_of(path), str(path))
        if callable(only):
            with within(str(path)):
                only = only(parts.head)
        channels = {name: channel for name, channel in parts.channels.items() if name.startswith(only)}
        kept: dict[str, list[WholeNumbers]] = {name: [] for name in channels}
        for part in parts:
            for name, pieces in kept.items():
                pieces.append(part.whole(name))
            if parts.frames * sum(channel.columns for channel in channels.values()) > most:
                raise ConfigurationError(f"{path}: expected at most {most:,.0f} numbers, for the memory, got more")
        if not parts.frames:
            raise NoFrames(f"{path}: has no frame: the run was stopped before the first ones were written")
        joined = {name: np.concatenate(kept.pop(name)) for name in channels}  # one after the other, to hold none twice
        super().__init__(parts.head, channels, joined)
        self.notes, self.by_hand, self.result, self.frames = parts.notes, parts.by_hand, parts.result, parts.frames


def recordings_in(folder: Path, only: Beginnings = ("",), most: float = math.inf) -> Iterator[RecordedMission]:
    """Yield the recordings below a directory, sorted by name; skip those without a frame.

    `only` and `most` are those of `RecordedMission`, the latter for all recordings together.
    """
    for path in sorted(folder.rglob(f"*{SUFFIX}")):
        with suppress(NoFrames):
            recording = RecordedMission(path, only, most)
            most -= sum(recording.whole(name).size for name in recording)
            yield recording


def tables_of(recording: RecordedStretch) -> dict[str, TableColumns]:
    """Return the tables of a recording, or of a stretch of it.

    Channels with the same axes are columns of one table: `robot` has the poses, `item` the items, `robot-behaviour` the
    marks of the robots' networks, `AvoidCollision.RepulsionGradient-behaviour` those inside an option. Every table
    begins with `frame`, `time` [s] and a number for each axis.
    """
    tables: dict[str, TableColumns] = {}
    for name, channel in recording.channels.items():
        prefix, _, column = name.rpartition("/")
        if prefix in ("held", "opinion"):  # of goals, about robots
            prefix, column = "", name.replace("/", "_")
        own = channel.axes[1:] if prefix else channel.axes
        title = "-".join(filter(None, (prefix.replace("/", "."), *own)))
        if title not in tables:
            places = np.indices((recording.frames, *channel.shape), dtype=np.int32).reshape(1 + len(channel.shape), -1)
            tables[title] = {"frame": places[0] + np.int32(recording.first), "time": recording.times[places[0]]}
            tables[title] |= dict(zip(channel.axes, places[1:], strict=True))
        tables[title][column] = recording[name].reshape(-1)
    return tables


class Happened(NamedTuple):
    """An event of a task itself, such as `item brought`."""

    time: float
    """Of the first frame after it [s]."""
    event: str
    axis: str
    """What it happened to: `robot`, `world`, or what things are called."""
    number: int
    """Of the robot or the thing."""


def events_of(recording: RecordedStretch) -> list[Happened]:
    """Return what happened in a recording by the events of its task, in the order of time and then of the task."""
    found = []
    for one in recording.head.get("events", ()):
        frames, numbers = np.nonzero(np.diff(recording.whole(one["of"]), axis=0, prepend=0) > 0)
        axis, times = recording.channels[one["of"]].axes[0], recording.times[frames].tolist()
        found += [Happened(time, one["event"], axis, k) for time, k in zip(times, numbers.tolist(), strict=True)]
    return sorted(found, key=lambda happened: happened.time)


def _object(content: bytes, where: str) -> dict[str, Any]:
    """Return a JSON object; ConfigurationError, which begins with `where`, for anything else."""
    try:
        found = json_value(content.decode(), where)
    except UnicodeDecodeError as error:
        raise ConfigurationError(f"{where}: expected text in UTF-8, got another byte at {error.start}") from error
    if not isinstance(found, dict):
        raise ConfigurationError(f"{where}: expected an object, got {short(found)}")
    return found
