"""What decisions brought, as plain sums: the border between a strategy and a store of knowledge."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Gains:
    """Sums over rewards, one entry for each option and context that occurred, ordered by both.

    Attributes:
        option: (K,) number of the option.
        context: (K,) key of the context, "" where the strategy makes no difference.
        count: (K,) number of rewards.
        total: (K,) their sum.
        squares: (K,) the sum of their squares.

    """

    option: Ints
    context: tuple[str, ...]
    count: Ints
    total: Floats
    squares: Floats


class Experience:
    """Collects the rewards of `options` options until they are taken, say at the end of an episode."""

    def __init__(self, options: int) -> None:
        self._options = options
        self._sums: dict[str, Floats] = {}  # context -> (3, O) count, total and squares

    def add(self, option: Ints, reward: Floats, context: Sequence[str] = ()) -> None:
        """Add the `reward` (K,) of `option` (K,) in contexts of the keys (K,); all "" unless given."""
        if not context:
            self._add("", option, reward)
            return
        keys = np.array(context)
        for key in np.unique(keys):
            chosen = keys == key
            self._add(str(key), option[chosen], reward[chosen])

    def take(self) -> Gains:
        """Return what was collected and begin anew."""
        entries = [
            (option, context, sums[:, option])
            for context, sums in sorted(self._sums.items())
            for option in np.flatnonzero(sums[0])
        ]
        self._sums = {}
        sums = np.array([entry[2] for entry in entries]).reshape(-1, 3)
        return Gains(
            np.array([entry[0] for entry in entries], dtype=np.int64),
            tuple(entry[1] for entry in entries),
            sums[:, 0].astype(np.int64),
            sums[:, 1],
            sums[:, 2],
        )

    def _add(self, context: str, option: Ints, reward: Floats) -> None:
        weights = (None, reward, reward * reward)
        collected = self._sums.setdefault(context, np.zeros((3, self._options)))
        for sums, weight in zip(collected, weights, strict=True):
            sums += np.bincount(option, weight, self._options)
