"""Plans found before, looked up by compiled code, so that a swarm that replans all the time seldom leaves the kernel.

A key is what a plan can depend on: the alternatives held, the goals that are on, the facts, and for each number how
many steps of its grid it is away from each of its bounds (see `PlanTask.signature`). Numbers that plans only use up
are told apart no further than `reach` steps from where they suffice; the planner says when that is too little (see
`plan_spending`). Equal keys have equal plans; the memory therefore changes speed only, never an answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from selforg.compiler.decorators import inlined
from selforg.network.model.packed import Floats, Ints
from selforg.network.planning.guards import STEPS_PER_UNIT
from selforg.network.planning.spending import Spent
from selforg.network.planning.task import Scale
from selforg.network.state import state as st
from selforg.network.step.plan_monitoring import INDEX, KNOWN, LENGTH, MAX_PLAN

BITS_PER_WORD = 60
LARGEST = 1 << 62  # stands for "no clamp"


class PlanMemory:
    """Open-addressing table of plans; `entries` rows are [used, length or -1 (no plan), steps (P), key (K)].

    Args:
        facts: sensors (columns of the readings) of the facts a plan can depend on.
        scales: for each number a plan can depend on, its sensor and its scale.
        coordinators: behaviours that hold one of several alternatives.
        goals: number of goals.
        spent: of which sensors the numbers are only used up, and how.

    Attributes:
        reach: grid steps beyond which readings of such numbers share their plans.

    """

    def __init__(
        self,
        facts: Sequence[int],
        scales: Sequence[tuple[int, Scale]],
        coordinators: Sequence[int],
        goals: int,
        spent: Mapping[int, Spent] | None = None,
    ) -> None:
        words = [
            (sensor, crossing, scale.grid, _or(scale.low, -LARGEST), _or(scale.high, LARGEST))
            for sensor, scale in scales
            for crossing in scale.crossings
        ]
        self.layout: Ints = np.array(
            [len(facts), len(words), len(coordinators), goals, *facts, *sum(words, ()), *coordinators], dtype=np.int64
        )
        bits = len(facts) + goals
        self.key_words = -(-bits // BITS_PER_WORD) + len(words) + len(coordinators)
        self.entries: Ints = self._empty(256)
        self.count = 0
        self.reach = 0
        self._spent = spent or {}
        self._clamp()

    def insert(self, key: Ints, behaviours: Sequence[int] | None) -> None:
        """Remember the plan (None: there is none) for `key` (K,)."""
        if 2 * (self.count + 1) > len(self.entries):
            old = self.entries[self.entries[:, 0] == 1]
            self.entries = self._empty(2 * len(self.entries))
            for entry in old:
                self.entries[self._free_slot(entry[2 + MAX_PLAN :])] = entry
        entry = self.entries[self._free_slot(key)]
        entry[0] = 1
        entry[1] = -1 if behaviours is None else len(behaviours)
        if behaviours is not None:
            entry[2 : 2 + len(behaviours)] = behaviours
        entry[2 + MAX_PLAN :] = key
        self.count += 1

    def widen(self) -> None:
        """Tell more readings apart from now on, and forget everything: keys written before are worth nothing."""
        self.reach = max(2 * self.reach, 1)
        self._clamp()
        self.entries = self._empty(256)
        self.count = 0

    def _clamp(self) -> None:
        facts, words = self.layout[:2].tolist()
        for word in self.layout[4 + facts : 4 + facts + 5 * words].reshape(words, 5):  # views into the layout
            number = self._spent.get(int(word[0]))
            if number is not None:
                word[4 if number.above else 3] = number.edge + (1 if number.above else -1) * self.reach * number.grid

    def _empty(self, size: int) -> Ints:
        return np.zeros((size, 2 + MAX_PLAN + self.key_words), dtype=np.int64)

    def _free_slot(self, key: Ints) -> int:
        slot = int(hashed(key)) & (len(self.entries) - 1)
        while self.entries[slot, 0]:
            slot = (slot + 1) & (len(self.entries) - 1)
        return slot


def _or(value: int | None, otherwise: int) -> int:
    return otherwise if value is None else value


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
def write_key(row: int, layout: Ints, readings: Floats, marks: Ints, goal_enabled: Ints, keys: Ints) -> None:
    """Fill keys[row] (K,) for `row`."""
    facts, words, coordinators, goals = layout[0], layout[1], layout[2], layout[3]
    for k in range(keys.shape[1]):
        keys[row, k] = 0
    for k in range(facts + goals):
        bit = readings[row, layout[4 + k]] > 0.5 if k < facts else goal_enabled[row, k - facts] == 1
        if bit:
            keys[row, k // BITS_PER_WORD] |= np.int64(1) << np.int64(k % BITS_PER_WORD)
    at = (facts + goals + BITS_PER_WORD - 1) // BITS_PER_WORD
    for k in range(words):
        begin = 4 + facts + 5 * k
        value = np.int64(np.rint(readings[row, layout[begin]] * STEPS_PER_UNIT))
        value = min(max(value, layout[begin + 3]), layout[begin + 4])
        gap, grid = value - layout[begin + 1], layout[begin + 2]
        keys[row, at + k] = -(gap // grid) if grid else (1 if gap >= 0 else 0)
    begin = 4 + facts + 5 * words
    for k in range(coordinators):
        keys[row, at + words + k] = marks[row, st.ALTERNATIVE, layout[begin + k]]


@inlined
def recall(row: int, keys: Ints, entries: Ints, plan: Ints, plan_marks: Ints) -> bool:
    """Give `row` the plan remembered for keys[row] (K,); False if there is none."""
    mask = entries.shape[0] - 1
    slot = hashed(keys[row]) & mask
    while entries[slot, 0]:
        same = True
        for k in range(keys.shape[1]):
            same = same and entries[slot, 2 + MAX_PLAN + k] == keys[row, k]
        if same:
            length = entries[slot, 1]
            plan_marks[row, KNOWN] = 1 if length >= 0 else 0
            plan_marks[row, INDEX] = 0
            plan_marks[row, LENGTH] = max(length, 0)
            for k in range(length):
                plan[row, k] = entries[slot, 2 + k]
            return True
        slot = (slot + 1) & mask
    return False
