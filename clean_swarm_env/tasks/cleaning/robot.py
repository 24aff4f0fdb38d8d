"""The cleaning robot's behaviour network (the paper's Fig. 6), the names of its sensors, and its memory of cargo."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from clean_swarm_env.config.network import NetworkConfig
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import load_network
from selector.coordination.robot_network import RobotNetwork
from selector.documents.errors import DocumentError, shown
from selector.documents.find import find_file
from selforg.arrays import Floats, Ints
from selforg.components.memory import RobotMemory
from selforg.network.model.behaviours import Sensor

GOAL = "AvoidCollision"
"""The goal that every cleaning robot coordinates."""

OWN_SENSORS = (
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
) = range(9)  # columns of the readings, in the order of OWN_SENSORS; the coordinator's sensors come after them


BEHAVIOURS = ("MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump")
"""Behaviours that the world carries out; a document may add others, and may coordinate `Patrol`."""


def robot_network(
    config: NetworkConfig, coordinators: Sequence[CoordinatorModel], directories: Sequence[Path] = ()
) -> RobotNetwork:
    """Return the network of a cleaning robot, as `configs/robots/<config.robot>.yaml` declares it.

    Raises:
        DocumentError: a mistake in the file, or sensors that are not those which `read_sensors` writes.

    """
    path = find_file("robots", config.robot, directories, "mission.network.robot: ")
    parameters = {"transport_full_range": config.transport_full_range}
    by_goal = {coordinator.goal: coordinator for coordinator in coordinators}
    robot = load_network(path, by_goal, parameters, config.build())
    model = robot.model
    if model.sensors[: len(OWN_SENSORS)] != OWN_SENSORS:
        expected, given = (", ".join(s.name for s in sensors) for sensors in (OWN_SENSORS, model.sensors))
        raise DocumentError(f"{shown(path)}: expected the sensors {expected} first, got {given}")
    missing = [name for name in BEHAVIOURS if name not in model.behaviour_index]
    if missing:
        raise DocumentError(f"{shown(path)}: expected the behaviours {', '.join(BEHAVIOURS)}; {missing[0]} is missing")
    return robot


class CargoMemory:
    """What configurations expect to know of the cargo of their robots, and ask for, by names in their memory.

    Attributes:
        handed: (R,) time for which a robot that now puts down its cargo is to see no garbage [s], 0: it keeps it; None
            if no configuration can ask for that.

    """

    TOLD: Final = ("recycled", "left", "gained")
    """Whether the cargo has been recycled, its way to the next station [m], and by how much that is shorter than from
    where it was picked or recycled [m]."""
    HAND_OVER: Final = "hand_over"

    def __init__(self, memory: RobotMemory) -> None:
        self._told = {name: memory[name] for name in self.TOLD if name in memory.kinds}
        self.handed: Floats | None = memory[self.HAND_OVER].values if self.HAND_OVER in memory.kinds else None

    def tell(self, recycled: Ints, leg: Floats, readings: Floats) -> None:
        """Remember the cargo, whether `recycled` (R,), with the length `leg` (R,) [m] of its way, and `readings`."""
        if not self._told:
            return
        left = np.where(recycled == 1, readings[:, DIST_DUMP], readings[:, DIST_RECYCLING])
        known = {"recycled": recycled, "left": left, "gained": leg - left}
        for name, remembered in self._told.items():
            remembered.values[:] = known[name]
