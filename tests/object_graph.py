"""All arrays that an object holds, however deep, and how they share memory: what a copy must have in the same way."""

from __future__ import annotations

import types
from bisect import bisect_right
from functools import partial

import numpy as np

ATOMS = (type, types.BuiltinFunctionType, types.ModuleType, str, bytes, int, float, complex, type(None), np.generic)


def parts_of(thing):
    """Yield (step of a path, part) for all that an object holds."""
    assert not isinstance(thing, types.FunctionType | partial), "nobody looks into what functions hold"
    if isinstance(thing, types.MethodType):
        yield ".__self__", thing.__self__
    elif isinstance(thing, dict):
        for number, (key, value) in enumerate(thing.items()):
            yield f"<key {number}>", key
            yield f"[{key!r:.40}]", value
    elif isinstance(thing, list | tuple | set | frozenset):
        names = getattr(thing, "_fields", range(len(thing)))
        yield from ((f".{name}", value) for name, value in zip(names, thing, strict=True))
    if hasattr(thing, "__dict__"):
        yield from ((f".{name}", value) for name, value in vars(thing).items())


def arrays_of(root) -> dict[str, np.ndarray]:
    """Return path -> array, each array once."""
    seen, found, waiting = {}, {}, [("", root)]
    while waiting:
        path, thing = waiting.pop()
        if id(thing) in seen or isinstance(thing, ATOMS):
            continue
        seen[id(thing)] = thing
        if isinstance(thing, np.ndarray) and thing.size:
            assert thing.dtype != object, path
            found[path] = thing
        waiting += [(path + step, part) for step, part in parts_of(thing)]
    return found


def spans_of(arrays) -> list[tuple[int, int, str]]:
    """Return (first address, address after the last, path) of each array, sorted."""
    return sorted((*np.lib.array_utils.byte_bounds(array), path) for path, array in arrays.items())


def shared_in(arrays) -> set[tuple[str, ...]]:
    """Return groups of paths whose arrays overlap in memory."""
    groups, end = [], -1
    for low, high, path in spans_of(arrays):
        if low < end:
            groups[-1].append(path)
        else:
            groups.append([path])
        end = max(end, high)
    return {tuple(sorted(group)) for group in groups}


def pointing_into(arrays, others) -> list[str]:
    """Return the paths among `arrays` that overlap with any of `others`, or hold an address in one of them."""
    spans = spans_of(others)
    lows = [low for low, _, _ in spans]

    def inside(addresses):
        found = (spans[bisect_right(lows, address) - 1] for address in addresses if address >= lows[0])
        return any(low <= address < high for address, (low, high, _) in zip(addresses, found, strict=False))

    pointing = []
    for path, array in arrays.items():
        low, high = np.lib.array_utils.byte_bounds(array)
        words = array.ravel().tolist() if array.dtype == np.int64 else []
        within = any(low < end and begin < high for begin, end, _ in spans)
        if within or inside([word for word in words if word >= lows[0]]):
            pointing.append(path)
    return pointing


ROOMS = (".handle", ".cells", ".links", ".pairs", ".origins")
"""Ends of paths: addresses, and rooms with parts that nobody has written yet. So have the tables of a buffer."""


def differing(one, other) -> list[str]:
    """Return the paths whose arrays are not equal, bit by bit."""
    first, second = arrays_of(one), arrays_of(other)
    if first.keys() != second.keys():
        return sorted(first.keys() ^ second.keys())
    return [
        path
        for path, array in first.items()
        if not path.endswith(ROOMS) and ".table.packed" not in path and array.tobytes() != second[path].tobytes()
    ]
