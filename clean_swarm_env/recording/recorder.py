"""The recorder of a batch of worlds: one file for each mission, written while the mission runs.

Recording reads arrays only, so that a mission has the same course, bit for bit, with and without it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, NoReturn, SupportsIndex

import numpy as np

from clean_swarm_env.recording.channels import MILLI, AnyArray, Channel, Part, point_channels, same
from clean_swarm_env.recording.file import SUFFIX, RecordingFile, part_of
from clean_swarm_env.recording.messages import MessageLog
from clean_swarm_env.recording.sampled import Sampled, floor_arrays, mind_arrays, networks_of
from clean_swarm_env.world.mission import result_of
from clean_swarm_env.world.mission_end import tick_limit
from clean_swarm_env.world.worlds import Worlds
from selector.coordination.coordinator import Coordinator
from selforg.arrays import Floats
from selforg.elementary import directions
from selforg.gradients.store import columns as c
from selforg.network.state.state import EXPLAINED_LAYERS

MOST_FRAMES: Final = 256
"""Frames that wait for being written; a killed run loses at most these."""
WAITING_BYTES: Final = 1 << 25
"""Memory for these frames; worlds with many robots and minds keep fewer."""
LEAST_FRAMES: Final = 16


@dataclass(frozen=True)
class RecordSettings:
    """Settings of recordings: their directory, their names, and what they hold."""

    directory: Path
    """Directory of the files; made if it is missing."""
    minds: bool = False
    """Whether the networks of the robots are recorded, too."""
    about: Mapping[str, Any] = field(default_factory=dict)
    """Plain data for the heads of all files: `experiment`, and the `condition` that is part of their names."""
    name: str = ""
    """Name of the file of a single mission; made of scenario and condition unless given."""
    thinking: bool = False
    """Whether `MissionRecorder.think` will be told what the chooser of options thinks of each."""


@dataclass
class _Running:
    """A mission that is being recorded."""

    file: RecordingFile
    begun: int
    """Place in the buffers of the first frame that is not written yet."""
    first: int
    """Number of this frame."""


class MissionRecorder:
    """Records the worlds of a batch: call `begin` after the reset of a world, and `take` after every tick.

    Missions end by themselves. `close` ends the files of missions that are still going on.

    Args:
        worlds: the worlds; `explained` ones if minds are to be recorded.
        settings: directory, names and content of the files.

    """

    def __init__(self, worlds: Worlds, settings: RecordSettings) -> None:
        if settings.minds and worlds.network.state.mark_table.shape[1] != EXPLAINED_LAYERS:
            raise ValueError("minds: expected worlds with explained=True, got worlds that note no reasons")
        self.worlds, self.settings = worlds, settings
        self._running: dict[int, _Running] = {}
        self._names: set[str] = set()
        self._ticks = 0
        self._ends: dict[int, int] = {}  # value of `_ticks` at which the time of each mission is over
        self._messages = MessageLog(worlds)
        self._opinions: dict[str, Floats] = {}
        self._poses: Floats = np.zeros((worlds.rows, 3))
        arrays = [*self._pose_arrays(), *floor_arrays(worlds), *self._messages.arrays()]
        arrays += [self._opinion(c) for c in worlds.coordinators if settings.thinking]
        arrays += mind_arrays(worlds) if settings.minds else []
        frame = sum(s.array.size * np.dtype(s.kept or s.array.dtype).itemsize for s in arrays)
        self.room = int(np.clip(WAITING_BYTES // frame, LEAST_FRAMES, MOST_FRAMES))
        buffers = (np.zeros((self.room, *s.array.shape), s.kept or s.array.dtype) for s in arrays)
        self._arrays = list(zip(arrays, buffers, strict=True))
        self._always = [(buffer, s.array) for s, buffer in self._arrays if s.option is None]
        self._of_option: dict[tuple[int, int], list[tuple[AnyArray, AnyArray]]] = {}
        for s, buffer in self._arrays:
            if s.option is not None:
                self._of_option.setdefault(s.option, []).append((buffer, s.array))
        self._held = {option: np.zeros(self.room, dtype=np.bool_) for option in self._of_option}
        self._channels = [channel for sampled in arrays for channel, _ in sampled.parts]
        self._at = 0
        self._joined = worlds.team.joined.tobytes()
        self._by_hand: list[dict[str, Any]] = []  # what was done by hand and is not in the file yet

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raise TypeError: two recorders would write one file."""
        raise TypeError("a batch that records its missions cannot be copied, because both would write the same files")

    def begin(self, world: int, about: Mapping[str, Any]) -> Path:
        """Record the mission of a world that has just been reset; return the file.

        `about`: plain data for the head; `scenario` is part of the name of the file.
        """
        self._end(world)
        worlds, mission = self.worlds, self.worlds.missions[world]
        facts: dict[str, Any] = {
            "about": {**self.settings.about, **about},
            "period": worlds.period,
            "ticks_per_decision": round(mission.decision_period * mission.world.control_rate),
            "width": mission.world.width,
            "height": mission.world.height,
            "robots": worlds.robots,
            "items": worlds.garbage.stage.shape[1],
            "minds": self.settings.minds,
            "options": {c.model.goal: c.model.options for c in worlds.coordinators},
            "views": {c.model.goal: [content.view_distance for content in c.contents] for c in worlds.coordinators},
            "mission": mission.model_dump(mode="json"),
        }
        facts |= networks_of(worlds) if self.settings.minds else {}
        path = self._path(facts["about"])
        self._running[world] = _Running(RecordingFile(path, facts, self._channels), self._at, 0)
        self._ends[world] = self._ticks + tick_limit(mission)
        self._joined = worlds.team.joined.tobytes()
        self._messages.begin()
        self._note_poses()
        return path

    def think(self, goal: str, values: Floats) -> None:
        """Note what the chooser of options thinks of each option of a goal from the next frame on: values (R, O)."""
        self._opinions[goal][:] = values

    def note_by_hand(self, change: Mapping[str, Any]) -> None:
        """Note what was done by hand, plain data, before the next tick of the only world."""
        self._by_hand.append(dict(change))
        self._note_poses()

    def take(self) -> None:
        """Record the tick that the worlds have just run."""
        if not self._running:
            return
        worlds, at = self.worlds, self._at
        if worlds.team.joined.tobytes() != self._joined:
            self._note_joined()
        self._messages.count()
        for buffer, array in self._always:
            buffer[at] = array
        for option in self._options_in_use():
            self._held[option][at] = True
            for buffer, array in self._of_option[option]:
                buffer[at] = array
        self._messages.begin()
        self._note_poses()
        self._at += 1
        self._ticks += 1
        cleaned = worlds.cleaned.tolist()
        if True in cleaned or self._ticks >= min(self._ends.values()):
            for world in [w for w in self._running if cleaned[w] or self._ticks >= self._ends[w]]:
                self._end(world, asdict(result_of(worlds, world)))
        if self._at == self.room:
            self._write_all()

    @property
    def beginning(self) -> bytes:
        """The bytes with which the recording of the first world begins, while its mission runs."""
        return self._running[0].file.beginning

    def latest(self, notes: Mapping[str, Any]) -> bytes:
        """Return the last frame of the only world as the block of a recording, with `notes`, for those who look on."""
        numbers = []
        for sampled, buffer in self._arrays:
            values = buffer[[self._at - 1]] if sampled.option is None else sampled.array[None]
            numbers += [channel.whole(part(values)) for channel, part in sampled.parts]
        first = int(self.worlds.ticks[0]) - 1
        return part_of(self._channels, first, numbers, {"deposits": self._messages.kinds, **notes})

    def close(self) -> None:
        """Write all frames that are not in a file yet, and end all files."""
        for world in list(self._running):
            self._end(world)
        self._messages.close()

    def _pose_arrays(self) -> list[Sampled]:
        robots = ("robot", self.worlds.robots)
        heading = Channel("heading", robots[:1], robots[1:], MILLI, 1, "rad", "where the robot looks")
        turned: Part = (heading, lambda poses: poses[..., 2])
        return [Sampled(self._poses, (*point_channels("", (robots,), "where the robot is", order=2), turned))]

    def _opinion(self, coordinator: Coordinator) -> Sampled:
        worlds, model, goal = self.worlds, coordinator.model, coordinator.model.goal
        self._opinions[goal] = np.tile(model.scores, (worlds.rows, 1))
        about = "what the chooser of options thinks of each: a score, an estimate or a probability"
        shape = (worlds.robots, len(model.options))
        channel = Channel(f"opinion/{goal}", ("robot", "option"), shape, MILLI, 1, "-", about)
        return Sampled(self._opinions[goal], ((channel, same),))

    def _note_poses(self) -> None:
        """Keep the poses at the end of a tick: those of the next frame."""
        physics = self.worlds.physics
        self._poses[:, :2] = physics.positions
        self._poses[:, 2] = physics.headings

    def _note_joined(self) -> None:
        """Put robots that joined in this tick where they joined: their poses have been spread there."""
        worlds = self.worlds
        before = np.frombuffer(self._joined, dtype=np.int64)
        for world in np.flatnonzero(worlds.team.joined != before).tolist():
            rows = worlds.rows_of(world)[before[world] : worlds.team.joined[world]]
            own = worlds.minds.poses.own[rows, 0]
            self._poses[rows, :2] = own[:, [c.X, c.Y]]
            self._poses[rows, 2] = directions(own[:, c.POSE_HEADING : c.POSE_HEADING + 2])
        self._joined = worlds.team.joined.tobytes()

    def _options_in_use(self) -> Iterable[tuple[int, int]]:
        """Return the coordinators and options whose networks may have changed; all for the first frame of a part."""
        if not self._at:
            return self._of_option
        if not self._of_option:
            return ()
        return [(c, k) for c, coordinator in enumerate(self.worlds.coordinators) for k in coordinator.used]

    def _path(self, about: Mapping[str, Any]) -> Path:
        words = (str(about[name]) for name in ("scenario", "condition") if about.get(name))
        stem = self.settings.name.removesuffix(SUFFIX) or re.sub(r"[^\w.#+=-]+", "_", "-".join(words))
        name, number = stem, 1
        while name in self._names:
            number += 1
            name = f"{stem}-{number}"
        self._names.add(name)
        return self.settings.directory / f"{name}{SUFFIX}"

    def _end(self, world: int, result: Mapping[str, Any] | None = None) -> None:
        if world in self._running:
            self._write(world)
            del self._ends[world]
            self._running.pop(world).file.close(result)

    def _write_all(self) -> None:
        for world in self._running:
            self._write(world)
            self._running[world].begun = 0
        for held in self._held.values():
            held[:] = False
        self._at = 0

    def _write(self, world: int) -> None:
        """Write the frames of a world that are not in its file yet."""
        running, count = self._running[world], self.worlds.worlds
        frames = slice(running.begun, self._at)
        if frames.start == frames.stop:
            return
        numbers = []
        latest = {option: np.maximum.accumulate(held * np.arange(len(held))) for option, held in self._held.items()}
        for sampled, buffer in self._arrays:
            own = buffer.shape[1] // count
            taken = frames if sampled.option is None else latest[sampled.option][frames]
            values = buffer[taken, world * own : (world + 1) * own]
            numbers += [channel.whole(part(values)) for channel, part in sampled.parts]
        running.file.add(running.first, numbers, {"deposits": self._messages.kinds, "by_hand": self._by_hand})
        self._by_hand.clear()
        running.first += frames.stop - frames.start
        running.begun = self._at
