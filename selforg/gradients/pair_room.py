"""Room for the pairs that rows see."""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.records import Packed, Words
from selforg.gradients.store.columns import PAIR_COLUMNS
from selforg.gradients.store.records import SIGHT, Sight


class PairRoom:
    """A table of pairs that grows, and the channels at which rows look, as one record.

    Attributes:
        pairs: (P, PAIR_COLUMNS) float64.

    """

    def __init__(self, pairs: int = 256) -> None:
        self.pairs: Floats = np.empty((pairs, PAIR_COLUMNS))
        self._packed: Packed[Sight] = SIGHT.pack(Sight(np.zeros(1, dtype=np.int64), self.pairs))

    def on(self, channels: Ints) -> Words[Sight]:
        """Return the words of the record for `channels` (C + 1,), see `SoBuffer.channel_table`."""
        record = self._packed.record
        if record.channels is not channels or record.pairs is not self.pairs:
            self._packed = SIGHT.pack(Sight(channels, self.pairs))
        return self._packed.words

    def double(self) -> None:
        """Make room for twice as many pairs; those that are there stay."""
        self.pairs = np.concatenate([self.pairs, np.empty_like(self.pairs)])
