"""The kernel of a formula that a user writes: the sum of the formula over all pairs, for any number of rows."""

from collections.abc import Callable
from functools import cache
from typing import TypeAlias

from selforg.arrays import Ints
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_sight
from selforg.mechanisms.kernels.moving import (
    NO_ROOM,
    Movements,
    Own,
    Steering,
    add,
    full_length,
    move_row,
    write_answer,
)

UserFormula: TypeAlias = Callable[[float, float, float, float, float, float], float]
"""(distance, own goal radius, own reach, diffusion, goal radius [m], attraction -1, 0, +1) -> length of a contribution:
towards the gradient if positive, away from it if negative; minus infinity is full repulsion, of the gradient's
reach."""
Walk: TypeAlias = Callable[..., int]


@cache
def make_walk(formula: UserFormula) -> Walk:
    """Return a kernel that sums `formula`, a function compiled with `kernel`, over what rows see.

    The kernel takes and returns what `rules.move_rows` does.
    """

    @part
    def sum_formula(
        number: int, row: int, found: int, own: Own, sight: Words[Sight], steering: Words[Steering]
    ) -> bool:
        pairs = open_sight(sight).pairs
        for i in range(found):
            distance, diffusion = pairs[i, c.PAIR_DISTANCE], pairs[i, c.PAIR_DIFFUSION]
            goal, sign = pairs[i, c.PAIR_GOAL_RADIUS], pairs[i, c.PAIR_SIGN]
            length = formula(distance, own.goal_radius, own.reach, diffusion, goal, sign)
            add(i, length, full_length(i, sight), row, sight, steering)
        return True

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
        for index in range(len(rows)):
            moves = move_row(int(rows[index]), now, sum_formula, sight, steering, poses, store)
            if moves == NO_ROOM:
                return index
            write_answer(places[index], moves, movements, steering)
        return len(rows)

    return walk
