"""The recorder of a batch of worlds: one file for each mission, written while the mission runs.

Recording reads arrays only, so that a mission has the same course, bit for bit, with and without it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain, count
from pathlib import Path
from typing import Any, NoReturn, SupportsIndex

import numpy as np

from clean_swarm_env.recording.channels import MILLI, channel_of
from clean_swarm_env.recording.file import SUFFIX, RecordingFile, part_of
from clean_swarm_env.recording.messages import MessageLog
from clean_swarm_env.recording.sampled import (
    check_shown,
    floor_arrays,
    mind_arrays,
    networks_of,
    points,
    things_of,
    walls_shown,
    zones_shown,
)
from clean_swarm_env.recording.stepping import copy_poses
from clean_swarm_env.recording.taking import Sampled, WaitingFrames
from clean_swarm_env.world.mission import result_of
from clean_swarm_env.world.mission_end import tick_limit
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.running import RunningConfiguration
from selector.coordination.coordinator import Coordinator
from selforg.arrays import Floats, Ints
from selforg.elementary import directions
from selforg.gradients.store import columns as c
from selforg.plugins import broken


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
    """Whether `MissionRecorder.think` will get the chooser's opinion of each option."""
    policies: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """The trained networks that may choose, by name, as plain data; with minds their inputs are recorded, too."""

    put: bool = False
    """Whether things may be put elsewhere by hand, so that the places of all of them are recorded."""
    kept: bool = False
    """Whether a file that is there already is kept: the new one gets a number behind its name."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the components of an observation that are recorded, each once."""
        seen = [name for policy in self.policies.values() for name in policy["observations"]]
        return tuple(dict.fromkeys(seen)) if self.minds else ()


class MissionRecorder:
    """Records the worlds of a batch: call `open` after the reset of a world, and `record` after every tick.

    Missions end by themselves. `close` ends the files of missions that are still going on.

    Args:
        worlds: the worlds; `explained` ones if minds are to be recorded.
        settings: directory, names and content of the files.

    """

    def __init__(self, worlds: Worlds, settings: RecordSettings) -> None:
        if settings.minds and not worlds.network.explained:
            raise ValueError("minds: expected worlds with explained=True, got worlds that note no reasons")
        self.worlds, self.settings = worlds, settings
        self._running: dict[int, RecordingFile] = {}
        self._names: set[str] = set()
        self._limits: Ints = np.zeros(worlds.worlds, dtype=np.int64)  # control periods of each mission
        self._messages = MessageLog(worlds)
        self._opinions: dict[str, Floats] = {}
        self._poses: Floats = np.zeros((worlds.rows, 3))
        self._moving = [thing.places for thing in worlds.task.around if thing.moves or settings.put]
        self._moved: Floats = np.zeros((worlds.worlds, sum(places.shape[1] for places in self._moving), 2))
        self._shown = [one for one in worlds.task.shown() if one.recorded]
        check_shown(worlds, self._shown)
        sampled = [*self._pose_arrays(), *floor_arrays(worlds, self._shown), *self._messages.arrays()]
        sampled += [self._opinion(c) for c in worlds.coordinators if settings.thinking]
        sampled += mind_arrays(worlds) if settings.minds else []
        self._inputs: Floats = np.zeros((worlds.rows, len(settings.inputs)))
        if settings.inputs:
            axes = {"robot": worlds.robots, "input": len(settings.inputs)}
            saw = channel_of("input", axes, "what a policy saw when it last decided", MILLI)
            sampled.append(Sampled(saw, self._inputs))
        names = [one.channel.name for one in sampled]
        if twice := next((name for name in names if names.count(name) > 1), ""):
            raise broken(worlds.task, "shown", f"expected names that no other channel of a recording has, got {twice}")
        self.frames = WaitingFrames(sampled, worlds.worlds)
        self._begun = False  # whether a mission has begun since the last frame
        self._joined = worlds.team.joined.copy()
        self._networks = networks_of(worlds) if settings.minds else {}
        self._by_hand: list[dict[str, Any]] = []  # what was done by hand and is not in the file yet

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raise TypeError: two recorders would write one file."""
        raise TypeError("a batch that records its missions cannot be copied, because both would write the same files")

    def open(self, world: int, about: Mapping[str, Any]) -> Path:
        """Record the mission of a world that has just been reset; return the file.

        `about`: plain data for the head; `scenario` is part of the name of the file.
        """
        self._end(world)
        worlds, mission = self.worlds, self.worlds.missions[world]
        width, height = mission.extent
        task = worlds.task
        items = [one.values.shape[1] for one in task.shown() if one.axis == "item"]
        facts: dict[str, Any] = {
            "about": {**self.settings.about, **about},
            "period": worlds.period,
            "ticks_per_decision": round(mission.decision_period * mission.world.control_rate),
            "width": width,
            "height": height,
            "counted_distances": mission.counted_distances,
            "robots": worlds.robots,
            "items": items[0] if items else 0,
            "events": [{"of": one.name, "event": one.event, "about": one.about} for one in self._shown if one.event],
            "drawn": [one._asdict() for one in task.drawn()],
            "minds": self.settings.minds,
            "options": {c.model.goal: c.model.options for c in worlds.coordinators},
            "views": {c.model.goal: [content.view_distance for content in c.contents] for c in worlds.coordinators},
            "mission": mission.model_dump(mode="json"),
            "option_words": {c.model.goal: [_first_sentence(one) for one in c.contents] for c in worlds.coordinators},
        }
        if mission.robots.groups:
            facts["models"] = mission.models.tolist()
        prices = task.prices(mission)
        facts |= self._networks | ({"prices": prices} if prices else {})
        if not items:
            facts["ground"], facts["field"] = mission.world.ground, max(mission.world.width, mission.world.height)
            facts["things"] = list(things_of(worlds, world, moving=self.settings.put))
        if mission.world.zones:
            facts["zones"] = zones_shown(worlds)
        if mission.world.has_walls:
            facts["walls"] = walls_shown(worlds).tolist()
        if mission.world.ground == "walled":
            facts["ground"], facts["shown"] = mission.world.ground, mission.size.tolist()
        if self.settings.inputs:
            facts |= {"inputs": self.settings.inputs, "policies": self.settings.policies}
        path = self._path(facts["about"])
        self._running[world] = RecordingFile(path, facts, self.frames.channels)
        self.frames.start(world)
        self._limits[world], self._begun = tick_limit(mission), True
        self._joined = worlds.team.joined.copy()
        self._messages.clear()
        self.note_poses()
        return path

    def think(self, goal: str, values: Floats) -> None:
        """Note the chooser's opinion of each option of a goal from the next frame on: values (R, O).

        Nothing where the settings have no `thinking`.
        """
        if self.settings.thinking:
            self._opinions[goal][:] = values

    def note_inputs(self, values: Floats) -> None:
        """Note what the policy sees (R, K) from the next frame on, in the order of the settings' `inputs`."""
        self._inputs[:] = values

    def note_by_hand(self, change: Mapping[str, Any]) -> None:
        """Note a change by hand, plain data, before the next tick of the only world."""
        self._by_hand.append(dict(change))
        self.note_poses()

    def record(self) -> None:
        """Record the tick that the worlds have just run."""
        if not self._running:
            return
        worlds = self.worlds
        if (worlds.team.joined != self._joined).any():
            self._note_joined()
        self.frames.record(None if self._begun else [coordinator.used for coordinator in worlds.coordinators])
        self._begun = False
        self._messages.clear()
        self.note_poses()
        over = worlds.done | (worlds.ticks >= self._limits)
        for world in [world for world in self._running if over[world]]:
            self._end(world, result_of(worlds, world).as_mapping())
        if self.frames.at == self.frames.room:
            for world in self._running:
                self._write(world)
            self.frames.restart(self._running)

    @property
    def beginning(self) -> bytes:
        """The bytes with which the recording of the first world begins, while its mission runs."""
        return self._running[0].beginning

    def latest(self, notes: Mapping[str, Any]) -> bytes:
        """Return the last frame of the only world as the block of a recording, with `notes`, for those who look on."""
        first = int(self.worlds.ticks[0]) - 1
        return part_of(first, self.frames.latest(0), {"deposits": self._messages.kinds, **notes})

    def present(self, notes: Mapping[str, Any]) -> bytes:
        """Return the only world as it is now, before its next frame, as a block that is part of no recording."""
        notes = {"deposits": self._messages.kinds, **notes}
        return part_of(int(self.worlds.ticks[0]), self.frames.present(0), notes)

    def close(self) -> None:
        """Write all frames that are not in a file yet, and end all files."""
        for world in list(self._running):
            self._end(world)
        self._messages.close()

    def _pose_arrays(self) -> list[Sampled]:
        robots, poses = {"robot": self.worlds.robots}, self._poses
        heading = channel_of("heading", robots, "where the robot looks", MILLI, "rad")
        places = points("", robots, poses[:, :2], "where the robot is", order=2)
        moved = points("thing", {"thing": self._moved.shape[1]}, self._moved, "where a thing is that moves")
        return [*places, Sampled(heading, poses[:, 2]), *(moved if self._moving else ())]

    def _opinion(self, coordinator: Coordinator) -> Sampled:
        worlds, model, goal = self.worlds, coordinator.model, coordinator.model.goal
        self._opinions[goal] = np.tile(model.scores, (worlds.rows, 1))
        about = "what the chooser of options thinks of each: a score, an estimate or a probability"
        axes = {"robot": worlds.robots, "option": len(model.options)}
        return Sampled(channel_of(f"opinion/{goal}", axes, about, MILLI), self._opinions[goal])

    def note_poses(self) -> None:
        """Keep the poses at the end of a tick, and the places of things that move: those of the next frame."""
        copy_poses(self.worlds.physics.positions, self.worlds.physics.headings, self._poses)
        if self._moving:
            np.concatenate(self._moving, axis=1, out=self._moved)

    def _note_joined(self) -> None:
        """Put robots that joined in this tick where they joined: their poses have been spread there."""
        worlds = self.worlds
        for world in np.flatnonzero(worlds.team.joined != self._joined).tolist():
            rows = worlds.rows_of(world)[self._joined[world] : worlds.team.joined[world]]
            own = worlds.minds.poses.own[rows, 0]
            self._poses[rows, :2] = own[:, [c.X, c.Y]]
            self._poses[rows, 2] = directions(own[:, c.POSE_HEADING : c.POSE_HEADING + 2])
        self._joined = worlds.team.joined.copy()

    def _path(self, about: Mapping[str, Any]) -> Path:
        words = (str(about[name]) for name in ("scenario", "condition") if about.get(name))
        stem = self.settings.name.removesuffix(SUFFIX) or re.sub(r"[^\w.#+=-]+", "_", "-".join(words))
        names, folder = chain([stem], (f"{stem}-{k}" for k in count(2))), Path(self.settings.directory)
        found = {one.stem for one in folder.glob(f"*{SUFFIX}")} if self.settings.kept else set()
        name = next(one for one in names if one not in self._names | found)
        self._names.add(name)
        return folder / f"{name}{SUFFIX}"

    def _end(self, world: int, result: Mapping[str, Any] | None = None) -> None:
        if world in self._running:
            self._write(world)
            self._running.pop(world).close(result)

    def _write(self, world: int) -> None:
        """Write the frames of a world that are not in its file yet."""
        if self.frames.waiting(world):
            check_shown(self.worlds, self._shown)
            notes = {"deposits": self._messages.kinds, "by_hand": self._by_hand}
            self._running[world].add(self.frames.pack(world), notes)
            self._by_hand.clear()


LONGEST_VECTOR = 1e6
"""Length that no vector of a mechanism has [m]."""


def _first_sentence(content: RunningConfiguration) -> str:
    """Return the first sentence about a configuration; of one that asks for vectors of no possible length, this."""
    least = max((getattr(sensor, "longer_than", 0.0) for sensor in content.spec.sensors.values()), default=0.0)
    if least > LONGEST_VECTOR:
        return f"Does nothing: it would act on vectors longer than {least:g} m, and none is."
    return " ".join(content.spec.description.split()).split(". ")[0].split(": ")[0].rstrip(".") + "."
