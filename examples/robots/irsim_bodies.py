"""The bodies of a mission in IR-SIM, another simulator, with its kinematics, noise and contacts; minds stay the same.

    pip install "ir-sim==2.12.*"
    python -m examples.robots.irsim_bodies FOLDER  # for recordings and a GIF; without one it only prints figures

IR-SIM (MIT licence) moves discs with differential drives in steps of 0.05 s and pushes what overlaps apart. Drives do
not do what they are told: in each step speeds and turn rates have errors of 17 %, IR-SIM's usual ones. Poses come from
a camera that errs by 2 cm. Items are handled, and collisions counted, by our rules.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import irsim
import numpy as np
from PIL import Image

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.physics.collisions import count_world
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Sensed, Wheels
from clean_swarm_env.tasks.cleaning.garbage import LYING
from examples.robots.bodies import ServedBodies, tick_together
from selector.documents.reading import as_yaml
from selforg.program import MOVE, TELLING, Program, Step

STEP: Final = 0.05
"""Step of IR-SIM [s]."""
NOISE: Final = [0.03, 0.0, 0.0, 0.03]
"""Variances of speeds and turn rates by their squares: IR-SIM's `alpha`, as it is unless given [-]."""
POSE_ERROR: Final = 0.02
"""Standard deviation of each coordinate that the camera gives [m]."""
BOTH: Final = "AvoidCollision+ExplorationPatrol"
"""Goals whose options are chosen."""
THICK: Final = 0.1
"""Thickness of walls [m]; IR-SIM lets robots through lines."""


class IrsimBodies(ServedBodies):
    """One world of a mission whose robots drive in IR-SIM, on a walled ground, with straight walls.

    >>> bodies = IrsimBodies(mission, start, seed=1)
    >>> while bodies.running:
    ...     tick_together(bodies, robots)

    """

    def __init__(
        self,
        mission: MissionConfig,
        start: StartConfiguration | None = None,
        seed: int = 0,
        record: RecordSettings | None = None,
    ) -> None:
        super().__init__(mission, start, seed, record=record)
        self._rng = np.random.default_rng(seed)
        self._ending = Program(self._ending_steps)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "world.yaml"
            file.write_text(as_yaml(self._described(mission)), encoding="utf-8")
            drawing = {"headless": record is None, "display": False}
            self._world: Any = irsim.make(str(file), **drawing, log_level="ERROR", seed=seed)

    def move(self, wheels: Sequence[Wheels]) -> None:
        """Let robots drive for a control period."""
        worlds = self.worlds
        physics, collisions = worlds.physics, worlds.collisions
        told = [np.array([[one.speed], [one.turn_rate]]) for one in wheels]
        collisions.entered_in_tick[:] = 0
        for _ in range(round(worlds.period / STEP)):
            self._world.step(told)
            states = np.array([robot.state[:3, 0] for robot in self._world.robot_list])
            physics.positions[:] = worlds.floor.ground.space.wrap(states[:, :2])
            physics.headings[:] = states[:, 2]
            count_world(0, physics.positions, physics.present, collisions.packed.handle)
        self._ending.run(worlds.now)
        self.record()

    def picture(self) -> Image.Image:
        """Return what IR-SIM draws, with the items that lie (dots) and the stations (squares), in 32 colours."""
        plot, task, garbage = self._world._env_plot, self.worlds.mission.task, self.worlds.task.garbage
        lying = garbage.positions[0][garbage.stage[0] == LYING]
        plot.step("dynamic", self._world.objects)
        plot.draw_points(lying.tolist(), 30, "green", refresh=True)
        plot.draw_points([task.stations.recycling, task.stations.dump], 200, "orange", refresh=True, marker="s")
        plot.fig.canvas.draw()
        return Image.fromarray(np.asarray(plot.fig.canvas.buffer_rgba())[:, :, :3]).quantize(32)

    def _ending_steps(self) -> list[Step]:
        """Return the steps of a tick after driving."""
        return self.worlds.steps_of(MOVE + 1, TELLING)

    def _sensed(self, row: int, collisions: int) -> Sensed:
        x, y = self._rng.normal(0.0, POSE_ERROR, 2)
        true = super()._sensed(row, collisions)
        return replace(true, x=true.x + x, y=true.y + y)

    def _described(self, mission: MissionConfig) -> dict[str, Any]:
        """Return the world as IR-SIM reads it."""
        physics, world = self.worlds.physics, mission.world
        model = mission.robots.models[0]
        poses = np.column_stack([physics.positions, physics.headings])
        robots = {
            "number": len(poses),
            "kinematics": {"name": "diff", "noise": True, "alpha": NOISE},
            "shape": {"name": "circle", "radius": model.radius},
            "vel_min": [-model.max_speed, -model.max_turn_rate],
            "vel_max": [model.max_speed, model.max_turn_rate],
            "distribution": {"name": "manual"},
            "state": poses.tolist(),
        }
        whole = {"width": world.width, "height": world.height, "step_time": STEP, "sample_time": STEP}
        walls = [wall_of(*ends) for ends in _walls(mission)]
        return {"world": {**whole, "collision_mode": "contact"}, "robot": [robots], "obstacle": walls}


def _walls(mission: MissionConfig) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    """Return both ends of each wall [m], and of the border of the ground."""
    width, height = mission.world.width, mission.world.height
    low, wide, high = -THICK / 2.0, width + THICK / 2.0, height + THICK / 2.0
    corners = [(low, low), (wide, low), (wide, high), (low, high), (low, low)]
    yield from pairwise(corners)
    for wall in mission.world.walls:
        yield from pairwise(wall.corners)


def wall_of(begin: Sequence[float], end: Sequence[float]) -> dict[str, Any]:
    """Return a wall between two points [m] as IR-SIM's obstacle."""
    (x, y), way = begin, np.subtract(end, begin)
    shape = {"name": "rectangle", "length": float(np.hypot(*way)) + THICK, "width": THICK}
    centre = [float(x + way[0] / 2.0), float(y + way[1] / 2.0), float(np.arctan2(way[1], way[0]))]
    return {"shape": shape, "state": centre, "static": True}


def hall() -> MissionConfig:
    """Return a mission that five robots finish in a minute or so."""
    given: dict[str, Any] = {
        "name": "hall",
        "world": {"ground": "walled", "width": 8.0, "height": 8.0, "contacts": "solid"},
        "task": {"garbage": {"count": 5}, "stations": {"recycling": [2.0, 4.0], "dump": [6.0, 4.0]}},
        "network": {"robot": "cleaning-patrol"},
        "knowledge": "exploring",
        "time_limit": 300.0,
    }
    return MissionConfig.model_validate(given)


def main(folder: str = "") -> None:
    """Let five robots clean a hall in both simulators; with a folder, write recordings there, and a GIF of IR-SIM's."""
    mission, pictures = hall(), list[Image.Image]()
    for kind in (ServedBodies, IrsimBodies):
        record = RecordSettings(Path(folder), name=kind.__name__) if folder else None
        bodies = kind(mission, seed=1, record=record)
        robots = [RobotProcess(mission, row, "fixed:ORCA+Patrol", goal=BOTH, seed=1) for row in range(mission.rows)]
        while bodies.running:
            tick_together(bodies, robots)
            if folder and isinstance(bodies, IrsimBodies) and bodies.worlds.world.tick % 5 == 0:
                pictures.append(bodies.picture())
        print(f"{kind.__name__}: {bodies.result.duration_s:.1f} s, {bodies.result.cost_s:.1f} s cost")
    if pictures:
        more = {"save_all": True, "append_images": pictures[1:], "duration": 100, "loop": 0, "optimize": True}
        pictures[0].save(Path(folder) / "irsim.gif", **more)


if __name__ == "__main__":
    main(*sys.argv[1:])
