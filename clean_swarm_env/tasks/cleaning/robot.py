"""The cleaning robot's behaviour network (the paper's Fig. 6), the names of its sensors, and its memory of cargo."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from clean_swarm_env.config.mission import MissionConfig, NetworkConfig
from clean_swarm_env.tasks.cleaning.settings import settings_of
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import coordinated_goals, load_network
from selector.coordination.robot_network import RobotNetwork, merged_networks
from selector.documents.errors import DocumentError, shown
from selector.documents.find import find_file
from selector.documents.plain import must_fit
from selforg.arrays import Floats, Ints
from selforg.components.memory import RobotMemory
from selforg.network.model.behaviours import Sensor

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
CLEANERS = ("cleaning", "cleaning-patrol", "cleaning-transport")
"""Documents of the shipped cleaning robot; each coordinates one goal more than the one before."""
WHERE = "mission.network.robot: "
"""Where a mission names the document of robots whose group names none."""
PATROL = "Patrol"
"""A behaviour that the world carries out unless a document replaces it."""


class Named(NamedTuple):
    """How a mission names a document of robots, and what for."""

    where: str
    """Begins the line of an error: the key of the first group that names it, or carries with it."""
    carries: bool
    """Whether robots with this document carry items."""


OF_THE_NETWORK: Final = Named(WHERE, carries=True)
"""The document of robots that carry items and are all alike."""


def documents_of(mission: MissionConfig) -> dict[str, Named]:
    """Return name -> `Named` of the documents of a mission's robots, that of the network first."""
    found = {mission.network.robot: Named(WHERE, carries=False)}
    for number, model in enumerate(mission.robots.models):
        name = model.document or mission.network.robot
        known, carries = found.get(name), model.carries > 0
        if known is None or (carries and not known.carries):
            key = "document" if model.document else "carries"
            where = f"mission.robots.groups.{number}.{key}: " if mission.robots.groups else WHERE
            found[name] = Named(where, carries)
    return found


def goals_of(mission: MissionConfig, directories: Sequence[Path]) -> tuple[str, ...]:
    """Return the goals that the documents of a mission's robots coordinate; DocumentError if they differ."""
    named = documents_of(mission)
    found = {name: coordinated_goals(find_file("robots", name, directories, by.where)) for name, by in named.items()}
    first = found[mission.network.robot]
    for name, goals in found.items():
        same = f"a robot that coordinates {', '.join(first)} as {mission.network.robot} does"
        must_fit(set(goals) == set(first), f"{named[name].where}{name}", same, ", ".join(goals))
    return first


def coordinating_more(mission: MissionConfig) -> MissionConfig:
    """Return a mission whose robots also choose how they explore, and with several stations of a kind how they carry.

    Documents that are not those of the shipped cleaning robot stay.
    """
    named, several = mission.network.robot, len(settings_of(mission).stations.places) > 2
    if named not in CLEANERS or any(model.document for model in mission.robots.models):
        return mission
    wider = CLEANERS[max(CLEANERS.index(named), 2 if several else 1)]
    return mission.model_copy(update={"network": mission.network.model_copy(update={"robot": wider})})


def network_of_robots(
    mission: MissionConfig, models: Sequence[CoordinatorModel], directories: Sequence[Path]
) -> RobotNetwork:
    """Return the network of all documents of a mission's robots."""
    network, networks = mission.network, {}
    for name, by in documents_of(mission).items():
        networks[name] = robot_network(network.model_copy(update={"robot": name}), models, directories, by)
    return merged_networks(networks)


def robot_network(
    config: NetworkConfig,
    coordinators: Sequence[CoordinatorModel],
    directories: Sequence[Path] = (),
    named: Named = OF_THE_NETWORK,
) -> RobotNetwork:
    """Return the network of a cleaning robot, as `configs/robots/<config.robot>.yaml` declares it.

    Raises:
        DocumentError: a mistake in the file, sensors that are not those which `read_sensors` writes, a behaviour that
            does nothing, or, of robots that carry items, one that is missing.

    """
    path = find_file("robots", config.robot, directories, named.where)
    parameters = {"transport_full_range": config.transport_full_range}
    by_goal = {coordinator.goal: coordinator for coordinator in coordinators}
    robot = load_network(path, by_goal, parameters, config.build())
    model = robot.model
    given = [f"a told {one.name}" if one.name in robot.sensors else one.name for one in model.sensors]
    own = [sensor.name for sensor in OWN_SENSORS]
    fits = model.sensors[: len(own)] == OWN_SENSORS and not robot.sensors.keys() & set(own)
    must_fit(fits, shown(path), f"the sensors {', '.join(own)} first", ", ".join(given))
    known = {sensor.name for coordinator in coordinators for sensor in coordinator.sensors} | robot.sensors.keys()
    for sensor in model.sensors[len(OWN_SENSORS) :]:
        fed = "a sensor of the robot itself or of a coordinator's options, which something feeds"
        must_fit(sensor.name in known, f"{shown(path)}: networks: sensors.{sensor.name}", fed, "neither")
    acting = {*BEHAVIOURS, PATROL, *by_goal, *robot.inner}
    for behaviour in model.behaviours:
        acts = f"a network, a coordinator, or one of {', '.join((*BEHAVIOURS, PATROL))}, which act"
        must_fit(behaviour.name in acting, f"{shown(path)}: networks: behaviours.{behaviour.name}", acts, "none")
    missing = [name for name in BEHAVIOURS if name not in model.behaviour_index]
    if missing and named.carries:
        expected = f"the behaviours {', '.join(BEHAVIOURS)} of robots that carry items"
        raise DocumentError(f"{named.where}{shown(path)}: expected {expected}; {missing[0]} is missing")
    return robot


class CargoMemory:
    """What configurations expect to know of the cargo of their robots, and ask for, by names in their memory.

    Attributes:
        tells: whether any configuration expects to know something.
        handed: (R,) time for which a robot that now puts down its cargo is to see no garbage [s], 0: it keeps it; None
            if no configuration can ask for that.

    """

    TOLD: Final = ("recycled", "left", "gained")
    """Whether the cargo has been recycled, its way to the next station [m], and by how much that is shorter than from
    where it was picked or recycled [m]."""
    HAND_OVER: Final = "hand_over"

    def __init__(self, memory: RobotMemory) -> None:
        self._told = {name: memory[name] for name in self.TOLD if name in memory.kinds}
        self.tells = bool(self._told)
        self.handed: Floats | None = memory[self.HAND_OVER].values if self.HAND_OVER in memory.kinds else None

    def tell(self, recycled: Ints, leg: Floats, readings: Floats) -> None:
        """Remember the cargo, whether `recycled` (R,), with the length `leg` (R,) [m] of its way, and `readings`."""
        left = np.where(recycled == 1, readings[:, DIST_DUMP], readings[:, DIST_RECYCLING])
        known = {"recycled": recycled, "left": left, "gained": leg - left}
        for name, remembered in self._told.items():
            remembered.values[:] = known[name]
