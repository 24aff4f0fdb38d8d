"""Morphogenesis: the robot in the middle of its neighbours becomes the centre."""

from typing import Unpack

import numpy as np
import numpy.typing as npt

from selforg.arrays import Ints
from selforg.compiler.decorators import part
from selforg.compiler.records import Handle
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Sight, Store, open_sight, open_store
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.decisions.base import DecisionRule, NeighbourDecision, open_decision_rule
from selforg.mechanisms.spreading import Carried, Spreader


@MECHANISMS.register
class MorphogenesisBarycenter(NeighbourDecision):
    """Value: sum of the distances to all neighbours; state Center where it is smaller than every received one.

    Neighbours without a value count as equal; without neighbours value and state stay as they are. A Center also
    spreads an attractive gradient `center` whose diffusion is its value.
    """

    alone = False  # distances need an own position
    states = ("None", "Center")

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        channel: str = "morphogenesis",
        key: str = "barycenter",
        value: npt.ArrayLike = 0.0,
        state: str | None = None,
        carried: Carried | None = None,
        center: Carried | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        carried = carried or Carried(channel, key, attraction=-1, diffusion=np.inf, goal_radius=0.5)
        super().__init__(buffer, channel=channel, key=key, value=value, state=state, carried=carried, **options)
        self._center = Spreader(buffer, center or Carried("Center", "", attraction=1, goal_radius=2.0, moving=False))

    def _spread(self, now: float, rows: Ints) -> None:
        super()._spread(now, rows)
        centers = rows[self.state_codes[rows] == 1]
        self._center.spread(now, centers, self.values[centers], diffusions=self.values[centers])

    @staticmethod
    @part
    def term(row: int, found: int, sight: Handle[Sight], deciding: Handle[DecisionRule], store: Handle[Store]) -> None:
        """Sum the distances, and compare the sum with those that pairs carry under the key."""
        d, s, pairs = open_decision_rule(deciding), open_store(store), open_sight(sight).pairs
        if found == 0:
            return
        d.values[row] = 0.0
        for index in range(found):
            d.values[row] += pairs[index, c.PAIR_DISTANCE]
        d.states[row] = 1
        for index in range(found):
            slot = int(pairs[index, c.PAIR_SLOT])
            knows = slot >= 0 and s.marks[slot, c.MARK_KEY] == d.key
            if not knows or not s.far[slot, c.FAR_VALUE] > d.values[row]:
                d.states[row] = 0
