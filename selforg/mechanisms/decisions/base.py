"""The blueprint of decision mechanisms: a value and a state for each row, spread so that others can decide by them."""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar, NamedTuple, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import template
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import PairRoom
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight
from selforg.mechanisms.base import LookOptions, Mechanism
from selforg.mechanisms.spreading import Carried, Spreader
from selforg.parameters import check_choice
from selforg.plugins import Promises, are_numbers


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

    promises: ClassVar[Promises] = {
        "_decide": (
            "finite values, and numbers of the states {0.states}",
            lambda mechanism, _, now, rows, values, states, decided: (
                are_numbers(values, len(rows)) and np.isin(states, range(len(mechanism.states))).all()
            ),
            1,
        )
    }
    states: tuple[str, ...] = ("None",)

    values: Annotated[Floats, "N", KEPT]
    state_codes: Annotated[Ints, "N", KEPT]
    _first_values: Annotated[Floats, "N", READ]

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
        check_choice(f"{type(self).__name__}: state", state, self.states)
        self.values = np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), (rows,)))
        if not np.isfinite(self.values).all():
            raise ValueError(f"{type(self).__name__}: value must be finite, got {value!r}")
        self.state_codes = np.full(rows, self.states.index(state), dtype=np.int64)
        self._first_values, self._first_state = self.values.copy(), self.states.index(state)
        self._spreader = Spreader(self.buffer, carried) if carried else None

    @final
    def decide(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> Decision:
        """Return what `rows` (R,) (None: all) would decide at `now` [s]; rows without a pose see no neighbours."""
        chosen = self.poses.chosen(rows)
        values, states = self.values[chosen], self.state_codes[chosen]
        decided = self.poses.known[chosen]
        self._decide(float(now), chosen, values, states, decided)
        return Decision(values, states, decided)

    @final
    def spread(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> Decision:
        """Decide, keep it, and spread the value in a moving gradient of each row that knows its pose."""
        chosen = self.poses.chosen(rows)
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

    def _spread(self, now: float, rows: Ints) -> None:
        """Tell the others; called by `spread` with the rows that know their pose, after values are taken over."""
        if self._spreader:
            self._spreader.spread(now, rows, self.values[rows])

    @abstractmethod
    def _decide(self, now: float, rows: Ints, values: Floats, states: Ints, decided: Flags) -> None:
        """Write value, state and whether there is a decision for `rows` (R,); they come in as they are now."""


class DecisionRule(NamedTuple):
    """A decision rule, what rows have decided so far, and room for what they decide now."""

    alone: int  # 1: a row without a pose decides too
    sight_bits: int  # SEE_ bits
    view_distance: float  # [m]
    threshold: float  # of a quorum: number of neighbours
    key: int  # code of the payload entry that is compared
    before: Annotated[Floats, "R", READ]  # values up to now
    values: Annotated[Floats, "R", SCRATCH]  # room for values
    states: Annotated[Ints, "R", SCRATCH]  # room for states; they come in as they are up to now
    decided: Annotated[Flags, "R", SCRATCH]  # room for whether there is a decision


open_decision_rule = opening(DecisionRule)


def decided(row: int, found: int, sight: Handle[Sight], deciding: Handle[DecisionRule], store: Handle[Store]) -> None:
    """Stand for the term of a mechanism: it writes value and state of a row, which come in as they are up to now."""
    raise NotImplementedError


class NeighbourDecision(DecisionMechanism):
    """A decision over the neighbours' moving gradients.

    Attributes:
        term: what makes value and state of a row from its pairs, compiled with `part`.
        alone: whether a row without a pose decides too, for what it would without neighbours.

    """

    term = staticmethod(decided)
    alone: ClassVar[bool] = True
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
        self._sight_bits = c.SEE_MOVING | c.SKIP_OWN
        self._key = buffer.keys.code(key)
        self._room = PairRoom(buffer, 64)

    @cached_property
    def _deciding(self) -> Packed[DecisionRule]:
        """What kernels take of the mechanism, packed when it decides for the first time."""
        rows = self.poses.rows
        return Packed(
            DecisionRule(
                alone=self.alone,
                sight_bits=self._sight_bits,
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
        room, records = self._deciding.record, (self._room.packed, self._deciding, self.poses.packed)
        room.states[rows] = states
        kernel = decide_rows.of(type(self).term)
        self._room.look(kernel, now, rows, self.channels, *records, self.buffer.table.packed)
        values[:], states[:], decided[:] = room.values[rows], room.states[rows], room.decided[rows]


@template(decided)
def decide_rows(
    now: float,
    rows: Ints,
    sight: Handle[Sight],
    deciding: Handle[DecisionRule],
    poses: Handle[Poses],
    store: Written[Store],
) -> int:
    """Write value, state and whether there is a decision for `rows` (R,) into those rows of `deciding`.

    Returns how many rows are left, the last ones, if the room for pairs is too short for the next one.
    """
    d, known, pairs = open_decision_rule(deciding), open_poses(poses).rows, open_sight(sight).pairs
    margins = (d.view_distance, d.view_distance, d.view_distance)
    for index in range(len(rows)):
        row, found = int(rows[index]), 0
        d.values[row] = d.before[row]
        sees = known[row, c.ROW_POSES] > 0
        d.decided[row] = sees or d.alone > 0
        if sees:
            found = gather(look_all_around(row, now, d.sight_bits, margins, 0, sight, poses), sight, poses, store)
        if found > len(pairs):
            return len(rows) - index
        decided(row, found, sight, deciding, store)
    return 0
