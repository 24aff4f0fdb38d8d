"""Text from outside, made fit to print: short, on one line, without control characters."""

import os
import reprlib
from collections.abc import Collection
from pathlib import Path

from selforg.registry import unknown

MOST_SHOWN = 60
"""Characters of a given value that an error shows."""
MOST_PRINTED = 1500
"""Characters of a whole error."""


class _Short(reprlib.Repr):
    """Shows the beginning of a value, without ever building the text of the whole: aliases may make it endless."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = self.maxother = MOST_SHOWN

    def repr_int(self, x: int, level: int) -> str:
        """Return a whole number, or its size: Python writes no number of thousands of digits."""
        return super().repr_int(x, level) if x.bit_length() <= 256 else f"a whole number of {x.bit_length()} bits"


_SHORT = _Short()


def short(value: object) -> str:
    """Return how Python writes a value, cut at `MOST_SHOWN` characters."""
    text = _SHORT.repr(value)
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}..."


def plain(text: str, most: int = MOST_PRINTED) -> str:
    """Return `text` on one line, cut in its middle at `most` characters, with escapes for what cannot be printed."""
    half = most // 2
    cut = text if len(text) <= most else f"{text[:half]} ... {text[-half:]}"
    return "".join(c if c.isprintable() else " " if c == "\n" else ascii(c)[1:-1] for c in cut)


def shown(path: Path) -> str:
    """Return `path` as a user in the working directory would write it."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative


class DocumentError(ValueError):
    """A file, a key or a name cannot be used; the message is one line of plain text, whatever it quotes."""

    def __init__(self, message: str) -> None:
        super().__init__(plain(message))


def must_fit(fits: bool, where: str, expected: str, got: object) -> None:
    """Raise DocumentError unless what was given `fits`; `got`: the text that says it, or the value itself."""
    if not fits:
        raise DocumentError(f"{where}: expected {expected}, got {got if isinstance(got, str) else short(got)}")


def must_know(what: str, name: str, known: Collection[str], where: str = "", hint: str = "") -> None:
    """Raise DocumentError for a name that is not among the `known`; it begins with `where`, and the `hint` ends it."""
    if name not in known:
        raise DocumentError(f"{where}: " * bool(where) + unknown(what, name, tuple(known)) + hint)
