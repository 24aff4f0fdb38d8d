"""Command line, evaluation, training and reports; imports all other packages."""

import sys


def play(task: type) -> None:
    """Play with a task of your own in the browser, as `clean-swarm play NAME`; its file calls this with the class."""
    from train.cli import main

    sys.argv[1:1] = ["play", task.__name__]
    main()
