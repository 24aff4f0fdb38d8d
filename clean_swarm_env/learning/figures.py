"""Figures of missions for the infos of all borders: their keys, and their values as columns.

Every task has the keys below whose names it has in `Task.counted`; beside them its teams have

- `time_s`: time since the mission began [s];
- `mission_collision_events`: times in the mission so far that a pair came closer than the collision distance;
- `completed`: whether all garbage of the mission is dumped, or all measures of the task meet their targets;
- `duration_s`: time of the mission so far; at its end when the last item was dumped, or the time limit [s];
- the measures of the task.
"""

from __future__ import annotations

from clean_swarm_env.learning.interface import FigureColumns
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.mission_end import COMPLETED
from clean_swarm_env.world.task_parts import key_of
from clean_swarm_env.world.worlds import Worlds

OWN = {
    "own_picked": "Items that the robot picked in the period and nobody had picked before.",
    "own_recycled": "Items that the robot recycled in the period.",
    "own_dumped": "Items that the robot dumped in the period.",
    "own_collisions": "Collision events of the period in which the robot took part.",
    "own_contact_s": "Time of the period at which somebody was closer than the collision distance [s].",
    "own_avoiding_s": "Time of the period in which the robot avoided others [s].",
}
"""Key -> meaning of values of each robot, in the order of `EVENTS`."""


def team_columns(worlds: Worlds, progress: MissionProgress) -> FigureColumns:
    """Return the values of each world; `dumped`: items in the period, `garbage_done`: in the mission so far."""
    task, values = worlds.task, worlds.task.measured()
    times = [ticks * worlds.period for ticks in progress.elapsed.tolist()]
    completed = task.completed(values) if task.measures else progress.outcome == COMPLETED
    columns: FigureColumns = {
        "time_s": times,
        "mission_collision_events": worlds.collisions.events[:, 0].tolist(),
        "completed": completed.tolist(),
        "duration_s": times.copy(),
    }
    of_items = {"dumped": progress.dumped, "garbage_done": task.items_done()}
    columns |= {name: counts.tolist() for name, counts in of_items.items() if name in task.counted}
    return columns | {key_of(name): own.tolist() for name, own in values.items()}


def own_columns(worlds: Worlds, progress: MissionProgress) -> FigureColumns:
    """Return the values of `OWN` of each row."""
    columns: FigureColumns = {}
    for name, counts in zip(OWN, progress.events.tolist(), strict=True):
        if name in worlds.task.counted:
            columns[name] = [ticks * worlds.period for ticks in counts] if name.endswith("_s") else counts
    return columns
