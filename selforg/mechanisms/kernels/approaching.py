"""Approaching one of several goals: which one, by way and by the others there, and waiting before it (compiled)."""

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import CLOCKED, KEPT, SCRATCH, Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.compiler.records import Recording, Words, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.kernels.others import OTHER_X, OTHER_Y, note_others, speed_to_change
from selforg.space import nearest_image, wrapped

CHOSEN_AT, WAITING_SINCE = 0, 1  # columns of `Approaching.times`
RECENT = 1.0
"""Time for which a choice counts as made before [s]."""
SAME_GOAL = 1e-6
"""Distance up to which two goals are the same one [m]."""


class Approaching(NamedTuple):
    """The parameters of `ApproachLeastBusy`, what rows remember, and room for the others of one row."""

    others: Annotated[Floats, "N OTHER", SCRATCH]  # columns OTHER_
    places: Annotated[Floats, "N 2", KEPT]  # of the goal that each row chose last [m]
    times: Annotated[Floats, "N TIME", CLOCKED]  # columns CHOSEN_AT and WAITING_SINCE [s], -inf: never
    view_distance: float  # from here on: see `ApproachLeastBusy`
    weight: float
    crowd: float
    loyalty: float
    halt: float
    lane: float
    patience: float


APPROACHING = Recording(Approaching)
open_approaching = APPROACHING.open


@lean_kernel
def approach_rows(
    now: float,
    rows: Ints,
    start: Ints,
    goals: Floats,
    commands: Words[Commanded],
    approaching: Written[Approaching],
    poses: Words[Poses],
) -> None:
    """Change the commands of `rows` (K,) at `now` [s]; rows without a command that moves them keep it.

    Row i may choose among goals[start[i]:start[i + 1]] (P, PAIR_COLUMNS).
    """
    m, a = open_commanded(commands), open_approaching(approaching)
    for index in range(len(rows)):
        row, seen = rows[index], goals[start[index] : start[index + 1]]
        speed = speed_to_change(row, commands, poses)
        if speed == 0.0 or len(seen) == 0:
            continue
        count = note_others(row, now, a.view_distance, a.others, poses)
        goal = seen[choose_goal(row, now, seen, count, approaching, poses)]
        distance = goal[c.PAIR_DISTANCE]
        if distance > 0.0:
            m.vectors[row, 0] = speed * goal[c.PAIR_DX] / distance
            m.vectors[row, 1] = speed * goal[c.PAIR_DY] / distance
        if distance > a.halt or others_before(goal, a.lane, count, approaching, poses) == 0:
            a.times[row, WAITING_SINCE] = -np.inf
            continue
        if a.times[row, WAITING_SINCE] == -np.inf:
            a.times[row, WAITING_SINCE] = now
        m.in_place[row] = now - a.times[row, WAITING_SINCE] <= a.patience


@part
def choose_goal(
    row: int, now: float, goals: Floats, count: int, approaching: Written[Approaching], poses: Words[Poses]
) -> int:
    """Return which of the `goals` (P, PAIR_COLUMNS) is nearest, with the way that the others before it are worth."""
    a, p = open_approaching(approaching), open_poses(poses)
    recent = now - a.times[row, CHOSEN_AT] <= RECENT
    best, chosen = np.inf, 0
    for k in range(len(goals)):
        cost = goals[k, c.PAIR_DISTANCE] + a.weight * others_before(goals[k], a.crowd, count, approaching, poses)
        x, y = goal_place(row, goals[k], poses)
        x, y = nearest_image(x - a.places[row, 0], p.extent[0]), nearest_image(y - a.places[row, 1], p.extent[1])
        if recent and abs(x) <= SAME_GOAL and abs(y) <= SAME_GOAL:
            cost -= a.loyalty
        if cost < best:
            best, chosen = cost, k
    a.places[row, 0], a.places[row, 1] = goal_place(row, goals[chosen], poses)
    a.times[row, CHOSEN_AT] = now
    return chosen


@inlined
def goal_place(row: int, goal: Floats, poses: Words[Poses]) -> tuple[float, float]:
    """Return where a goal lies that a row sees [m]."""
    p = open_poses(poses)
    x, y = p.own[row, 0, c.X] + goal[c.PAIR_DX], p.own[row, 0, c.Y] + goal[c.PAIR_DY]
    return wrapped(x, p.extent[0]), wrapped(y, p.extent[1])


@part
def others_before(goal: Floats, radius: float, count: int, approaching: Words[Approaching], poses: Words[Poses]) -> int:
    """Return how many of the first `count` others are within `radius` [m] of a goal, and nearer to it than the row."""
    a, p = open_approaching(approaching), open_poses(poses)
    nearest = min(radius, goal[c.PAIR_DISTANCE])
    before = 0
    for other in range(count):
        x = nearest_image(a.others[other, OTHER_X] - goal[c.PAIR_DX], p.extent[0])
        y = nearest_image(a.others[other, OTHER_Y] - goal[c.PAIR_DY], p.extent[1])
        before += x * x + y * y < nearest * nearest
    return before
