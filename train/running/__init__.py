"""Runs: tasks in processes, trials in batches of worlds, and directories of results."""

ENDING = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that end a command as Ctrl-C does; not every system has all."""
