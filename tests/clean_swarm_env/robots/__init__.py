"""Robots as processes: the course in lock step, watchdogs, what is said and heard."""
