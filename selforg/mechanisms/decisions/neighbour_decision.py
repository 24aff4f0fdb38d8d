"""Decisions over the neighbours' spread values: their kernel, of which every such mechanism has a copy of its own."""

from collections.abc import Callable
from functools import cached_property
from typing import Annotated, ClassVar, NamedTuple, TypeAlias, Unpack

import numpy as np
import numpy.typing as npt

from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import template
from selforg.compiler.records import Packed, Recording, Words, Written
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair_room import PairRoom
from selforg.gradients.store import columns as c
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Poses, Sight, Store, open_poses, open_sight
from selforg.mechanisms.base import LookOptions
from selforg.mechanisms.decisions.base import DecisionMechanism
from selforg.mechanisms.spreading import Carried


class DecisionRule(NamedTuple):
    """A decision rule, what rows have decided so far, and room for what they decide now."""

    alone: int  # 1: a row without a pose decides too
    see_bits: int  # SEE_ bits
    view_distance: float  # [m]
    threshold: float  # of a quorum: number of neighbours
    key: int  # code of the payload entry that is compared
    before: Annotated[Floats, "N", READ]  # values up to now
    values: Annotated[Floats, "N", SCRATCH]  # room for values
    states: Annotated[Ints, "N", SCRATCH]  # room for states; they come in as they are up to now
    decided: Annotated[Flags, "N", SCRATCH]  # room for whether there is a decision


DECISION_RULE = Recording(DecisionRule)
open_decision_rule = DECISION_RULE.open

DecisionTerm: TypeAlias = Callable[[int, int, Words[Sight], Words[DecisionRule], Words[Store]], None]
"""(row, number of pairs, sight, deciding, store); writes value and state, which come in as they are up to now."""


def decided(row: int, found: int, sight: Words[Sight], deciding: Words[DecisionRule], store: Words[Store]) -> None:
    """Stand for the `DecisionTerm` of a mechanism."""
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
        self._see_bits = c.SEE_MOVING | c.SKIP_OWN
        self._key = buffer.keys.code(key)
        self._room = PairRoom(buffer, 64)

    @cached_property
    def _deciding(self) -> Packed[DecisionRule]:
        """What kernels take of the mechanism, packed when it decides for the first time."""
        rows = self.poses.rows
        return DECISION_RULE.pack(
            DecisionRule(
                alone=self.alone,
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
        kernel, poses, store = decide_rows.of(type(self).term), self.poses.packed.words, self.buffer.table.packed.words
        room, left, sight = self._deciding.record, rows, self._room.sight(now, self.channels)
        room.states[rows] = states
        while (done := kernel(now, left, sight, self._deciding.words, poses, store)) < len(left):
            left, sight = left[done:], self._room.double()
        values[:], states[:], decided[:] = room.values[rows], room.states[rows], room.decided[rows]


@template(decided)
def decide_rows(
    now: float,
    rows: Ints,
    sight: Words[Sight],
    deciding: Words[DecisionRule],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write value, state and whether there is a decision for `rows` (R,) into those rows of `deciding`.

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    d, known, pairs = open_decision_rule(deciding), open_poses(poses).rows, open_sight(sight).pairs
    margins = (d.view_distance, d.view_distance, d.view_distance)
    for index in range(len(rows)):
        row, found = int(rows[index]), 0
        d.values[row] = d.before[row]
        sees = known[row, c.ROW_POSES] > 0
        d.decided[row] = sees or d.alone > 0
        if sees:
            found = gather(look_all_around(row, now, d.see_bits, margins, 0, sight, poses), sight, poses, store)
        if found > len(pairs):
            return index
        decided(row, found, sight, deciding, store)
    return len(rows)
