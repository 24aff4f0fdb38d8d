"""The command line `clean-swarm`; heavy libraries are imported by the commands that need them."""

import sys


def main() -> None:
    """Run the command line and exit with its code; Ctrl-C during the imports is as quiet as later."""
    try:
        from train.cli import app
    except KeyboardInterrupt:
        sys.exit(130)
    app.run_app()
