"""What all tests share.

Hypothesis sets no limit of time for an example, because a loaded machine is not a fault.

A suite started with Ctrl-C or hangups ignored (`nohup`, a background job of a shell) goes on ignoring them. The
commands that its tests start do not: a signal with a handler here has its default in a program started from here.
"""

import signal

from hypothesis import settings

settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")


def ignore(*_: object) -> None:
    """Handle a signal by doing nothing."""


for name in ("SIGINT", "SIGHUP"):
    number = getattr(signal, name, None)  # not every system has all
    if number is not None and signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, ignore)
