"""Helpers of the tests of worlds and environment: missions, worlds at their start, and their courses."""

import os

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch, mission_begun, run_out
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge

long_course = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="takes minutes in plain Python; the short courses do run"
)
OPTIONS = ("RepulsionFernandez-view2.0", "RepulsionFernandez-view1.5", "RepulsionGradient-view1.5")


def mission(name: str = "table1", **changes) -> MissionConfig:
    """Return a shipped mission with changes, mapping by mapping; those of garbage and so on are its task's."""
    own = {key: changes.pop(key) for key in [*changes] if key in CleaningSettings.model_fields}
    return MissionConfig.model_validate(with_changes(load_mission(name).model_dump(), {**changes, "task": own}))


CROWD = mission(world={"width": 4.0, "height": 4.0}, robots={"count": 8}, garbage={"count": 2},
                stations={"recycling": [1.0, 1.0], "dump": [3.0, 3.0]})  # fmt: skip
"""Return a mission of solid robots so crowded that they touch."""


def avoidance() -> CoordinatorModel:
    return CoordinatorModel(AVOIDANCE, load_knowledge("cleaning"), Library())


def coordinated(config: MissionConfig, count: int = 1) -> Worlds:
    """Return worlds of a mission whose goals are coordinated by the knowledge that it names."""
    return Worlds(config, coordinators_of(config, load_knowledge(config.knowledge), Library()), count)


def worlds_at_start(config: MissionConfig, seeds: list[int], option: int = 2) -> Worlds:
    """Return one world per seed, each at the random start of its seed, all robots holding `option`."""
    worlds = Worlds(config, avoidance(), len(seeds))
    for world, seed in enumerate(seeds):
        begin(worlds, world, seed)
    worlds.hold(np.full(worlds.rows, option))
    return worlds


def begun(made, *arguments, **settings):
    """Reset a batch or an environment and return it."""
    made.reset(*arguments, **settings)
    return made


def course_of(config: MissionConfig, start_seed: int, seed: int, number: int = 0, **settings) -> Batch:
    """Return one world at the random start of a mission."""
    return mission_begun(config, random_start(config, start_seed, number), seed, **settings)


def forced(batch: Batch, **options: str) -> Batch:
    """Let all robots hold options, by goal."""
    for goal, option in options.items():
        coordinator = batch.worlds.minds.coordinator_of(goal)
        coordinator.hold(np.arange(batch.rows), np.full(batch.rows, coordinator.model.options.index(option)))
    return batch


def run_recorded(config: MissionConfig, start_seed: int, seed: int, folder, name: str = "run", **settings):
    """Run a mission from a random start, and return its recording."""
    record = RecordSettings(folder, name=name, thinking=True, **settings)
    run_out(course_of(config, start_seed, seed, record=record))
    return RecordedMission(folder / f"{name}.swarm")


def ticked(worlds, ticks: int = 1):
    """Tick worlds or a batch and return them."""
    for _ in range(ticks):
        worlds.tick()
    return worlds


def recorded(course, folder, seen=lambda: None, room=0, **settings):
    """Run a mission to its end; return its recording, and what `seen` returns at the start and after each tick."""
    recorder = MissionRecorder(course.worlds, RecordSettings(folder, **settings))
    recorder.frames.room = room or recorder.frames.room
    path, told = recorder.open(0, {"scenario": "1"}), [seen()]
    while not course.over[0]:
        course.tick()
        recorder.record()
        told.append(seen())
    recorder.close()
    return RecordedMission(path), told


def begin(worlds: Worlds, world: int, seed: int) -> None:
    worlds.reset(world, random_start(worlds.mission, seed, 0), run_seed(seed, "test"))


def snapshot(worlds: Worlds, world: int) -> dict[str, np.ndarray]:
    """Return copies of all arrays of a world, those of its minds included, by name."""
    rows, garbage, network = worlds.rows_of(world), worlds.task.garbage, worlds.network
    parts = {
        "positions": worlds.physics.positions[rows],
        "headings": worlds.physics.headings[rows],
        "stage": garbage.stage[world],
        "cargo": garbage.cargo[rows],
        "recycled": garbage.recycled[rows],
        "samples": worlds.collisions.samples[world],
        "events": worlds.collisions.events[world],
        "readings": network.readings[rows],
        "executing": network.executing[rows],
        "values": network.state.values[rows],  # activations and their terms
        "row_values": network.state.row_values[rows],
        "inner": np.concatenate(
            [content.network.state.values[rows, 0] for c in worlds.coordinators for content in c.contents], axis=1
        ),
        "held": np.stack([coordinator.held[rows] for coordinator in worlds.coordinators]),
    }
    return {name: part.copy() for name, part in parts.items()}


def course(worlds: Worlds, world: int, ticks: int) -> list[dict[str, np.ndarray]]:
    """Tick all worlds and return a snapshot of one after each tick."""
    steps = []
    for _ in range(ticks):
        worlds.tick()
        steps.append(snapshot(worlds, world))
    return steps


def difference(first: list[dict[str, np.ndarray]], second: list[dict[str, np.ndarray]], within: float = 0.0) -> str:
    """Return the first place at which two courses differ in any bit, or by more than `within`; empty if nowhere."""
    if len(first) != len(second):
        return f"{len(first)} and {len(second)} steps"
    for step, (one, other) in enumerate(zip(first, second, strict=True)):
        for name, part in one.items():
            same = part.tobytes() == other[name].tobytes()
            if not same and not (within and np.allclose(part, other[name], rtol=0.0, atol=within, equal_nan=True)):
                return f"step {step}: {name}"
    return ""


def moved(start: StartConfiguration, order: np.ndarray) -> StartConfiguration:
    """Return the start with its robots in another order."""
    return start.model_copy(update={"robots": tuple(start.robots[k] for k in order)})
