"""What missions tell while they run, to those who listen: how many simulated seconds their worlds have gone on."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

TELL_EVERY = 0.5
"""Least time between two times that a listener hears something [s]."""

_heard_by: list[Callable[[float], None]] = []


@contextmanager
def listening(hear: Callable[[float], None]) -> Iterator[None]:
    """Call `hear` now and then with the seconds [s] that the worlds of this process have gone on since the last call.

    What is left at the end is not told.
    """
    since, waiting = monotonic(), 0.0

    def gather(seconds: float) -> None:
        nonlocal since, waiting
        waiting += seconds
        if monotonic() - since > TELL_EVERY:
            hear(waiting)
            since, waiting = monotonic(), 0.0

    _heard_by.append(gather)
    try:
        yield
    finally:
        _heard_by.remove(gather)


def tell(seconds: float) -> None:
    """Say that worlds have gone on by so many seconds, all together [s]."""
    for gather in _heard_by:
        gather(seconds)
