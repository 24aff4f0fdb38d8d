"""The kernel that moves rows: gather, apply the rule, limit - for any number of rows in one call."""

import numpy as np

from selforg.arrays import Ints
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Look, Margins, Poses, Sight, Store, open_poses, open_sight
from selforg.gradients.store.view_angle import keep_ahead
from selforg.mechanisms.kernels.movement_rule import NOT_AT_ALL, OWN_GOAL_RADIUS
from selforg.mechanisms.kernels.rules import combine
from selforg.mechanisms.kernels.steering import Movements, Own, Steering, limit, open_movements, open_steering
from selforg.randomness import take_direction


@lean_kernel
def move_rows(
    now: float,
    rows: Ints,
    places: Ints,
    movements: Words[Movements],
    sight: Words[Sight],
    steering: Words[Steering],
    poses: Words[Poses],
    store: Words[Store],
) -> int:
    """Write the movement of `rows` (R,) into the rows `places` (R,) of `movements`.

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    m, p, answers = open_steering(steering), open_poses(poses), open_movements(movements)
    room = len(open_sight(sight).pairs)
    looks = m.looks_repulsive + m.looks_neutral + m.looks_attractive > 0
    for index in range(len(rows)):
        row, place = int(rows[index]), places[index]
        m.total[:] = 0.0
        moves = False
        if p.rows[row, c.ROW_POSES] > 0:
            goal_radius = p.own[row, 0, c.GOAL_RADIUS]
            own = Own(goal_radius, p.own[row, 0, c.DIFFUSION] + goal_radius)
            found = 0
            if looks:
                margins = margins_of(goal_radius, steering)
                found = gather(look_all_around(row, now, m.see, margins, 0, sight, poses), sight, poses, store)
            if found > room:
                return index
            if m.ahead:
                found = keep_ahead(row, found, m.angle_xy, m.angle_yz, sight, poses)
            if found > 0 or not looks:
                moves = combine(m.combination, row, found, own, sight, steering)
            if not moves and m.wakes_repulsive + m.wakes_neutral + m.wakes_attractive > 0:
                moves = gather(look_for_one(row, now, steering, poses), sight, poses, store) > 0
            if moves:
                finish(row, own.reach, steering)
        answers.active[place] = moves
        for axis in range(answers.vectors.shape[1]):
            answers.vectors[place, axis] = m.total[axis]
        if 2 * m.cursor[row] >= m.directions.shape[1]:
            m.low[0] = True
    return len(rows)


@part
def margins_of(goal_radius: float, steering: Words[Steering]) -> Margins:
    """Return the margins [m] within which the rule can be different from zero, for an own `goal_radius` [m]."""
    m = open_steering(steering)
    return (
        margin(m.looks_repulsive, m.view_distance, goal_radius),
        margin(m.looks_neutral, m.view_distance, goal_radius),
        margin(m.looks_attractive, m.view_distance, goal_radius),
    )


@part
def margin(looks: int, view: float, goal_radius: float) -> float:
    """Return how far beyond its reach a gradient is looked at [m]; see `movement_rule`."""
    if looks == NOT_AT_ALL:
        return -np.inf
    return min(view, goal_radius) if looks == OWN_GOAL_RADIUS else view


@part
def look_for_one(row: int, now: float, steering: Words[Steering], poses: Words[Poses]) -> Look:
    """Return the look of a row for any one gradient that makes the rule active though it adds nothing."""
    m, own = open_steering(steering), open_poses(poses).own
    nowhere = -np.inf
    margins = (
        m.view_distance if m.wakes_repulsive else nowhere,
        m.view_distance if m.wakes_neutral else nowhere,
        m.view_distance if m.wakes_attractive else nowhere,
    )
    return Look(row, 0, 1, now, m.see, margins, own[row, 0, c.X], own[row, 0, c.Y], own[row, 0, c.Z])


@part
def finish(row: int, own_reach: float, steering: Words[Steering]) -> None:
    """Limit the sum: repulsions among robots to the own reach, all others to their speeds."""
    m = open_steering(steering)
    if m.by_own_reach:
        limit(m.total, 0.0, own_reach)
        return
    if m.random and m.total[0] == 0.0 and m.total[1] == 0.0 and m.total[2] == 0.0:
        x, y, z = take_direction(m.directions, m.cursor, row)
        m.total[0], m.total[1], m.total[2] = x * m.max_speed, y * m.max_speed, z * m.max_speed
    limit(m.total, m.min_speed, m.max_speed)
