"""Exit codes of the command line."""

FINISHED = 0
FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130
"""Code of a program that Ctrl-C ended."""
