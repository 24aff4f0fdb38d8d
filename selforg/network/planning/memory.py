"""The memory of plans: compiled code looks up plans found before, so that a swarm seldom asks its planner.

A key is what a plan can depend on: the alternatives held, the goals that are on, the facts, and for each number how
many steps of its grid it is away from each of its bounds. Two rows with equal keys have the same plans, because every
change of a number is a whole number of grid steps; the memory changes speed only, never an answer. Numbers that plans
only use up are distinguished only within `reach` grid steps from where they suffice; the planner says when that is too
little (see `spending`). docs/decisions/0053-planner-ablation.md says what each memory saves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import READ, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.network import state as st
from selforg.network.planning.problem import STEPS_PER_UNIT
from selforg.network.planning.spending import Spent
from selforg.network.planning.task import Scale
from selforg.network.state import MAX_PLAN, RowStates, open_states

BITS_PER_WORD = 60
FIRST_SIZE = 256
LARGEST = 1 << 62
"""Stands for "no clamp"."""

BOUND_SENSOR, BOUND_CROSSING, BOUND_GRID, BOUND_LOW, BOUND_HIGH = range(5)
"""Columns of bounds: the sensor, where its bound lies, the step of its changes, what it is clamped to [1e-9 units]."""
ENTRY_USED, ENTRY_LENGTH, ENTRY_PLAN = range(3)
"""Columns of entries: 1 where there is one; length of its plan, -1 for none; its plan, and behind it the key."""
KEY_BEGIN = ENTRY_PLAN + MAX_PLAN


class KnownPlans(NamedTuple):
    """What compiled code reads of a memory of plans."""

    goals: int  # number of goals
    facts: Annotated[Ints, "F", READ]  # sensors of the facts that a plan can depend on
    bounds: Annotated[Ints, "BOUND 5", READ]  # bounds of the numbers that a plan can depend on
    coordinators: Annotated[Ints, "H", READ]  # behaviours that hold one of several alternatives
    entries: Annotated[Ints, "N ENTRY", READ]  # an open-addressing table; N is a power of 2


open_known = opening(KnownPlans)


class PlanMemory:
    """Plans by key.

    Args:
        facts: sensors (columns of the readings) of the facts a plan can depend on.
        scales: for each number a plan can depend on, its sensor and its scale.
        coordinators: behaviours that hold one of several alternatives.
        goals: number of goals.
        spent: by sensor, the numbers that are only used up.

    Attributes:
        key_words: K, length of a key.
        count: plans in the memory.
        reach: grid steps beyond which readings of used-up numbers share their plans.
        packed: the record for compiled code, replaced whenever the table is.

    """

    def __init__(
        self,
        facts: Sequence[int],
        scales: Sequence[tuple[int, Scale]],
        coordinators: Sequence[int],
        goals: int,
        spent: Mapping[int, Spent] | None = None,
    ) -> None:
        bounds = [
            (
                sensor,
                crossing,
                scale.grid,
                -LARGEST if scale.low is None else scale.low,
                LARGEST if scale.high is None else scale.high,
            )
            for sensor, scale in scales
            for crossing in scale.crossings
        ]
        self.key_words = -(-(len(facts) + goals) // BITS_PER_WORD) + len(bounds) + len(coordinators)
        self.count = 0
        self.reach = 0
        self._spent = spent or {}
        self._goals = goals
        self._facts: Ints = np.array(facts, dtype=np.int64)
        self._bounds: Ints = np.array(bounds, dtype=np.int64).reshape(len(bounds), 5)
        self._coordinators: Ints = np.array(coordinators, dtype=np.int64)
        self.packed: Packed[KnownPlans] = Packed(self._empty(FIRST_SIZE))
        self._clamp()

    def insert(self, key: Ints, behaviours: Sequence[int] | None) -> None:
        """Remember the plan (None: there is none) for `key` (K,), which has none so far."""
        if 2 * (self.count + 1) > len(self._entries):
            old = self._entries[self._entries[:, ENTRY_USED] == 1]
            self.packed.replace(self._empty(2 * len(self._entries)))
            for entry in old:
                self._entries[self._free_slot(entry[KEY_BEGIN:])] = entry
        entry = self._entries[self._free_slot(key)]
        entry[ENTRY_USED] = 1
        entry[ENTRY_LENGTH] = -1 if behaviours is None else len(behaviours)
        if behaviours is not None:
            entry[ENTRY_PLAN : ENTRY_PLAN + len(behaviours)] = behaviours
        entry[KEY_BEGIN:] = key
        self.count += 1

    def widen(self) -> None:
        """Double `reach`, and delete all plans, because their keys have another meaning now."""
        self.reach = max(2 * self.reach, 1)
        self._clamp()
        self.packed.replace(self._empty(FIRST_SIZE))
        self.count = 0

    def _clamp(self) -> None:
        """Clamp the readings of used-up numbers at `reach` grid steps from their edge."""
        for bound in self._bounds:
            number = self._spent.get(int(bound[BOUND_SENSOR]))
            if number is not None:
                limit = number.edge + (1 if number.above else -1) * self.reach * number.grid
                bound[BOUND_HIGH if number.above else BOUND_LOW] = limit

    def _empty(self, size: int) -> KnownPlans:
        """Return the record of an empty table of `size` entries."""
        self._entries: Ints = np.zeros((size, KEY_BEGIN + self.key_words), dtype=np.int64)
        return KnownPlans(self._goals, self._facts, self._bounds, self._coordinators, self._entries)

    def _free_slot(self, key: Ints) -> int:
        slot = int(hashed(key)) & (len(self._entries) - 1)
        while self._entries[slot, ENTRY_USED]:
            slot = (slot + 1) & (len(self._entries) - 1)
        return slot


@inlined
def hashed(key: Ints) -> np.int64:
    """Return a non-negative hash of the key's words (FNV-1a on thirds of words; small enough never to overflow)."""
    value = np.int64(18652613)
    for word in key:
        for shift in (0, 30, 60):
            part = (word >> np.int64(shift)) & np.int64(0x3FFFFFFF)
            value = ((value ^ part) * np.int64(16777619)) & np.int64(0x7FFFFFFF)
    return value ^ (value >> np.int64(15))


@inlined
def write_key(row: int, states: Written[RowStates], known: Handle[KnownPlans]) -> None:
    """Fill the key of `row`."""
    s, m = open_states(states), open_known(known)
    keys = s.plan_keys
    count = m.facts.shape[0]
    bits = count + m.goals
    for k in range(keys.shape[1]):
        keys[row, k] = 0
    for k in range(bits):
        bit = s.readings[row, m.facts[k]] > 0.5 if k < count else s.goal_enabled[row, k - count] == 1
        if bit:
            keys[row, k // BITS_PER_WORD] |= np.int64(1) << np.int64(k % BITS_PER_WORD)
    at = (bits + BITS_PER_WORD - 1) // BITS_PER_WORD
    for k in range(m.bounds.shape[0]):
        value = np.int64(np.rint(s.readings[row, m.bounds[k, BOUND_SENSOR]] * STEPS_PER_UNIT))
        value = min(max(value, m.bounds[k, BOUND_LOW]), m.bounds[k, BOUND_HIGH])
        gap, grid = value - m.bounds[k, BOUND_CROSSING], m.bounds[k, BOUND_GRID]
        keys[row, at + k] = -(gap // grid) if grid else (1 if gap >= 0 else 0)
    at += m.bounds.shape[0]
    for k in range(m.coordinators.shape[0]):
        keys[row, at + k] = s.marks[row, st.ALTERNATIVE, m.coordinators[k]]


@inlined
def recall(row: int, states: Written[RowStates], known: Handle[KnownPlans]) -> bool:
    """Give `row` the plan that is known for its key; return False if there is none."""
    s, entries = open_states(states), open_known(known).entries
    mask = entries.shape[0] - 1
    slot = hashed(s.plan_keys[row]) & mask
    while entries[slot, ENTRY_USED]:
        same = True
        for k in range(s.plan_keys.shape[1]):
            same = same and entries[slot, KEY_BEGIN + k] == s.plan_keys[row, k]
        if same:
            length = entries[slot, ENTRY_LENGTH]
            s.plan_marks[row, st.PLAN_KNOWN] = 1 if length >= 0 else 0
            s.plan_marks[row, st.PLAN_INDEX] = 0
            s.plan_marks[row, st.PLAN_LENGTH] = max(length, 0)
            for k in range(length):
                s.plan[row, k] = entries[slot, ENTRY_PLAN + k]
            return True
        slot = (slot + 1) & mask
    return False
