"""Running a command of the examples within the test."""

import sys


def ended(main, words, capsys, monkeypatch):
    """Return the exit code of a `main` that reads the command line `words`, and what it says."""
    monkeypatch.setattr(sys, "argv", words)
    try:
        code = main()
    except SystemExit as end:
        code = end.code
    return code, capsys.readouterr()
