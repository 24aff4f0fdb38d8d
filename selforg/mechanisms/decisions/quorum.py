"""Quorum sensing: whether there are enough neighbours."""

from collections.abc import Mapping
from typing import Any, ClassVar, Unpack

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.store.records import Sight, Store
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.decisions.base import DecisionRule, NeighbourDecision, open_decision_rule
from selforg.mechanisms.spreading import Carried
from selforg.parameters import at_least


@MECHANISMS.register
class Quorum(NeighbourDecision):
    """Value: neighbours in view; state: whether they are at least `threshold`.

    channel: whose gradients count, by default the poses'. Nothing is spread unless `carried` says on which channel:
    the original would overwrite the own pose (deviation Q13).
    """

    states = ("False", "True")
    example: ClassVar[Mapping[str, Any]] = {"threshold": 2}

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        threshold: float,
        channel: str | None = None,
        carried: Carried | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        if carried and carried.channel == buffer.poses.channel:
            raise ValueError("Quorum: carried.channel must not be the channel of the poses (Q13)")
        super().__init__(
            buffer, channel=buffer.poses.channel if channel is None else channel, carried=carried, **options
        )
        self.threshold = at_least(self, "threshold", threshold, 0.0)

    @staticmethod
    @part
    def term(row: int, found: int, sight: Handle[Sight], deciding: Handle[DecisionRule], store: Handle[Store]) -> None:
        """Count the neighbours, and compare their number with the threshold."""
        d = open_decision_rule(deciding)
        d.values[row] = found
        d.states[row] = found >= d.threshold
