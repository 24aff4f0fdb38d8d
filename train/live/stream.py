"""The stream of a session: blocks of its recording, for any number of readers, each at its own pace."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any


class Stream:
    """Blocks that one writer appends and readers fetch; a slow or sleeping reader delays no other.

    Attributes:
        state: how the session runs, plain data.

    """

    def __init__(self, beginning: bytes, state: Mapping[str, Any]) -> None:
        self._blocks = [beginning]
        self.state = state
        self._changed = threading.Condition()
        self.ended = False

    def add(self, block: bytes) -> None:
        """Append a block."""
        with self._changed:
            self._blocks.append(block)
            self._changed.notify_all()

    def tell(self, state: Mapping[str, Any]) -> None:
        """Replace the state."""
        with self._changed:
            self.state = state
            self._changed.notify_all()

    def end(self) -> None:
        """Tell all readers that nothing more comes."""
        with self._changed:
            self.ended = True
            self._changed.notify_all()

    def after(self, read: int, state: Mapping[str, Any] | None, seconds: float) -> list[bytes]:
        """Return the blocks after the first `read` ones; wait up to `seconds` for a new block or another state."""
        with self._changed:
            self._changed.wait_for(
                lambda: len(self._blocks) > read or self.state is not state or self.ended, timeout=seconds
            )
            return self._blocks[read:]
