"""Infos of all borders: one set of keys with one meaning, in every step, so that recorders can keep them.

The values belong to the decision period that has passed and to its mission, at the end of a mission too. Only
`action_mask` says something of the coming period. `learning.figures` names the keys of missions; those of goals have
their measures (`clean_swarm_env.tasks`).
"""

from __future__ import annotations

from typing import Any

from clean_swarm_env.borders.spaces import masks_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.figures import own_columns, team_columns
from clean_swarm_env.learning.interface import FigureColumns

Info = dict[str, Any]

MASK = "action_mask"
"""Key of the options that can serve in the coming period, 1 or 0; with options as actions only."""


def team_infos(batch: Batch) -> FigureColumns:
    """Return the values of each world that are the same for all its robots."""
    columns = team_columns(batch.worlds, batch.progress)
    for end in batch.finished:  # such a world may have begun anew
        for name, value in end.statistics.items():
            columns[name][end.world] = value
    return columns


def robot_infos(batch: Batch) -> list[Info]:
    """Return the infos of each row: those of its world, its own, and the mask."""
    team, own = team_infos(batch), own_columns(batch.worlds, batch.progress)
    if batch.action.mode != "velocity":
        own[MASK] = list(masks_of(batch))
    rows, infos = zip(*own.values(), strict=True), []
    for values in zip(*team.values(), strict=True):
        shared = dict(zip(team, values, strict=True))
        for _ in range(batch.robots):
            info = shared.copy()
            info.update(zip(own, next(rows), strict=True))
            infos.append(info)
    return infos
