"""Room for the pairs that rows see."""

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.records import Packed, Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.store.columns import PAIR_COLUMNS
from selforg.gradients.store.records import SIGHT, Sight


class PairRoom:
    """A table of pairs that grows, and the channels at which rows look, as one record.

    Attributes:
        pairs: (P, PAIR_COLUMNS) float64.

    """

    def __init__(self, buffer: SoBuffer, pairs: int = 256) -> None:
        self._buffer = buffer
        self.pairs: Floats = np.empty((pairs, PAIR_COLUMNS))
        self._packed: Packed[Sight] = SIGHT.pack(Sight(np.zeros(1, dtype=np.int64), self.pairs))

    def sight(self, now: float, channels: tuple[str, ...]) -> Words[Sight]:
        """Return the table and `channels` (none: all) for a look at `now` [s], as compiled code takes them."""
        buffer, record = self._buffer, self._packed.record
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        codes = buffer.channel_table(channels)
        if record.channels is not codes:
            self._packed = SIGHT.pack(Sight(codes, self.pairs))
        return self._packed.words

    def double(self) -> Words[Sight]:
        """Return the last sight with room for twice as many pairs; those that are there stay."""
        self.pairs = np.concatenate([self.pairs, np.empty_like(self.pairs)])
        self._packed = SIGHT.pack(Sight(self._packed.record.channels, self.pairs))
        return self._packed.words
