"""Frames: the parts of a mission that all worlds of one batch share.

Worlds of one batch share the task, the ground, the bodies, the network and the numbers of rows; events, delivery,
prices, what the task says (`TaskKind.frame_settings`) and, except on open land, the time limit may differ. Rows that a
mission does not use are absent, so that missions of different sizes share a frame when they state the same
`robots.capacity` and, with cleaning, `task.garbage.capacity`. Groups of robots that differ are the same in all of them.
"""

from collections.abc import Sequence

from clean_swarm_env.config.delivery import EVERYWHERE
from clean_swarm_env.config.events import Join
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import find_task


def frame_of(mission: MissionConfig) -> MissionConfig:
    """Return the mission without the parts that may differ in a batch; missions with equal frames fit together."""
    robots = mission.robots.model_copy(update={"count": 1, "capacity": mission.rows})
    joining = tuple(event for event in mission.events if isinstance(event, Join)) if robots.groups else ()
    ideal = {"reach": EVERYWHERE, "loss": 0.0, "own_contents": mission.own_contents}
    delivery = mission.delivery.model_copy(update=ideal)
    return mission.model_copy(
        update={
            "name": "",
            "robots": robots,
            "task": find_task(mission.task.name).frame_settings(mission),
            "events": joining,
            "time_limit": mission.time_limit if mission.world.ground == "open" else 1.0,
            "collision_cost": 0.0,
            "contact_cost": 0.0,
            "delivery": delivery,
        }
    )


def grouped(missions: Sequence[MissionConfig]) -> list[list[int]]:
    """Return groups of numbers of missions; those of one group have one frame and fit into one batch of worlds."""
    groups: dict[str, list[int]] = {}
    for number, mission in enumerate(missions):
        groups.setdefault(repr(frame_of(mission)), []).append(number)
    return list(groups.values())


def check_frame(mission: MissionConfig, batch: MissionConfig) -> None:
    """Raise ValueError with the first part in which the frame of `mission` differs from that of the `batch`."""
    given, expected = _parts(frame_of(mission)), _parts(frame_of(batch))
    for name in dict.fromkeys((*expected, *given)):
        if given.get(name) != expected.get(name):
            raise ValueError(
                f"mission {mission.name!r}: {name}: expected {expected.get(name)!r} as in the batch of worlds, "
                f"got {given.get(name)!r}"
            )


def _parts(frame: MissionConfig) -> dict[str, object]:
    """Return the values of a frame by their keys, those of the task one by one."""
    settings = {f"task.{key}": value for key, value in frame.task if key != "name"}
    return {**dict(frame), "task": frame.task.name, **settings}
