"""Documents in which one value differs."""

import copy
from typing import Any


def changed(whole: dict[str, Any], *path: str | int, to: object) -> dict[str, Any]:
    """Return a copy of a document with another value at a path, or, for None, without it."""
    made = copy.deepcopy(whole)
    part: Any = made
    for key in path[:-1]:
        part = part[key]
    if to is None:
        del part[path[-1]]
    else:
        part[path[-1]] = copy.deepcopy(to)
    return made
