"""The kernel of a formula that a user writes: the sum of the formula over all pairs, for any number of rows."""

from collections.abc import Callable
from functools import cache
from typing import TypeAlias

from selforg.arrays import Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight
from selforg.mechanisms.kernels.steering import (
    Movements,
    Steering,
    add,
    full_length,
    limit,
    open_movements,
    open_steering,
)

UserFormula: TypeAlias = Callable[[float, float, float, float, float, float], float]
"""(distance, own goal radius, own reach, diffusion, goal radius [m], attraction -1, 0, +1) -> length of a contribution:
towards the gradient if positive, away from it if negative; minus infinity is full repulsion, of the gradient's
reach."""
Walk: TypeAlias = Callable[..., int]


@cache
def make_walk(formula: UserFormula) -> Walk:
    """Return a kernel that sums `formula`, a function compiled with `kernel`, over what rows see.

    The kernel takes and returns what `moving.move_rows` does.
    """

    @lean_kernel
    def walk(
        now: float,
        rows: Ints,
        places: Ints,
        movements: Words[Movements],
        sight: Words[Sight],
        steering: Words[Steering],
        poses: Words[Poses],
        store: Words[Store],
    ) -> int:
        m, p, answers = open_steering(steering), open_poses(poses), open_movements(movements)
        pairs = open_sight(sight).pairs
        for index in range(len(rows)):
            row, place = int(rows[index]), places[index]
            m.total[:] = 0.0
            found = 0
            if p.rows[row, c.ROW_POSES] > 0:
                look = look_all_around(
                    row, now, m.see, (m.view_distance, m.view_distance, m.view_distance), 0, sight, poses
                )
                found = gather(look, sight, poses, store)
            if found > len(pairs):
                return index
            own_goal = p.own[row, 0, c.GOAL_RADIUS]
            own_reach = p.own[row, 0, c.DIFFUSION] + own_goal
            for i in range(found):
                distance, diffusion = pairs[i, c.PAIR_DISTANCE], pairs[i, c.PAIR_DIFFUSION]
                goal, sign = pairs[i, c.PAIR_GOAL_RADIUS], pairs[i, c.PAIR_SIGN]
                length = formula(distance, own_goal, own_reach, diffusion, goal, sign)
                add(i, length, full_length(i, sight), row, sight, steering)
            limit(m.total, m.min_speed, m.max_speed)
            answers.active[place] = found > 0
            for axis in range(answers.vectors.shape[1]):
                answers.vectors[place, axis] = m.total[axis]
            if 2 * m.cursor[row] >= m.directions.shape[1]:
                m.low[0] = True
        return len(rows)

    return walk
