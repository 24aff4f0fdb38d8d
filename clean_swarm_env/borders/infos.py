"""Infos of all borders: one set of keys with one meaning, in every step, so that recorders can keep them.

The values belong to the decision period that has passed and to its mission, at the end of a mission too. Only masks
and `alive` say something of the coming period. Robots have the keys of `OWN`, and `own_NAME` for each of
`Task.achievements`; teams have

- `time_s`: time since the mission began [s];
- `mission_collision_events`: times in the mission so far that a pair came closer than the collision distance;
- `completed`: whether all garbage of the mission is dumped, or all measures of the task meet their targets;
- `duration_s`: time of the mission so far; at its end when the last item was dumped, or the time limit [s];
- `NAME` for each achievement that is counted of teams, too, as `dumped` of cleaning;
- `Task.totals` in the mission so far, as `garbage_done` of cleaning;
- the measures of the task (`clean_swarm_env.tasks`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.mission_end import COMPLETED
from clean_swarm_env.world.parts.measure import key_of

Info = dict[str, Any]

MASK, OPTION_MASK = "action_mask", "option_mask"
"""Keys of the options that can serve in the coming period, 1 or 0: where these are the action, and where they are a
part of it. Libraries use `action_mask` to sample whole actions."""
OWN = {
    "own_collisions": "Collision events of the period in which the robot took part.",
    "own_contact_s": "Time of the period at which somebody was closer than the collision distance [s].",
    "own_avoiding_s": "Time of the period in which the robot avoided others [s].",
}
"""Key -> meaning of values of each robot in all tasks, in the order of `EVENTS`."""
SECONDS = ("own_contact_s", "own_avoiding_s")
"""Keys of what is counted in ticks, and told in seconds."""
ALIVE = "alive"
"""Key of whether the robot is at work. If not, its observation is zeros, and its action does nothing."""


def team_infos(batch: Batch) -> Info:
    """Return the values of all worlds, each one after the other, that are the same for all robots of a world."""
    worlds, progress, task = batch.worlds, batch.progress, batch.worlds.task
    values = task.result()
    times = [ticks * worlds.period for ticks in progress.elapsed.tolist()]
    completed = task.completed(values) if task.measures else progress.outcome == COMPLETED
    achieved = zip(task.achievements, progress.team.tolist(), strict=True)
    columns: Info = {
        "time_s": times,
        "mission_collision_events": worlds.collisions.events[:, 0].tolist(),
        "completed": completed.tolist(),
        "duration_s": times.copy(),
        **{achievement.name: counts for achievement, counts in achieved if achievement.team},
        **{name: counts.tolist() for name, counts in task.totals().items()},
        **{key_of(name): own.tolist() for name, own in values.items()},
    }
    for end in batch.finished:  # such a world may have begun anew
        for name, value in end.statistics.items():
            columns[name][end.world] = value
    return columns


def own_infos(batch: Batch) -> Info:
    """Return the achievements of each row, the values of `OWN`, which robots are at work, and the masks (R, O)."""
    worlds, columns = batch.worlds, Info()
    names = [*(f"own_{achievement.name}" for achievement in worlds.task.achievements), *OWN]
    for name, counts in zip(names, batch.progress.events.tolist(), strict=True):
        columns[name] = [ticks * worlds.period for ticks in counts] if name in SECONDS else counts
    columns[ALIVE] = batch.alive.tolist()
    if batch.action.mode != "velocity":
        columns[MASK if batch.action.mode == "option" else OPTION_MASK] = batch.masks().view(np.int8)
    return columns


def robot_infos(batch: Batch) -> list[Info]:
    """Return the infos of each row: those of its world and its own, masks as `sample` of the space takes them."""
    team, own, counts = team_infos(batch), own_infos(batch), batch.choices.counts
    for name in own.keys() & {MASK, OPTION_MASK} if len(counts) > 1 else ():
        own[name] = zip(*np.split(own[name], np.cumsum(counts)[:-1], axis=1), strict=True)
    rows, infos = zip(*own.values(), strict=True), []
    for values in zip(*team.values(), strict=True):
        shared = dict(zip(team, values, strict=True))
        for _ in range(batch.robots):
            info = shared.copy()
            info.update(zip(own, next(rows), strict=True))
            infos.append(info)
    return infos
