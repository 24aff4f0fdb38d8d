"""Sealed states: bytes that say their version and kind, their length and a checksum, and then hold a pickle.

Whatever happens to the bytes, `unsealed` notices before anything is unpickled. The checksum finds damage, not intent: a
state is a pickle, and runs what its maker wants. Load your own only
(docs/decisions/0209-sealed-states.md).
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Mapping
from typing import Any, Final

STATE_VERSION: Final = 1
SEAL: Final = 24
"""Bytes of the length and of the checksum."""


def sealed(kind: str, state: object) -> bytes:
    """Return a state of a kind ("world", "batch") as sealed bytes.

    >>> unsealed("world", sealed("world", {"ticks": 7}))
    {'ticks': 7}
    >>> unsealed("batch", sealed("world", {"ticks": 7}))
    Traceback (most recent call last):
    ValueError: state: expected b'clean-swarm state 9 batch', got b'clean-swarm state 9 world'

    """
    content = pickle.dumps(state, protocol=5)
    return b"".join((_title(kind), b"\n", _seal(content), content))


def unsealed(kind: str, state: bytes) -> Any:  # noqa: ANN401  (whatever was a state)
    """Return what `sealed` packed. ValueError for anything else: damage, another kind, another version."""
    if not isinstance(state, bytes):
        raise ValueError(f"state: expected the bytes of get_state, got {type(state).__name__}")
    title, _, rest = state.partition(b"\n")
    if title != _title(kind):
        raise ValueError(f"state: expected {_title(kind)!r}, got {title[:60]!r}")
    seal, content = rest[:SEAL], memoryview(rest)[SEAL:]
    if seal != _seal(content):
        raise ValueError(f"state: expected length and checksum {seal.hex()}, got {_seal(content).hex()}: damaged")
    return unpacked(content)


def unpacked(content: bytes | memoryview) -> Any:  # noqa: ANN401  (whatever was packed)
    """Return what was pickled. ValueError for classes of other sources."""
    try:
        return pickle.loads(content)
    except (AttributeError, ImportError, TypeError) as error:
        raise ValueError(f"state: expected one of the classes that are installed, got {error}") from error


def check_alike(expected: Mapping[str, object], got: Mapping[str, object]) -> None:
    """Raise ValueError with the first thing in which a state does not fit the object that takes it."""
    for what in (*expected, *sorted(got.keys() - expected.keys())):
        own, found = expected.get(what), got.get(what)
        if isinstance(own, tuple) and isinstance(found, tuple) and len(own) == len(found):
            own, found = next(((a, b) for a, b in zip(own, found, strict=True) if a != b), (own, found))
        if found != own:
            raise ValueError(f"state: {what}: expected {own}, got {found}")


def _title(kind: str) -> bytes:
    return f"clean-swarm state {STATE_VERSION} {kind}".encode()


def _seal(content: bytes | memoryview) -> bytes:
    return len(content).to_bytes(8, "big") + hashlib.sha256(content).digest()[:16]  # half a millisecond for 1 MB
