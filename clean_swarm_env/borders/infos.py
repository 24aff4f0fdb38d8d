"""Infos of all borders: one set of keys with one meaning, in every step, so that recorders can keep them.

The values belong to the decision period that has passed and to its mission, at the end of a mission too. Only
`action_mask` says something of the coming period.
"""

from __future__ import annotations

from typing import Any

from clean_swarm_env.borders.spaces import masks_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission_end import COMPLETED

Info = dict[str, Any]

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
    "own_picked": "Items that the robot picked in the period.",
    "own_recycled": "Items that the robot recycled in the period.",
    "own_dumped": "Items that the robot dumped in the period.",
    "own_collisions": "Collision events of the period in which the robot took part.",
    "own_contact_s": "Time of the period at which somebody was closer than the collision distance [s].",
    "own_avoiding_s": "Time of the period in which the robot avoided others [s].",
}
"""Key -> meaning of values of each robot."""
MASK = "action_mask"
"""Key of the options that can serve in the coming period, 1 or 0; with options as actions only."""


def team_infos(batch: Batch) -> list[Info]:
    """Return the values of `TEAM` for each world."""
    progress, worlds = batch.progress, batch.worlds
    times = (progress.elapsed * worlds.period).tolist()
    infos = [
        {
            "time_s": time,
            "dumped": dumped,
            "garbage_done": done,
            "mission_collision_events": events,
            "completed": outcome == COMPLETED,
            "duration_s": time,
        }
        for time, dumped, done, events, outcome in zip(
            times,
            progress.dumped.tolist(),
            worlds.garbage.done.tolist(),
            worlds.collisions.events[:, 0].tolist(),
            progress.outcome.tolist(),
            strict=True,
        )
    ]
    for end in batch.finished:  # such a world may have begun anew
        infos[end.world] |= end.statistics
    return infos


def robot_infos(batch: Batch) -> list[Info]:
    """Return the values of `TEAM` and `OWN`, and the mask, for each row."""
    events, period, robots = batch.progress.events, batch.worlds.period, batch.robots
    teams = team_infos(batch)
    infos = [
        {
            **teams[row // robots],
            "own_picked": picked,
            "own_recycled": recycled,
            "own_dumped": dumped,
            "own_collisions": collisions,
            "own_contact_s": contact * period,
            "own_avoiding_s": avoiding * period,
        }
        for row, (picked, recycled, dumped, collisions, contact, avoiding) in enumerate(events.T.tolist())  # EVENTS
    ]
    if batch.action.mode == "option":
        for info, mask in zip(infos, masks_of(batch), strict=True):
            info[MASK] = mask
    return infos
