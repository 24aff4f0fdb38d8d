"""Runs of the goals of the library in their scenes."""
