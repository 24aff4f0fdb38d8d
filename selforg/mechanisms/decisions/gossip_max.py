"""Gossip: the highest value that any robot has."""

from typing import Unpack

import numpy as np
import numpy.typing as npt

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Sight, Store, open_sight, open_store
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.decisions.base import DecisionRule, NeighbourDecision, open_decision_rule
from selforg.mechanisms.spreading import Carried


@MECHANISMS.register
class GossipMax(NeighbourDecision):
    """Value: the maximum of the own and all received values; the state is a name that never changes."""

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        channel: str = "gossip",
        key: str = "max",
        value: npt.ArrayLike = 1.0,
        state: str = "None",
        carried: Carried | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        self.states = (state,)
        carried = carried or Carried(channel, key, attraction=0, diffusion=np.inf, goal_radius=0.0)
        super().__init__(buffer, channel=channel, key=key, value=value, carried=carried, **options)

    @staticmethod
    @part
    def term(row: int, found: int, sight: Handle[Sight], deciding: Handle[DecisionRule], store: Handle[Store]) -> None:
        """Take the maximum of the own value and those that pairs carry under the key."""
        d, s, pairs = open_decision_rule(deciding), open_store(store), open_sight(sight).pairs
        for index in range(found):
            slot = int(pairs[index, c.PAIR_SLOT])
            if slot >= 0 and s.marks[slot, c.MARK_KEY] == d.key:
                d.values[row] = max(d.values[row], s.far[slot, c.FAR_VALUE])
