"""The command line `clean-swarm`; heavy libraries are imported by the commands that need them."""

import os
import signal
import sys
from threading import Thread

from train.cli.interruption import Interruption
from train.running import WITH_PARENT


def main() -> None:
    """Run the command line and exit with its code; Ctrl-C during the imports is like later."""
    with Interruption():
        if os.environ.pop(WITH_PARENT, ""):
            Thread(target=_end_with_input, daemon=True).start()
        try:
            from train.cli import app

            app.run_app()
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            sys.exit(130)


def _end_with_input() -> None:
    """End this command as Ctrl-C does when its standard input ends."""
    os.read(0, 1)
    signal.raise_signal(signal.SIGTERM)
