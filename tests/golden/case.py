"""One golden case, and how expected and replayed values are compared."""

import math
from dataclasses import dataclass
from typing import Any

RELATIVE, ABSOLUTE = 1e-7, 1e-9


class SetAside(Exception):
    """Raised by a replayer for a case that a numbered deviation of docs/quirks.md covers."""

    def __init__(self, deviation: str) -> None:
        super().__init__(deviation)
        self.deviation = deviation


@dataclass(frozen=True)
class Case:
    """A case as written in a golden file, numbers and infinities read."""

    id: str
    group: str
    tag: str
    inputs: dict[str, Any]
    expected: dict[str, Any]


def read_case(entry: dict[str, Any]) -> Case:
    """Return the case of one entry of a golden file."""
    inputs, expected = read_numbers(entry["inputs"]), read_numbers(entry["expected"])
    return Case(entry["id"], entry["group"], entry.get("tag", ""), inputs, expected)


def read_numbers(value: Any) -> Any:
    """Replace "inf", "-inf" and "nan" by the numbers they stand for."""
    if isinstance(value, dict):
        return {key: read_numbers(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [read_numbers(entry) for entry in value]
    return float(value) if value in ("inf", "-inf", "nan") else value


def difference(expected: Any, actual: Any, where: str = "") -> str | None:
    """Return where and how `actual` differs from `expected`, None if it does not (tolerances as the README says)."""
    if isinstance(expected, dict) and isinstance(actual, dict):
        return differing_entries(expected, actual, where)
    if isinstance(expected, list) and isinstance(actual, (list, tuple)):
        if len(expected) != len(actual):
            return f"{where}: {len(expected)} entries expected, got {len(actual)}: {actual}"
        pairs = zip(expected, actual, strict=True)
        return next((d for i, (e, a) in enumerate(pairs) if (d := difference(e, a, f"{where}[{i}]"))), None)
    if is_number(expected) and is_number(actual):
        same = expected == actual or math.isclose(expected, actual, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
    else:
        same = bool(expected == actual) and isinstance(expected, bool) == isinstance(actual, bool)
    return None if same else f"{where}: expected {expected}, got {actual}"


def differing_entries(expected: dict[str, Any], actual: dict[str, Any], where: str) -> str | None:
    """Return the first difference between two mappings."""
    if expected.keys() != actual.keys():
        return f"{where}: keys {sorted(expected)} expected, got {sorted(actual)}"
    return next((d for key in expected if (d := difference(expected[key], actual[key], f"{where}.{key}"))), None)


def is_number(value: Any) -> bool:
    """Tell whether a value is a number, and not a truth value."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)
