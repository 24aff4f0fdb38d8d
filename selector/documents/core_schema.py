"""Plain scalars of YAML by the core schema of YAML 1.2.2, section 10.3.2: `Off` is text, `1e-9` a number.

Only PyYAML's parser is used, whose events are checked one by one. Its constructors know YAML 1.1, recurse, and answer
odd values with exceptions of many kinds.
"""

import math
import re

NULL = re.compile(r"~|null|Null|NULL|")
TRUTH = re.compile(r"true|True|TRUE|false|False|FALSE")
WHOLE = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
MOST_DIGITS = 40
"""Digits of a whole number; no field of a document holds a longer one."""

Scalar = str | int | float | bool | None


def value_of(text: str) -> Scalar:
    """Return the value of a plain scalar; ValueError for a number that cannot be used."""
    if NULL.fullmatch(text):
        return None
    if TRUTH.fullmatch(text):
        return text.lower() == "true"
    if WHOLE.fullmatch(text):
        if len(text) > MOST_DIGITS:
            raise ValueError(f"expected a whole number of at most {MOST_DIGITS} digits, got {len(text)} of them")
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if REAL.fullmatch(text):
        return _real(text)
    return text


def _real(text: str) -> float:
    number = float(text.replace(".", "", 1) if text[-1].isalpha() else text)
    if math.isnan(number) or (math.isinf(number) and not text[-1].isalpha()):
        raise ValueError(f"expected a number, got {text[:MOST_DIGITS]}")
    return number
