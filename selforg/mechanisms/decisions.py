"""Decision mechanisms."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar, Unpack

import numpy as np
import numpy.typing as npt

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.records import Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair_room import PairRoom
from selforg.gradients.store.columns import SEE_MOVING, SKIP_OWN
from selforg.mechanisms.base import at_least
from selforg.mechanisms.decision_base import DecisionMechanism
from selforg.mechanisms.kernels.deciding import (
    DECIDE_BARYCENTER,
    DECIDE_GOSSIP_MAX,
    DECIDE_QUORUM,
    DECISION_RULE,
    DecisionRule,
    decide_rows,
)
from selforg.mechanisms.options import LookOptions
from selforg.mechanisms.registry import MECHANISMS
from selforg.mechanisms.spreading import Carried, Spreader


class NeighbourDecision(DecisionMechanism):
    """A decision by one of the rules of `kernels.deciding`, over the neighbours' moving gradients."""

    rule: int
    threshold: float = 0.0

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        channel: str,
        key: str = "value",
        value: npt.ArrayLike = 0.0,
        state: str | None = None,
        carried: Carried | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        options["channels"] = (channel,)
        options["static"] = False
        super().__init__(buffer, value=value, state=state, carried=carried, **options)
        self._see_bits = SEE_MOVING | SKIP_OWN
        self._key = buffer.keys.code(key)
        self._room = PairRoom(buffer, 64)

    @cached_property
    def _deciding(self) -> Packed[DecisionRule]:
        """What kernels take of the mechanism, packed when it decides for the first time."""
        rows = self.poses.rows
        return DECISION_RULE.pack(
            DecisionRule(
                rule=self.rule,
                see_bits=self._see_bits,
                view_distance=self.view_distance,
                threshold=self.threshold,
                key=self._key,
                before=self.values,
                values=np.zeros(rows),
                states=np.zeros(rows, dtype=np.int64),
                decided=np.zeros(rows, dtype=np.bool_),
            )
        )

    def _decide(self, now: float, rows: Ints, values: Floats, states: Ints, decided: Flags) -> None:
        deciding, poses, store = self._deciding.words, self.poses.packed.words, self.buffer.table.packed.words
        room = self._deciding.record
        room.states[rows] = states
        done = decide_rows(now, rows, self._room.sight(now, self.channels), deciding, poses, store)
        while done < len(rows):
            done += decide_rows(now, rows[done:], self._room.double(), deciding, poses, store)
        values[:], states[:], decided[:] = room.values[rows], room.states[rows], room.decided[rows]


@MECHANISMS.register
class Quorum(NeighbourDecision):
    """Value: neighbours in view; state: whether they are at least `threshold`.

    channel: whose gradients count, by default the poses'. Nothing is spread unless `carried` says on which channel:
    the original would overwrite the own pose (deviation Q13).
    """

    rule = DECIDE_QUORUM
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


@MECHANISMS.register
class GossipMax(NeighbourDecision):
    """Value: the maximum of the own and all received values; the state is a name that never changes."""

    rule = DECIDE_GOSSIP_MAX

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


@MECHANISMS.register
class MorphogenesisBarycenter(NeighbourDecision):
    """Value: sum of the distances to all neighbours; state Center where it is smaller than every received one.

    Neighbours without a value count as equal; without neighbours value and state stay as they are. A Center also
    spreads an attractive gradient `center` whose diffusion is its value.
    """

    rule = DECIDE_BARYCENTER
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


@MECHANISMS.register
class ForagingDecision(DecisionMechanism):
    """State Exploration with a probability, else Exploitation; value: that probability.

    generators: one per row, so that the draws of a row depend on no other.
    """

    states = ("None", "Exploration", "Exploitation", "Return")
    example: ClassVar[Mapping[str, Any]] = {"probability": 1.0}  # needs no generators

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        probability: float = 0.5,
        generators: Sequence[np.random.Generator] = (),
        **options: Unpack[LookOptions],
    ) -> None:
        if not 0.0 <= probability <= 1.0:
            raise ValueError(f"ForagingDecision: probability must lie in [0, 1], got {probability!r}")
        if 0.0 < probability < 1.0 and len(generators) != buffer.poses.rows:
            raise ValueError(f"ForagingDecision: {buffer.poses.rows} generators expected, got {len(generators)}")
        super().__init__(buffer, value=probability, **options)
        self.probability = float(probability)
        self._generators = generators  # not copied: the host may give a row another one

    def _decide(self, now: float, rows: Ints, values: Floats, states: Ints, decided: Flags) -> None:
        values[:] = self.probability
        decided[:] = True  # no pose is needed
        if 0.0 < self.probability < 1.0:
            explores = np.array([self._generators[row].random() < self.probability for row in rows], dtype=np.bool_)
        else:
            explores = np.full(len(rows), self.probability == 1.0)
        states[:] = np.where(explores, self.states.index("Exploration"), self.states.index("Exploitation"))
