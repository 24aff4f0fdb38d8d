"""Figures of missions for the infos of all borders: their keys, and their values as columns.

A task other than cleaning has its measures in place of figures of garbage.
"""

from __future__ import annotations

from clean_swarm_env.learning.interface import FigureColumns
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.mission_end import COMPLETED
from clean_swarm_env.world.task_parts import key_of
from clean_swarm_env.world.worlds import Worlds

TEAM = {
    "time_s": "Time since the mission began [s].",
    "dumped": "Items that the team dumped in the period.",
    "garbage_done": "Items that the team dumped in the mission so far.",
    "mission_collision_events": "Times in the mission so far that a pair came closer than the collision distance.",
    "completed": "Whether all garbage of the mission is dumped.",
    "duration_s": "Time of the mission so far; at its end when the last item was dumped, or the time limit [s].",
}
"""Key -> meaning of values that are the same for all robots of a world."""
OWN = {
    "own_picked": "Items that the robot picked in the period and nobody had picked before.",
    "own_recycled": "Items that the robot recycled in the period.",
    "own_dumped": "Items that the robot dumped in the period.",
    "own_collisions": "Collision events of the period in which the robot took part.",
    "own_contact_s": "Time of the period at which somebody was closer than the collision distance [s].",
    "own_avoiding_s": "Time of the period in which the robot avoided others [s].",
}
"""Key -> meaning of values of each robot, in the order of `EVENTS`."""
TIMES = ("own_contact_s", "own_avoiding_s")
"""Keys of `OWN` that are times; their events are ticks."""


def team_columns(worlds: Worlds, progress: MissionProgress) -> FigureColumns:
    """Return the values of `TEAM` of each world."""
    times = [ticks * worlds.period for ticks in progress.elapsed.tolist()]
    if not worlds.mission.cleans:
        measures = {key_of(name): values.tolist() for name, values in worlds.task.result().items()}
        events, met = worlds.collisions.events[:, 0].tolist(), worlds.task.met().tolist()
        common = {"time_s": times, "duration_s": times.copy()}
        return common | {"mission_collision_events": events, "completed": met} | measures
    return {
        "time_s": times,
        "dumped": progress.dumped.tolist(),
        "garbage_done": worlds.garbage.done.tolist(),
        "mission_collision_events": worlds.collisions.events[:, 0].tolist(),
        "completed": [outcome == COMPLETED for outcome in progress.outcome.tolist()],
        "duration_s": times.copy(),
    }


def own_columns(worlds: Worlds, progress: MissionProgress) -> FigureColumns:
    """Return the values of `OWN` of each row; those of garbage only where robots clean."""
    columns = dict(zip(OWN, progress.events.tolist(), strict=True))
    if not worlds.mission.cleans:
        columns = {name: columns[name] for name in ("own_collisions", "own_contact_s")}
    for name in (time for time in TIMES if time in columns):
        columns[name] = [ticks * worlds.period for ticks in columns[name]]
    return columns
