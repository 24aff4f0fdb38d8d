"""Runs: tasks in processes, trials in batches of worlds, and directories of results."""

WITH_PARENT = "CLEAN_SWARM_WITH_PARENT"
"""Environment variable: the command ends when its standard input does, which a parent holds open, also when killed."""
