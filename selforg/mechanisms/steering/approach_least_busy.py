"""Approaching the gradient that is near and little crowded, and waiting before it."""

from typing import Annotated, NamedTuple, Unpack

import numpy as np

from selforg.arrays import CLOCKED, KEPT, SCRATCH, Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import ATTRACTIVE, Filter, Queries
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.steering.base import (
    OTHER_COLUMNS,
    OTHER_X,
    OTHER_Y,
    SteeringMechanism,
    note_others,
    speed_to_change,
)
from selforg.parameters import at_least
from selforg.space import nearest_image, wrapped

CHOSEN_AT, WAITING_SINCE = 0, 1  # columns of `Approaching.times`
RECENT = 1.0
"""Time for which a choice counts as made before [s]."""
SAME_GOAL = 1e-6
"""Distance up to which two goals are the same one [m]."""


class Approaching(NamedTuple):
    """The parameters of `ApproachLeastBusy`, what rows remember, and room for the others of one row."""

    others: Annotated[Floats, "R OTHER", SCRATCH]  # columns OTHER_
    places: Annotated[Floats, "R 2", KEPT]  # of the goal that each row chose last [m]
    times: Annotated[Floats, "R TIME", CLOCKED]  # columns CHOSEN_AT and WAITING_SINCE [s], -inf: never
    view_distance: float  # from here on: see `ApproachLeastBusy`
    weight: float
    crowd: float
    loyalty: float
    halt: float
    lane: float
    patience: float


open_approaching = opening(Approaching)


@MECHANISMS.register
class ApproachLeastBusy(SteeringMechanism):
    """To the attractive gradient of least way, where each robot before it is worth some way; waiting before a busy one.

    A robot is before a gradient if it is nearer to it than the one that chooses, and within `crowd` of it, for the
    choice, or within `lane`, for waiting. Robots are known by the poses that were received. One that waits turns
    towards the gradient.

    Args:
        buffer: of the gradients.
        weight: way that a robot before a gradient is worth [m]; 0: the nearest gradient is taken.
        crowd: distance from a gradient up to which robots count for the choice [m].
        loyalty: way by which another gradient must be better than the one chosen before [m].
        halt: distance from its gradient up to which a robot may have to wait [m]; 0: none waits.
        lane: distance from a gradient within which a robot makes others wait [m].
        patience: longest time for which a robot waits before it goes on [s].
        **options: see `SteeringMechanism`; `view_distance` is that up to which gradients and robots are known.

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        weight: float = 0.0,
        crowd: float = 3.0,
        loyalty: float = 1.0,
        halt: float = 0.0,
        lane: float = 1.0,
        patience: float = 20.0,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        self._queries = Queries(self.buffer)
        self._look = Filter(self.channels, moving=False, view_distance=self.view_distance)
        self._places: Floats = np.zeros((rows, 2))
        self._times: Floats = np.full((rows, 2), -np.inf)
        self._approaching = Packed(
            Approaching(
                others=np.zeros((rows, OTHER_COLUMNS)),
                places=self._places,
                times=self._times,
                view_distance=self.view_distance,
                weight=at_least(self, "weight", weight, 0.0),
                crowd=at_least(self, "crowd", crowd, 0.0),
                loyalty=at_least(self, "loyalty", loyalty, 0.0),
                halt=at_least(self, "halt", halt, 0.0),
                lane=at_least(self, "lane", lane, 0.0),
                patience=at_least(self, "patience", patience, 0.0),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Handle[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        goals = self._queries.gather(now, rows, self._look, signs=ATTRACTIVE)
        poses = self.poses.packed.handle
        approach_rows(now, rows, goals.start, goals.pairs, commands, self._approaching.handle, poses)

    def reset(self, rows: Ints) -> None:
        """Forget what `rows` (K,) chose, and that they wait."""
        self._times[rows] = -np.inf


@lean_kernel
def approach_rows(
    now: float,
    rows: Ints,
    start: Ints,
    goals: Floats,
    commands: Handle[Commanded],
    approaching: Written[Approaching],
    poses: Handle[Poses],
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
        if distance > a.halt or others_before(goal, a.lane, count, a.others, poses) == 0:
            a.times[row, WAITING_SINCE] = -np.inf
            continue
        if a.times[row, WAITING_SINCE] == -np.inf:
            a.times[row, WAITING_SINCE] = now
        m.in_place[row] = now - a.times[row, WAITING_SINCE] <= a.patience


@part
def choose_goal(
    row: int, now: float, goals: Floats, count: int, approaching: Written[Approaching], poses: Handle[Poses]
) -> int:
    """Return which of the `goals` (P, PAIR_COLUMNS) is nearest, with the way that the others before it are worth."""
    a, p = open_approaching(approaching), open_poses(poses)
    recent = now - a.times[row, CHOSEN_AT] <= RECENT
    best, chosen = np.inf, 0
    for k in range(len(goals)):
        cost = goals[k, c.PAIR_DISTANCE] + a.weight * others_before(goals[k], a.crowd, count, a.others, poses)
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
def goal_place(row: int, goal: Floats, poses: Handle[Poses]) -> tuple[float, float]:
    """Return where a goal lies that a row sees [m]."""
    p = open_poses(poses)
    x, y = p.own[row, 0, c.X] + goal[c.PAIR_DX], p.own[row, 0, c.Y] + goal[c.PAIR_DY]
    return wrapped(x, p.extent[0]), wrapped(y, p.extent[1])


@part
def others_before(goal: Floats, radius: float, count: int, others: Floats, poses: Handle[Poses]) -> int:
    """Return how many of the first `count` others are within `radius` [m] of a goal, and nearer to it than the row."""
    p = open_poses(poses)
    nearest = min(radius, goal[c.PAIR_DISTANCE])
    before = 0
    for other in range(count):
        x = nearest_image(others[other, OTHER_X] - goal[c.PAIR_DX], p.extent[0])
        y = nearest_image(others[other, OTHER_Y] - goal[c.PAIR_DY], p.extent[1])
        before += x * x + y * y < nearest * nearest
    return before
