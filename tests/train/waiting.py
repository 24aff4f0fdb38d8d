"""Waiting for what is shown, with a wide bound: the machine may be busy."""

import time
from collections.abc import Callable


def until(what: Callable[[], object], seconds: float = 240.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, f"not so within {seconds} s"
        time.sleep(0.02)
