"""Ctrl-C and other signals that end a command."""

import signal
import sys
import time
from types import FrameType

from train.running import ENDING

WINDING_UP = 10.0
"""Seconds for which a command that is ending ignores further signals, so that nothing is left behind."""
AGAIN = 0.05
"""Seconds after which a signal that had to wait is tried again."""
TIMED = hasattr(signal, "setitimer")
"""Whether the system can try it again."""


class Interruption:
    """Raises KeyboardInterrupt at a signal, unless another one came less than `WINDING_UP` before.

    While a module is imported, LLVM compiles or pydantic reads, a signal waits: an exception is lost there, becomes
    another, or leaves memory broken. Where native code drops the exception, it comes again. Signals that the program
    was told to ignore (nohup) stay ignored.
    """

    def __init__(self) -> None:
        found = (getattr(signal, name) for name in ENDING if hasattr(signal, name))
        self._before = {number: signal.getsignal(number) for number in found}
        self._latest = float("-inf")

    def __enter__(self) -> None:
        for number, before in self._before.items():
            if before is not signal.SIG_IGN:
                signal.signal(number, self._end)
        sys.unraisablehook = self._dropped

    def __exit__(self, *_: object) -> None:
        sys.unraisablehook = sys.__unraisablehook__
        if TIMED:
            signal.setitimer(signal.ITIMER_REAL, 0.0)  # SIGALRM would kill a process whose handlers are gone
        if self._latest == float("-inf"):
            for number, before in self._before.items():
                signal.signal(number, before)
            return
        for number in self._before:  # the program is about to end
            signal.signal(number, signal.SIG_IGN)
        # else CPython kills itself by SIGINT where a KeyboardInterrupt passed any evaluated text, as of imports
        eval("0")

    def _end(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if now - self._latest < WINDING_UP:
            return
        if _has_to_wait(frame) and TIMED:
            self._try_again()
            return
        self._latest = now
        raise KeyboardInterrupt

    def _try_again(self) -> None:
        signal.signal(signal.SIGALRM, self._end)
        signal.setitimer(signal.ITIMER_REAL, AGAIN)

    def _dropped(self, what: "sys.UnraisableHookArgs") -> None:
        if what.exc_type is KeyboardInterrupt and TIMED:
            self._latest = float("-inf")
            self._try_again()
        else:
            sys.__unraisablehook__(what)


def _has_to_wait(frame: FrameType | None) -> bool:
    """Return whether an import, LLVM or pydantic is at work below a frame."""
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith(("importlib.", "llvmlite", "pydantic.")):
            return True
        frame = frame.f_back
    return False
