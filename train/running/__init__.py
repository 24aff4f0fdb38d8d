"""Runs: tasks in processes, trials in batches of worlds, and directories of results."""
