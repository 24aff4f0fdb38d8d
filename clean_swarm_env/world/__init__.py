"""The cleaning world and its mission."""
