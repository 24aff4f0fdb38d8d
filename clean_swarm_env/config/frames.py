"""Frames: the parts of a mission that all worlds of one batch share.

Worlds of one batch share the task, the ground, the bodies, the network, the patrol, the numbers of rows and of
stations; places of stations, events, garbage, delivery, prices and, on a torus, the time limit may differ. Rows that a
mission does not use are absent, so that missions of different sizes share a frame when they state the same
`robots.capacity` and `garbage.capacity`.
"""

from collections.abc import Sequence

from clean_swarm_env.config.delivery import EVERYWHERE
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import Point

NOWHERE: Point = (0.0, 0.0)


def frame_of(mission: MissionConfig) -> MissionConfig:
    """Return the mission without the parts that may differ in a batch; missions with equal frames fit together."""
    robots = mission.robots.model_copy(update={"count": 1, "capacity": mission.rows})
    garbage = mission.garbage.model_copy(
        update={"count": 0, "respawn": 0.0, "capacity": mission.item_rows, "spots": (), "spot_radius": 1.0}
    )
    stations = mission.stations.at((NOWHERE,) * len(mission.stations.places))
    ideal = {"reach": EVERYWHERE, "loss": 0.0, "own_contents": mission.own_contents}
    delivery = mission.delivery.model_copy(update=ideal)
    return mission.model_copy(
        update={
            "name": "",
            "robots": robots,
            "garbage": garbage,
            "stations": stations,
            "events": (),
            "time_limit": 1.0 if mission.world.ground == "torus" else mission.time_limit,
            "collision_cost": 0.0,
            "contact_cost": 0.0,
            "delivery": delivery,
        }
    )


def grouped(missions: Sequence[MissionConfig]) -> list[list[int]]:
    """Return groups of numbers of missions; those of one group have one frame and fit into one batch of worlds."""
    frames: list[MissionConfig] = []
    groups: list[list[int]] = []
    for number, mission in enumerate(missions):
        frame = frame_of(mission)
        if frame not in frames:
            frames.append(frame)
            groups.append([])
        groups[frames.index(frame)].append(number)
    return groups


def check_frame(mission: MissionConfig, batch: MissionConfig) -> None:
    """Raise ValueError with the first part in which the frame of `mission` differs from that of the `batch`."""
    given, expected = frame_of(mission), frame_of(batch)
    for name in type(mission).model_fields:
        if getattr(given, name) != getattr(expected, name):
            raise ValueError(
                f"mission {mission.name!r}: {name}: expected {getattr(expected, name)!r} as in the batch of worlds, "
                f"got {getattr(given, name)!r}"
            )
