"""The blueprint of decision mechanisms: a value and a state for each row, spread so that others can decide by them."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms.base import LookOptions, Mechanism
from selforg.mechanisms.spreading import Carried, Spreader


@dataclass(frozen=True)
class Decision:
    """What `rows` decided: values (R,) float64, states (R,) int64 (indices of `states`), decided (R,) bool."""

    values: Floats
    states: Ints
    decided: Flags


class DecisionMechanism(Mechanism):
    """Blueprint of a mechanism that keeps a value and a state per row.

    `decide` works them out without consequence; `spread` takes them over and tells the others. Subclasses implement
    `_decide` and name their `states`.

    Example:
        >>> gossip = GossipMax(buffer, channel="highest", value=[3.0, 5.0])
        >>> gossip.spread(now=0.2)
        >>> gossip.decide(now=0.4).values

    """

    states: tuple[str, ...] = ("None",)

    values: Annotated[Floats, "N", KEPT]
    state_codes: Annotated[Ints, "N", KEPT]
    _first_values: Annotated[Floats, "N", READ]
    _all_rows: Annotated[Ints, "N", READ]

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        value: npt.ArrayLike = 0.0,
        state: str | None = None,
        carried: Carried | None = None,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        state = self.states[0] if state is None else state
        if state not in self.states:
            raise ValueError(f"{type(self).__name__}: state must be one of {', '.join(self.states)}, got {state!r}")
        self.values = np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), (rows,)))
        if not np.isfinite(self.values).all():
            raise ValueError(f"{type(self).__name__}: value must be finite, got {value!r}")
        self.state_codes = np.full(rows, self.states.index(state), dtype=np.int64)
        self._first_values, self._first_state = self.values.copy(), self.states.index(state)
        self._spreader = Spreader(self.buffer, carried) if carried else None
        self._all_rows = np.arange(rows, dtype=np.int64)

    @final
    def decide(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> Decision:
        """Return what `rows` (R,) (None: all) would decide at `now` [s]; rows without a pose see no neighbours."""
        chosen = self._all_rows if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        values, states = self.values[chosen], self.state_codes[chosen]
        decided = self.poses.known[chosen]
        self._decide(float(now), chosen, values, states, decided)
        return Decision(values, states, decided)

    @final
    def spread(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> Decision:
        """Decide, keep it, and spread the value in a moving gradient of each row that knows its pose."""
        chosen = self._all_rows if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        decision = self.decide(now, chosen)
        takes = decision.decided & self.poses.known[chosen]
        kept = chosen[takes]
        self.values[kept], self.state_codes[kept] = decision.values[takes], decision.states[takes]
        self._spread(float(now), kept)
        return decision

    @final
    def reset(self, rows: npt.ArrayLike) -> None:
        """Give `rows` (R,) their first value and state back."""
        chosen = np.asarray(rows, dtype=np.int64)
        self.values[chosen], self.state_codes[chosen] = self._first_values[chosen], self._first_state

    def state_names(self, decision: Decision) -> list[str]:
        """Return the names of the decided states, (R,)."""
        return [self.states[code] for code in decision.states]

    def _spread(self, now: float, rows: Ints) -> None:
        """Tell the others; called by `spread` with the rows that know their pose, after values are taken over."""
        if self._spreader:
            self._spreader.spread(now, rows, self.values[rows])

    @abstractmethod
    def _decide(self, now: float, rows: Ints, values: Floats, states: Ints, decided: Flags) -> None:
        """Write value, state and whether there is a decision for `rows` (R,); they come in as they are now."""
