"""Sums of the rewards of an episode, made before the store is updated."""

from collections.abc import Mapping, Sequence

import numpy as np

from selector.store.exact_sums import NO_REWARDS, Moments, on_grid, sums_by_cell
from selforg.arrays import Floats, Ints
from selforg.registry import unknown


class RewardSums:
    """Exact sums of the rewards of one goal, for each option and context.

    The memory needed depends on the number of options and contexts, not on the number of rewards.

    >>> batch = RewardSums("AvoidCollision", ["near", "far"])
    >>> batch.record(np.array([0, 1, 1]), np.array([0.5, 1.0, 2.0]))
    >>> batch.moments["far", ""].mean
    1.5

    Args:
        goal: the goal that the options serve.
        options: (O,) names of the options, in the order in which a strategy numbers them.

    """

    def __init__(self, goal: str, options: Sequence[str]) -> None:
        self.goal = goal
        self.options = tuple(options)
        self._moments: dict[tuple[str, str], Moments] = {}

    @property
    def moments(self) -> Mapping[tuple[str, str], Moments]:
        """Sums by option and context."""
        return self._moments

    @property
    def count(self) -> int:
        """Number of rewards recorded."""
        return sum(moments.count for moments in self._moments.values())

    def record(self, option: Ints, reward: Floats, contexts: str | Sequence[str] = "") -> None:
        """Add `reward` (R,) of `option` (R,) in `contexts`, one for all rows or (R,).

        Raises:
            ValueError: a reward is not finite or beyond a million, an option is unknown, or shapes do not fit; nothing
                is recorded then.

        """
        chosen, whole = self._checked_options(option), on_grid(reward)
        if whole.shape != chosen.shape:
            raise ValueError(f"reward: expected shape {chosen.shape}, got {whole.shape}")
        names, context = self._numbered(contexts, chosen.size)
        found = sums_by_cell(context * len(self.options) + chosen, whole, len(names) * len(self.options))
        cells = ((name, seen) for seen in names for name in self.options)
        for cell, moments in zip(cells, found, strict=True):
            if moments.count:
                self._moments[cell] = self._moments.get(cell, NO_REWARDS) + moments

    def _checked_options(self, option: Ints) -> Ints:
        chosen = np.asarray(option)
        if chosen.ndim != 1 or not (np.issubdtype(chosen.dtype, np.integer) or chosen.size == 0):
            raise ValueError(f"option: expected integers (R,), got {chosen.shape} of {chosen.dtype}")
        outside = (chosen < 0) | (chosen >= len(self.options))
        if outside.any():
            raise ValueError(unknown("option", str(chosen[outside][0]), [str(k) for k in range(len(self.options))]))
        return chosen.astype(np.int64)

    def _numbered(self, contexts: str | Sequence[str], rows: int) -> tuple[list[str], Ints]:
        """Return the different contexts (C,), and for each row (R,) the index of its context."""
        if isinstance(contexts, str):
            return [contexts], np.zeros(rows, dtype=np.int64)
        if len(contexts) != rows:
            raise ValueError(f"contexts: expected {rows} of them, one a row, got {len(contexts)}")
        numbers: dict[str, int] = {}
        context = [numbers.setdefault(name, len(numbers)) for name in contexts]
        return list(numbers), np.array(context, dtype=np.int64)
