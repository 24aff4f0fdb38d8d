"""Numbers on the command lines of examples, whose mistakes are one line each."""

import argparse
from collections.abc import Callable


def words_of(program: str, description: str) -> argparse.ArgumentParser:
    """Return a parser that says what is wrong in one line."""
    return argparse.ArgumentParser(program, usage=argparse.SUPPRESS, description=description)


def number(low: float, high: float, kind: type[float] | type[int] = float) -> Callable[[str], float]:
    """Return what reads a number from `low` to `high`, for `type=` of an argument.

    >>> number(0.0, 1.0)("0.3")
    0.3
    """

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            what = "a whole number" if kind is int else "a number"
            raise argparse.ArgumentTypeError(f"expected {what} from {low:g} to {high:g}, got {text!r}")
        return value

    return read
