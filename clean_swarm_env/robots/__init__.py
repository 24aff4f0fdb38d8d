"""Robots that are not ours: one robot as a process, what it says and hears, and bodies for processes to drive."""
