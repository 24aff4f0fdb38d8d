"""The command line `clean-swarm`; heavy libraries are imported by the commands that need them."""

import sys

from train.cli.interruption import Interruption


def main() -> None:
    """Run the command line and exit with its code; Ctrl-C during the imports is like later."""
    with Interruption():
        try:
            from train.cli import app

            app.run_app()
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            sys.exit(130)
