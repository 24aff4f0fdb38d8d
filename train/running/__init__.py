"""Runs: tasks in processes, trials in batches of worlds, and the directories that keep the results."""
