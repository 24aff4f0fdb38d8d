"""The cleaning robot's behaviour network (the paper's Fig. 6), and what its own sensors read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.network import NetworkConfig
from clean_swarm_env.world.garbage import LYING, NOTHING, distance
from clean_swarm_env.world.nearby import cells_along, fill_cells, nearest_point
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel, coordinator_models
from selector.coordination.robot_document import coordinated_goals, load_network
from selector.documents.errors import DocumentError, shown
from selector.documents.files import find_file
from selector.knowledge import Knowledge
from selforg.compiler.decorators import kernel
from selforg.network.model.behaviours import Sensor
from selforg.network.model.model import NetworkModel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GOAL = "AvoidCollision"
"""The goal that every cleaning robot coordinates."""

SENSORS = (
    Sensor("garbage_seen", "fact"),
    Sensor("garbage_at", "fact"),
    Sensor("garbage_found", "fact"),
    Sensor("carrying", "fact"),
    Sensor("recycled", "fact"),
    Sensor("at_recycling", "fact"),
    Sensor("at_dump", "fact"),
    Sensor("dist_recycling", "number"),
    Sensor("dist_dump", "number"),
    Sensor("patrolled", "fact"),  # never true: patrolling has no end
)
(
    GARBAGE_SEEN,
    GARBAGE_AT,
    GARBAGE_FOUND,
    CARRYING,
    RECYCLED,
    AT_RECYCLING,
    AT_DUMP,
    DIST_RECYCLING,
    DIST_DUMP,
) = range(9)  # columns of the readings, in the order of SENSORS; the coordinator's sensors come after them


BEHAVIOURS = ("MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump")
"""Behaviours that the world lets act; a document may add others, and `Patrol` may be coordinated."""


def coordinators_of(
    config: NetworkConfig, knowledge: Knowledge, library: Library, directories: Sequence[Path] = ()
) -> tuple[CoordinatorModel, ...]:
    """Return what can serve the goals that the robot's document coordinates, in the order of the document."""
    return coordinator_models(coordinated_goals(find_file("robots", config.robot, directories)), knowledge, library)


def robot_model(
    config: NetworkConfig, coordinators: Sequence[CoordinatorModel], directories: Sequence[Path] = ()
) -> NetworkModel:
    """Return the model of a cleaning robot, as `configs/robots/<config.robot>.yaml` declares it.

    Raises:
        DocumentError: a mistake in the file, or sensors that are not those which `read_sensors` writes.

    """
    path = find_file("robots", config.robot, directories)
    parameters = {"transport_full_range": config.transport_full_range}
    by_goal = {coordinator.goal: coordinator for coordinator in coordinators}
    model = load_network(path, by_goal, parameters, config.build()).model
    if model.sensors[: len(SENSORS)] != SENSORS:
        expected, given = (", ".join(s.name for s in sensors) for sensors in (SENSORS, model.sensors))
        raise DocumentError(f"{shown(path)}: expected the sensors {expected} first, got {given}")
    missing = [name for name in BEHAVIOURS if name not in model.behaviour_index]
    if missing:
        raise DocumentError(f"{shown(path)}: expected the behaviours {', '.join(BEHAVIOURS)}; {missing[0]} is missing")
    return model


@kernel
def read_sensors(
    robots: Floats, extent: Floats, stations: Floats, limits: Floats,
    positions: Floats, stage: Ints, cargo: Ints, recycled: Ints, readings: Floats, nearest: Ints,
) -> None:  # fmt: skip
    """Write the robot's own sensors into `readings` (R, S).

    robots (R, 2) and extent (2,) [m]; stations (W, 2, 2): recycling and dump [m]; limits (4,): distances of seeing an
    item, of being at an item, of being at a station, of taking an item [m]; positions, stage, cargo, recycled: of
    `Garbage`. nearest (R,) gets the nearest lying item, NOTHING where none can be seen or taken.
    """
    worlds, items = stage.shape
    per_world, sight = robots.shape[0] // worlds, max(limits[0], limits[1], limits[3])
    lying = np.empty(items, np.bool_)
    cells, links = np.empty(cells_along(items, sight, extent), np.int64), np.empty(items, np.int64)
    for world in range(worlds):
        for item in range(items):
            lying[item] = stage[world, item] == LYING
        fill_cells(positions[world], 0, lying, extent, cells, links)
        for row in range(world * per_world, (world + 1) * per_world):
            x, y = robots[row, 0], robots[row, 1]
            nearest[row], near = NOTHING, np.inf
            if items > 0:
                _, nearest[row], near = nearest_point(x, y, -1, sight, positions[world], 0, lying, extent, cells, links)
            carrying = cargo[row] != NOTHING
            to_recycling = distance(x, y, stations[world, 0, 0], stations[world, 0, 1], extent)
            to_dump = distance(x, y, stations[world, 1, 0], stations[world, 1, 1], extent)
            readings[row, GARBAGE_SEEN] = 1.0 if near <= limits[0] else 0.0
            readings[row, GARBAGE_AT] = 1.0 if near <= limits[1] else 0.0
            readings[row, GARBAGE_FOUND] = 1.0 if near <= limits[0] or carrying else 0.0
            readings[row, CARRYING] = 1.0 if carrying else 0.0
            readings[row, RECYCLED] = 1.0 if recycled[row] else 0.0
            readings[row, AT_RECYCLING] = 1.0 if to_recycling <= limits[2] else 0.0
            readings[row, AT_DUMP] = 1.0 if to_dump <= limits[2] else 0.0
            readings[row, DIST_RECYCLING] = to_recycling
            readings[row, DIST_DUMP] = to_dump


@kernel
def cargo_in_reach(readings: Floats, working: NDArray[np.bool_], in_reach: Ints) -> None:
    """Write into `in_reach` (R, 3) where a robot that is `working` (R,) can pick, recycle and dump.

    It can by its sensors in `readings` (R, S).
    """
    for row in range(readings.shape[0]):
        carrying, recycled = readings[row, CARRYING] == 1.0, readings[row, RECYCLED] == 1.0
        in_reach[row, 0] = working[row] and not carrying and readings[row, GARBAGE_AT] == 1.0
        in_reach[row, 1] = working[row] and carrying and not recycled and readings[row, AT_RECYCLING] == 1.0
        in_reach[row, 2] = working[row] and carrying and recycled and readings[row, AT_DUMP] == 1.0
