"""Recordings of scenes: one file for each run of a goal, written when the runs are over.

On open land the recording holds the square in which the robots have been.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.recording.channels import MILLI, AnyArray, Channel, point_channels, whole_channel
from clean_swarm_env.recording.file import SUFFIX, RecordingFile
from clean_swarm_env.recording.messages import DepositLog
from clean_swarm_env.recording.recorder import MOST_FRAMES
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.scene import Scene
from clean_swarm_env.scenes.served import ServedTeam
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats

EDGE_OF_LAND = 2.0
"""Width of the land around the places where robots have been [m]."""
CARRYING = "carrying"
"""What robots know that carry something."""


class SceneRecorder:
    """Records the runs of a scene that has begun: `run` it, then `write`.

    Args:
        scene: the scene, with its controller.
        directory: where the files go; made if it is missing.
        option: the option that serves the goal, or what else the robots do.

    """

    def __init__(self, scene: Scene, directory: Path, option: str) -> None:
        self._scene, self._directory, self._option = scene, directory, option
        self._frames: list[list[AnyArray]] = []
        arena, controller = scene.arena, scene.controller
        self._served = controller if isinstance(controller, ServedTeam) else None
        self._log = DepositLog(self._served.buffers if self._served is not None else {}, arena.rows)
        self._poses = arena.positions.copy(), arena.headings.copy()

    def take(self) -> None:
        """Record the control period that has just been run."""
        arena, served = self._scene.arena, self._served
        cargo, held = np.full(arena.rows, NOTHING), np.zeros(arena.rows, dtype=np.int64)
        if served is not None:
            held = served.held.copy()
            if CARRYING in served.memory.kinds:
                cargo = np.where(served.memory[CARRYING].values == 1.0, 0, NOTHING)
        self._frames.append([*self._poses, cargo, held, self._log.deposits.copy()])
        self._log.begin()
        self._poses = arena.positions.copy(), arena.headings.copy()

    def write(self, seeds: Sequence[int]) -> list[Path]:
        """Write the run of each seed with its measures as they stand; return the files."""
        self._log.close()
        values = self._scene.measured()
        robots, paths = self._scene.arena.robots, []
        taken = [np.stack(frames) for frames in zip(*self._frames, strict=True)]  # each (T, R, ...)
        for world, seed in enumerate(seeds):
            positions, *others = (frames[:, world * robots : (world + 1) * robots] for frames in taken)
            corner, side = self._square(positions)
            path = self._directory / f"{self._scene.goal}-{self._option}-seed{seed}{SUFFIX}"
            contents = list(self._contents(positions - corner, *others))
            head = self._head(seed, side) | {"around": self._around(world, corner)}
            file = RecordingFile(path, head, [channel for channel, _ in contents])
            for first in range(0, len(positions), MOST_FRAMES):
                whole = [channel.whole(frames[first : first + MOST_FRAMES]) for channel, frames in contents]
                file.add(first, np.concatenate(whole, axis=1), {"deposits": self._log.kinds})
            file.close({name: float(value[world]) for name, value in values.items()})
            paths.append(path)
        return paths

    def _square(self, positions: Floats) -> tuple[Floats, float]:
        """Return the lower left corner and the side [m] of what is shown: the torus, or where robots have been."""
        ground = self._scene.ground
        if ground.kind == "torus":
            return np.zeros(2), ground.side
        low, high = positions.min(axis=(0, 1)) - EDGE_OF_LAND, positions.max(axis=(0, 1)) + EDGE_OF_LAND
        return low, float((high - low).max())

    def _contents(
        self, positions: Floats, headings: Floats, cargo: AnyArray, held: AnyArray, deposits: AnyArray
    ) -> Iterator[tuple[Channel, AnyArray]]:
        """Yield the channels of a run and their values (T, ...)."""
        frames, count = headings.shape
        robots, nothing, none = ("robot", count), np.zeros((frames, count), dtype=np.int64), np.zeros((frames, 0, 2))
        for axis, channel in enumerate(point_channels("", (robots,), "where the robot is", order=2)):
            yield channel, positions[..., axis]
        yield Channel("heading", robots[:1], robots[1:], MILLI, 1, "rad", "where the robot looks"), headings
        for name in ("item", "station"):
            for channel in point_channels(name, ((name, 0),), "none in a scene"):
                yield channel, none[..., 0]
        for name in ("item_stage", "item_leftover"):
            yield whole_channel(name, ("item", 0), "none in a scene"), nothing[:, :0]
        for name, values, about in (
            ("present", nothing + 1, "1 where the robot is there"),
            ("working", nothing + 1, "1 where the robot is at work"),
            ("cargo", cargo, "0 where the robot carries something, -1 for nothing"),
            ("recycled", nothing, "0"),
            (f"held/{self._scene.goal}", held, "the option that serves the goal in the robot"),
            ("deposit", deposits, "kinds of gradients that the robot leaves here, a bit for each"),
        ):
            yield whole_channel(name, robots, about), values

    def _head(self, seed: int, side: float) -> dict[str, Any]:
        scene, served, body = self._scene, self._served, self._scene.body
        look = {"radius": body.radius, "pose_goal_radius": body.pose_goal_radius, "pose_diffusion": body.pose_diffusion}
        return {
            "about": {"experiment": scene.goal, "scenario": f"seed {seed}", "condition": self._option, "seed": seed},
            "period": CONTROL_PERIOD,
            "ticks_per_decision": 1,
            "width": side,
            "height": side,
            "robots": scene.arena.robots,
            "items": 0,
            "minds": False,
            "options": {scene.goal: served.options if served is not None else (self._option,)},
            "views": {scene.goal: served.views if served is not None else (0.0,)},
            "mission": {"scene": scene.story, "robots": look, "stations": {"reach": 0.0}},
        }

    def _around(self, world: int, corner: Floats) -> list[dict[str, Any]]:
        """Return the gradients that are there from the start on, as plain data."""
        found = []
        for lying in self._scene.around:
            places = lying.places[world] - corner
            reaches = {"diffusion": lying.diffusion, "goal_radius": lying.goal_radius}
            each = {name: np.broadcast_to(reach, len(places)).tolist() for name, reach in reaches.items()}
            found.append({"channel": lying.channel, "attraction": lying.attraction, "places": places.tolist(), **each})
        return found
