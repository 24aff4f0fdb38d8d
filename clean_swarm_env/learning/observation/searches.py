"""Searches that fill the fields of `Around` which several observation terms read; the letters of shapes are those of
`Around`.
"""  # noqa: D205

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.around import Around, open_around
from selforg.arrays import Ints
from selforg.compiler.decorators import long_kernel, part
from selforg.compiler.records import Handle
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.steering.base import (
    OTHER_COLUMNS,
    OTHER_ROW,
    OTHER_VX,
    OTHER_VY,
    OTHER_X,
    OTHER_Y,
    note_others,
    own_velocity,
)


@long_kernel
def search(around: Handle[Around], poses: Handle[Poses], chosen: Ints, rows: Ints) -> int:
    """Find neighbours of the robots in the worlds `chosen` (C,), and what they know of others.

    Lists the robots at work in `rows` (R,) and returns their number.
    """
    count = list_working(around, chosen, rows)
    find_heard(around, poses, rows[:count])
    return count


@part
def list_working(around: Handle[Around], chosen: Ints, rows: Ints) -> int:
    """List in `rows` (R,) the robots at work in the worlds `chosen` (C,), and return their number."""
    a = open_around(around)
    count = 0
    for world in chosen:
        for row in range(world * a.robots, (world + 1) * a.robots):
            if a.working[row]:
                rows[count] = row
                count += 1
    return count


@part
def find_heard(around: Handle[Around], poses: Handle[Poses], rows: Ints) -> None:
    """Find what each of `rows` (P,) knows of the nearest other robot in range, and count those within each range.

    What is known is of the time at which the row spread its own pose last.
    """
    a, p = open_around(around), open_poses(poses)
    others, farthest = a.others, a.ranges[-1] * a.ranges[-1]
    for row in rows:
        a.neighbour[row], shortest = -1, np.inf
        for near in range(a.ranges.shape[0]):
            a.within[row, near] = 0
        if p.rows[row, c.ROW_POSES] == 0:
            continue
        vx, vy = own_velocity(row, poses)
        for k in range(note_others(row, p.own[row, 0, c.POSE_STAMP], np.inf, others, poses)):
            square = others[k, OTHER_X] * others[k, OTHER_X] + others[k, OTHER_Y] * others[k, OTHER_Y]
            for near in range(a.ranges.shape[0]):
                a.within[row, near] += square <= a.ranges[near] * a.ranges[near]
            if square <= farthest and square < shortest:
                shortest, a.neighbour[row] = square, int(others[k, OTHER_ROW])
                for column in range(OTHER_COLUMNS):
                    a.heard[row, column] = others[k, column]
                a.heard[row, OTHER_VX] -= vx
                a.heard[row, OTHER_VY] -= vy
