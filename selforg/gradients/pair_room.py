"""Room for the pairs that rows see."""

import numpy as np

from selforg.arrays import Floats, Ints
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
        self._looked: tuple[tuple[str, ...], int] = (), -1  # the channels, and how many the buffer knew then
        self.pairs: Floats = np.empty((pairs, PAIR_COLUMNS))
        self._packed: Packed[Sight] = SIGHT.pack(Sight(np.zeros(1, dtype=np.int64), self.pairs))

    def sight(self, now: float, channels: tuple[str, ...]) -> Words[Sight]:
        """Return the table and `channels` (none: all) for a look at `now` [s], as compiled code takes them."""
        buffer = self._buffer
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        look = channels, len(buffer.channels)
        if look != self._looked:
            self._looked, self._packed = look, SIGHT.pack(Sight(self._codes(channels), self.pairs))
        return self._packed.words

    def _codes(self, channels: tuple[str, ...]) -> Ints:
        """Return 1 if the shared poses are looked at, then the codes of `channels` (none: all).

        Channels are in the order of their names, because the order in which other teams used them first must not
        change a sum.
        """
        buffer, known, names = self._buffer, self._buffer.channels, sorted(set(channels))
        poses = buffer.shared and (not names or buffer.poses.channel in names)
        codes = [known.code(name) for name in names or known.names() if name in known]
        return np.array([int(poses), *codes], dtype=np.int64)

    def double(self) -> Words[Sight]:
        """Return the last sight with room for twice as many pairs; those that are there stay."""
        self.pairs = np.concatenate([self.pairs, np.empty_like(self.pairs)])
        self._packed = SIGHT.pack(Sight(self._packed.record.channels, self.pairs))
        return self._packed.words
