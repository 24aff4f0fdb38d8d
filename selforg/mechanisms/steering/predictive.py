"""Steering by looking ahead: take the velocity near the commanded one that promises most."""

from typing import Unpack

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.commands import Commanded
from selforg.compiler.records import Words
from selforg.elementary import unit_vectors
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.base import at_least
from selforg.mechanisms.kernels.foresight import FORESIGHT, PLACE_KNOWN, Foresight, foresee_rows
from selforg.mechanisms.kernels.others import OTHER_COLUMNS
from selforg.mechanisms.options import LookOptions
from selforg.mechanisms.registry import MECHANISMS
from selforg.mechanisms.steering.base import SteeringMechanism
from selforg.randomness import DirectionStream

TURNS = (0, 15, -15, 30, -30, 50, -50, 75, -75, 105, -105, 150, -150)
"""Directions beside the wanted one that are looked at [degrees]."""
SHARES = (1.0, 0.5, 0.2)
"""Shares of the wanted speed that are looked at; standing still is looked at too."""


@MECHANISMS.register
class PredictiveSteering(SteeringMechanism):
    """Of 40 velocities, the one of most progress, after what turning and the threat of other robots cost.

    The others keep their velocities in this look ahead. Velocities that lead too near to another robot are those of the
    velocity obstacle of Fiorini & Shiller (1998, doi:10.1177/027836499801700706); the penalty by the time that is left
    is that of van den Berg, Lin & Manocha (2008, doi:10.1109/ROBOT.2008.4543489). The drive of the robot is known: half
    of a new velocity is still in the old heading, and beyond `turn_beyond` only half of it is driven, after a turn on
    the spot.

    A robot that made no progress for some time (`patience`) dares more for 1 to 4 s, which dissolves jams.

    Args:
        buffer: of the robots, or their poses.
        directions: random times of daring.
        distance: centre distance that others are to keep [m].
        margin: distance beyond that over which the threat grows to 1 [m].
        horizon: time for which the look ahead goes [s].
        caution: weight of a threat [-].
        urgency: threat of coming 1 m nearer than `distance`, at once [1/m].
        turn_cost: cost of a turn by 180 degrees [-].
        turn_beyond: heading error from which the drive turns on the spot [rad].
        patience: time without progress after which a robot dares more [s].
        circle: radius of the circle that a robot must leave to make progress [m].
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
        self._foresight = FORESIGHT.pack(
            Foresight(
                candidates=np.column_stack([candidates, *unit_vectors(candidates[:, 0])]),
                others=np.zeros((rows, OTHER_COLUMNS)),
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
                turn_beyond=at_least(self, "turn_beyond", turn_beyond, 0.0),
                patience=at_least(self, "patience", patience, 0.0),
                circle=at_least(self, "circle", circle, 0.0),
                daring=at_least(self, "daring", daring, 0.0),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Words[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        if self._directions.low[0]:
            self._directions.refill()
        foresee_rows(now, rows, commands, self._foresight.words, self.poses.packed.words)

    def reset(self, rows: Ints) -> None:
        """Forget where `rows` (K,) were, and that they dare more."""
        self._places[rows, PLACE_KNOWN] = 0.0
        self._times[rows] = 0.0
