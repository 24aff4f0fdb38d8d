"""Recordings of scenes: one file for each run of a goal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn, SupportsIndex

import numpy as np

from clean_swarm_env.recording.channels import MILLI, Channel, whole_channel
from clean_swarm_env.recording.file import SUFFIX, RecordingFile
from clean_swarm_env.recording.messages import DepositLog
from clean_swarm_env.recording.recorder import NO_COPY
from clean_swarm_env.recording.sampled import Thinking, mind_arrays, networks_of, points
from clean_swarm_env.recording.stepping import copy_poses
from clean_swarm_env.recording.taking import Sampled, WaitingFrames
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.scene import Scene
from clean_swarm_env.scenes.served import ServedTeam
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats, Ints

CARRYING = "carrying"
"""What robots know that carry something."""


class SceneFrames:
    """What recordings hold of a scene that has begun: its heads, and its numbers in every control period.

    Args:
        scene: the scene, with its controller.
        option: the option that serves the goal, or what else the robots do.

    Attributes:
        frames: those that wait for being written.

    """

    def __init__(self, scene: Scene, option: str) -> None:
        self._scene, self._option, rows = scene, option, scene.arena.rows
        self._team = scene.controller if isinstance(scene.controller, ServedTeam) else None
        minds = self._team.minds if self._team else None
        explained = minds is not None and minds.network.state.explained
        self._minds = Thinking(minds.network, minds.coordinators, minds.inner) if minds and explained else None
        self._log = DepositLog(self._team.buffers if self._team else {}, rows)
        self._poses: Floats = np.zeros((rows, 3))
        self._cargo: Ints = np.full(rows, NOTHING)
        self._contacts, self._entered = np.zeros(rows, dtype=np.int64), scene.arena.entered.copy()
        self.frames = WaitingFrames(list(self._sampled()), scene.arena.worlds)
        self.frames.restart(range(scene.arena.worlds))
        self.note_poses()

    @property
    def notes(self) -> dict[str, Any]:
        """What was found out until now: the kinds of deposits."""
        return {"deposits": self._log.kinds}

    def note_poses(self) -> None:
        """Keep the poses, at which the next control period begins; call it after they were changed by hand."""
        copy_poses(self._scene.arena.positions, self._scene.arena.headings, self._poses)

    def record(self) -> None:
        """Record the control period that has just been run."""
        arena = self._scene.arena
        np.subtract(arena.entered, self._entered, out=self._contacts)
        self._entered[:] = arena.entered
        if self._team is not None and CARRYING in self._team.memory.kinds:
            self._cargo[:] = np.where(self._team.memory[CARRYING].values == 1.0, 0, NOTHING)
        self.frames.record()
        self._log.clear()
        self.note_poses()

    def head(self, world: int, about: Mapping[str, Any]) -> dict[str, Any]:
        """Return the head of the recording of a world: a mission without items and stations; `about` is plain data."""
        scene, team, body = self._scene, self._team, self._scene.body
        look = {"radius": body.radius, "pose_goal_radius": body.pose_goal_radius, "pose_diffusion": body.pose_diffusion}
        return {
            "about": {"experiment": scene.goal, "condition": self._option, **about},
            "period": CONTROL_PERIOD,
            "ticks_per_decision": 1,
            "width": scene.ground.side,
            "height": scene.ground.side,
            "ground": scene.ground.kind,
            "field": scene.ground.field_side,
            "things": list(things_of(scene, world)),
            "robots": scene.arena.robots,
            "items": 0,
            "minds": self._minds is not None,
            "options": {scene.goal: team.options if team else (self._option,)},
            "views": {scene.goal: team.views if team else (0.0,)},
            "mission": {"name": scene.goal, "scene": scene.story, "robots": look},
            **(networks_of(self._minds) if self._minds is not None else {}),
        }

    def result(self, world: int) -> dict[str, Any]:
        """Return the figures of a world as they stand."""
        figures = {name: float(values[world]) for name, values in self._scene.measured().items()}
        met = all(measure.met(figures[measure.name]) for measure in self._scene.measures)
        return {"completed": met, "duration_s": self._scene.chosen.seconds, "measures": figures}

    def close(self) -> None:
        """Stop listening to the buffers."""
        self._log.close()

    def _sampled(self) -> Iterator[Sampled]:
        count, team = self._scene.arena.robots, self._team
        robots, ones = ("robot", count), np.ones(len(self._poses), dtype=np.int64)
        yield from points("", (robots,), self._poses[:, :2], "where the robot is", order=2)
        heading = Channel("heading", robots[:1], robots[1:], MILLI, 1, "rad", "where the robot looks")
        yield Sampled(heading, self._poses[:, 2])
        for name, values, about in (
            ("present", ones, "1 where the robot is there"),
            ("working", ones, "1 where the robot is at work"),
            ("cargo", self._cargo, "0 where the robot carries something, -1 for nothing"),
            ("recycled", 0 * ones, "0"),
            ("contact", self._contacts, "robots that came too close until the next frame"),
            (f"held/{self._scene.goal}", team.held if team else 0 * ones, "the option that serves the goal"),
            ("deposit", self._log.deposits, "kinds of gradients that the robot leaves here, a bit for each"),
        ):
            yield Sampled(whole_channel(name, robots, about), values)
        if self._minds is not None:
            yield from mind_arrays(count, self._minds)


def things_of(scene: Scene, world: int) -> Iterator[dict[str, Any]]:
    """Yield the gradients that are there from the start on in a world, as plain data."""
    for lying in scene.around:
        places = lying.places[world]
        reaches = (np.broadcast_to(reach, len(places)).tolist() for reach in (lying.diffusion, lying.goal_radius))
        for (x, y), diffusion, radius in zip(places.tolist(), *reaches, strict=True):
            what = {"channel": lying.channel, "attraction": lying.attraction}
            yield {**what, "x": x, "y": y, "diffusion": diffusion, "radius": radius}


class SceneRecorder:
    """Records the runs of a scene that has begun, one file for each seed: call `record` after every control period.

    Args:
        scene, option: as `SceneFrames` has them.
        directory: where the files go; made if it is missing.
        seeds: of the worlds.
        about: plain data for the heads of all files.

    Attributes:
        paths: the files.

    """

    def __init__(
        self, scene: Scene, option: str, directory: Path, seeds: Sequence[int], about: Mapping[str, Any] | None = None
    ) -> None:
        self._scene, self._frames_of, self._written = scene, SceneFrames(scene, option), 0
        self._frames = self._frames_of.frames
        self.paths = [directory / f"{scene.goal}-{option}-seed{seed}{SUFFIX}" for seed in seeds]
        heads = (
            self._frames_of.head(world, {"scenario": f"seed {seed}", "seed": seed, **(about or {})})
            for world, seed in enumerate(seeds)
        )
        channels = self._frames.channels
        self._files = [RecordingFile(path, head, channels) for path, head in zip(self.paths, heads, strict=True)]

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raise TypeError: two recorders would write one file."""
        raise TypeError(NO_COPY)

    def record(self) -> None:
        """Record the control period that has just been run."""
        self._frames_of.record()
        if self._frames.at == self._frames.room:
            self._write()

    def close(self) -> None:
        """End the files, with the measures of a run that is over."""
        self._write()
        self._frames_of.close()
        for world, file in enumerate(self._files):
            file.close(self._frames_of.result(world) if self._scene.over else None)

    def _write(self) -> None:
        """Write the frames that are in no file yet."""
        if self._frames.at:
            for world, file in enumerate(self._files):
                file.add(self._written, self._frames.pack(world), self._frames_of.notes)
            self._written += self._frames.at
            self._frames.restart(range(len(self._files)))
