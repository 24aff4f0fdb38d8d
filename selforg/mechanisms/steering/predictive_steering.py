"""Predictive steering: of several velocities near the commanded one, take the one that promises most.

A velocity promises progress in the wanted direction, less what turning costs, less the threat of each other robot that
would come too near if it kept its velocity.
"""

from typing import Annotated, Any, NamedTuple, Unpack

import numpy as np

from selforg.arrays import CLOCKED, KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.elementary import direction, unit_vectors
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import MOST_WALLS, OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.causes import Causes, note_cause
from selforg.mechanisms.steering.base import (
    OTHER_COLUMNS,
    OTHER_ROW,
    OTHER_VX,
    OTHER_VY,
    OTHER_X,
    OTHER_Y,
    SteeringMechanism,
    note_near_walls,
    note_others,
    speed_to_change,
)
from selforg.parameters import at_least
from selforg.randomness import DirectionStream, next_direction
from selforg.space import nearest_image

TURNS = (0, 15, -15, 30, -30, 50, -50, 75, -75, 105, -105, 150, -150)
"""Directions beside the wanted one that are looked at [degrees]."""
SHARES = (1.0, 0.5, 0.2)
"""Shares of the wanted speed that are looked at; standing still is looked at too."""
PLACE_X, PLACE_Y, PLACE_KNOWN = 0, 1, 2  # columns of `Foresight.places`
SINCE, DARING_UNTIL = 0, 1  # columns of `Foresight.times`
OFF_WISH, OF_SPEED, AHEAD, ASIDE = 0, 1, 2, 3  # columns of `Foresight.candidates`


class Foresight(NamedTuple):
    """The parameters of `PredictiveSteering`, what rows remember, and room for the others of one row."""

    candidates: Annotated[
        Floats, "K 4", READ
    ]  # direction beside the wanted one [rad], share of its speed; cosine and sine
    others: Annotated[Floats, "N+S OTHER", SCRATCH]  # columns OTHER_
    places: Annotated[Floats, "R PLACE", KEPT]  # where each row last made progress; columns PLACE_
    times: Annotated[Floats, "R TIME", CLOCKED]  # columns SINCE and DARING_UNTIL [s]
    directions: Annotated[Floats, "R BLOCK 3", READ]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "R", KEPT]  # next direction of each row
    low: Annotated[Flags, "1", derived(True)]  # set when a row has used half of its directions
    view_distance: float  # from here on: see `PredictiveSteering`
    distance: float
    margin: float
    horizon: float
    caution: float
    urgency: float
    turn_cost: float
    right_cost: float
    turn_beyond: float
    patience: float
    circle: float
    daring: float


open_foresight = opening(Foresight)


@MECHANISMS.register
class PredictiveSteering(SteeringMechanism):
    """Of 40 velocities, the one of most progress, after what turning and the threat of other robots cost.

    The others keep their velocities in this look ahead. Velocities that lead too near to another robot are those of the
    velocity obstacle of Fiorini & Shiller (1998, doi:10.1177/027836499801700706); the penalty by the time that is left
    is that of van den Berg, Lin & Manocha (2008, doi:10.1109/ROBOT.2008.4543489). The drive of the robot is known: half
    of a new velocity is still in the old heading, and beyond `turn_beyond` only half of it is driven, after a turn on
    the spot.

    A robot that made no progress for some time (`patience`) dares more for 1 to 4 s, which dissolves jams. Waiting in
    a queue was tried and cost more (docs/decisions/0100-steer.md).

    Args:
        buffer: of the robots, or their poses.
        directions: random times of daring.
        distance: centre distance that others are to keep [m].
        margin: distance beyond that over which the threat grows to 1 [m].
        horizon: time for which the look ahead goes [s].
        caution: weight of a threat [-].
        urgency: threat of coming 1 m nearer than `distance`, at once [1/m].
        turn_cost: cost of a turn by 180 degrees [-].
        right_cost: further cost of a turn to the right of the wanted direction [-]; robots that meet head-on then both
            pass on the left instead of dodging to and fro.
        turn_beyond: heading error from which the drive turns on the spot [rad].
        patience: time after which a robot that made no progress dares more [s].
        circle: radius of the circle that a robot leaves while it makes progress [m].
        daring: factor on `caution` of a robot that dares more [-].
        **options: see `SteeringMechanism`.

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        directions: DirectionStream | None = None,
        distance: float = 0.591,
        margin: float = 0.05,
        horizon: float = 1.64,
        caution: float = 0.46,
        urgency: float = 37.6,
        turn_cost: float = 0.35,
        right_cost: float = 0.0,
        turn_beyond: float = np.pi / 3.0,
        patience: float = 4.8,
        circle: float = 0.4,
        daring: float = 0.054,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        self._directions = DirectionStream.fixed(rows) if directions is None else directions
        self._places: Floats = np.zeros((rows, 3))
        self._times: Floats = np.zeros((rows, 2))
        turns, shares = np.meshgrid(np.radians(TURNS), SHARES, indexing="ij")
        candidates = np.array([*zip(turns.flat, shares.flat, strict=True), (0.0, 0.0)])
        self._foresight = Packed(
            Foresight(
                candidates=np.column_stack([candidates, *unit_vectors(candidates[:, 0])]),
                others=np.zeros((rows + MOST_WALLS, OTHER_COLUMNS)),
                places=self._places,
                times=self._times,
                directions=self._directions.vectors,
                cursor=self._directions.cursor,
                low=self._directions.low,
                view_distance=self.view_distance,
                distance=at_least(self, "distance", distance, 0.0),
                margin=at_least(self, "margin", margin, 1e-6),
                horizon=at_least(self, "horizon", horizon, 1e-6),
                caution=at_least(self, "caution", caution, 0.0),
                urgency=at_least(self, "urgency", urgency, 0.0),
                turn_cost=at_least(self, "turn_cost", turn_cost, 0.0),
                right_cost=at_least(self, "right_cost", right_cost, 0.0),
                turn_beyond=at_least(self, "turn_beyond", turn_beyond, 0.0),
                patience=at_least(self, "patience", patience, 0.0),
                circle=at_least(self, "circle", circle, 0.0),
                daring=at_least(self, "daring", daring, 0.0),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Handle[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        self._directions.refill()
        foresee_rows(now, rows, commands, self._foresight.handle, self.poses.packed.handle)

    def steering(self, commands: Packed[Commanded]) -> tuple[Any, ...]:
        """Return the kernel of `steer` with its records."""
        return foresee_rows, commands, self._foresight, self.poses.packed

    def weigh(self, now: float, rows: Ints, wishes: Floats, causes: Causes) -> None:
        """Note the others by how much they threaten the wish."""
        foresight, poses = self._foresight.handle, self.poses.packed.handle
        weigh_threats(now, rows, wishes, causes.who, causes.weights, foresight, poses)

    def reset(self, rows: Ints) -> None:
        """Forget where `rows` (K,) were, and that they dare more."""
        self._places[rows, PLACE_KNOWN] = 0.0
        self._times[rows] = 0.0


@lean_kernel
def weigh_threats(
    now: float,
    rows: Ints,
    wishes: Floats,
    who: Ints,
    weights: Floats,
    foresight: Handle[Foresight],
    poses: Handle[Poses],
) -> None:
    """Note the others of `rows` (K,) in the arrays of `Causes`, for `wishes` (N, 2) [m/s] at `now` [s]."""
    f = open_foresight(foresight)
    for row in rows:
        for other in range(note_others(row, now, f.view_distance, f.others, poses)):
            weight = threat(other, wishes[row, 0], wishes[row, 1], foresight)
            note_cause(row, int(f.others[other, OTHER_ROW]), weight, who, weights)


@lean_kernel
def foresee_rows(
    now: float, rows: Ints, commands: Handle[Commanded], foresight: Written[Foresight], poses: Handle[Poses]
) -> int:
    """Change the commands of `rows` (K,) at `now` [s]; rows without a command that moves them keep it.

    This is a step, see `selforg.program`. If there are too few random directions nothing changes, and the result is 1.
    """
    m, f = open_commanded(commands), open_foresight(foresight)
    if f.low[0]:
        return 1
    own = open_poses(poses).own
    for row in rows:
        speed = speed_to_change(row, commands, poses)
        if speed == 0.0:
            continue
        daring = is_stuck(row, now, foresight, poses)
        count = note_others(row, now, f.view_distance, f.others, poses)
        count = note_near_walls(row, count, 0.5 * f.distance, f.others, poses)
        if count == 0:
            continue
        x, y = m.vectors[row, 0] / speed, m.vectors[row, 1] / speed
        caution = f.caution * (f.daring if daring else 1.0)
        best = best_candidate(row, count, x, y, speed, caution, foresight, own)
        share, cosine, sine = f.candidates[best, OF_SPEED], f.candidates[best, AHEAD], f.candidates[best, ASIDE]
        m.vectors[row, 0] = share * speed * (cosine * x - sine * y)
        m.vectors[row, 1] = share * speed * (sine * x + cosine * y)
    return 0


@part
def best_candidate(
    row: int, count: int, x: float, y: float, speed: float, caution: float, foresight: Handle[Foresight], own: Floats
) -> int:
    """Return the candidate beside the unit vector (x, y) that promises most at `speed` [m/s].

    Of equal ones the first counts. Threats only lessen what a candidate promises, so hopeless ones are not looked at.
    """
    f = open_foresight(foresight)
    hx, hy = own[row, 0, c.POSE_HEADING], own[row, 0, c.POSE_HEADING + 1]
    heading = direction(x * hy - y * hx, x * hx + y * hy)  # beside the wanted direction
    best, chosen = -np.inf, 0
    for k in range(len(f.candidates)):
        share, cosine, sine = f.candidates[k, OF_SPEED], f.candidates[k, AHEAD], f.candidates[k, ASIDE]
        turn = abs(f.candidates[k, OFF_WISH] - heading)
        turn = min(turn, 2.0 * np.pi - turn) if share > 0.0 else 0.0
        promise = share * cosine - f.turn_cost * turn / np.pi - (f.right_cost if sine < 0.0 else 0.0)
        if promise <= best:
            continue
        half = 0.5 * share * speed  # the robot goes half of the way as it looks now, or turns before it goes
        vx, vy = half * (cosine * x - sine * y), half * (sine * x + cosine * y)
        if turn <= f.turn_beyond:
            vx, vy = vx + half * hx, vy + half * hy
        for other in range(count):
            promise -= caution * threat(other, vx, vy, foresight)
        if promise > best:
            best, chosen = promise, k
    return chosen


@part
def threat(other: int, vx: float, vy: float, foresight: Handle[Foresight]) -> float:
    """Return the threat [-] of an other robot to one with the velocity (vx, vy) [m/s]: 0 unless they come nearer."""
    f = open_foresight(foresight)
    dx, dy = f.others[other, OTHER_X], f.others[other, OTHER_Y]
    ux, uy = f.others[other, OTHER_VX] - vx, f.others[other, OTHER_VY] - vy
    nearing = -(dx * ux + dy * uy)
    if nearing <= 0.0:
        return 0.0
    squared = ux * ux + uy * uy
    time = min(nearing / squared, f.horizon)
    dx, dy = dx + time * ux, dy + time * uy
    nearest = np.sqrt(dx * dx + dy * dy)
    if nearest >= f.distance + f.margin:
        return 0.0
    late = 1.2 - time / f.horizon
    weight: float = (f.distance + f.margin - nearest) / f.margin + f.urgency * max(f.distance - nearest, 0.0) * late
    return weight


@part
def is_stuck(row: int, now: float, foresight: Written[Foresight], poses: Handle[Poses]) -> bool:
    """Return whether a row dares more, because it has made no progress for too long; note its progress."""
    p, f = open_poses(poses), open_foresight(foresight)
    place, times = f.places[row], f.times[row]
    dx = nearest_image(p.own[row, 0, c.X] - place[PLACE_X], p.extent[0])
    dy = nearest_image(p.own[row, 0, c.Y] - place[PLACE_Y], p.extent[1])
    if place[PLACE_KNOWN] == 0.0 or dx * dx + dy * dy > f.circle * f.circle:
        place[PLACE_X], place[PLACE_Y], place[PLACE_KNOWN] = p.own[row, 0, c.X], p.own[row, 0, c.Y], 1.0
        times[SINCE] = now
    elif now - times[SINCE] > f.patience:
        # robots that block each other must not try again at the same time
        cosine, sine, _ = next_direction(f.directions, f.cursor, f.low, row)
        times[SINCE], times[DARING_UNTIL] = now, now + 2.5 + 1.5 * direction(sine, cosine) / np.pi
    return bool(now < times[DARING_UNTIL])
