"""Finding what classes declare about arrays by the marks of `selforg.arrays` (KEPT, OUTSIDE, ...), in one walk."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Iterator
from types import FunctionType, MethodType, ModuleType, UnionType
from typing import Annotated, Any, NamedTuple, Protocol, get_args, get_origin, get_type_hints, runtime_checkable

import numpy as np

from selforg.arrays import OUTSIDE, READ, Mark, Within, scalar_of
from selforg.compiler.records import Packed

ATOMS = (type, ModuleType, FunctionType, MethodType, str, bytes, bool, int, float, complex, type(None), np.generic)


KNOWN: dict[type, dict[str, Declaration]] = {}


class Declaration(NamedTuple):
    """A declared field of a class."""

    hint: Any
    """Type of the array or list."""
    axes: tuple[str, ...]
    mark: Mark
    bounds: Within | None


@runtime_checkable
class Shared(Protocol):
    """What keeps something for each world in no array or list of its own, as a buffer does."""

    def part_of(self, world: int) -> Any:  # noqa: ANN401  (whatever the class keeps)
        """Return the kept state of a world, which does not change when the world runs."""

    def put_part(self, world: int, part: Any, later: float) -> None:  # noqa: ANN401
        """Replace the kept state of a world by the result of `part_of`, `later` [s] after it."""


class Found(NamedTuple):
    """Something that is kept or derived below an object."""

    owner: Any
    """The object that has it as attribute `name`, or a `Shared` itself."""
    name: str
    field: Declaration | None
    """Its declaration, none of a `Shared`."""
    limit: int
    """Bound of the indices in it, if the field has bounds."""


def fields_of(kind: type) -> dict[str, Declaration]:
    """Return the fields that a class and its bases declare with a mark, by name.

    >>> from selforg.arrays import KEPT, Floats
    >>> class Flock:
    ...     places: Annotated[Floats, "W sheep 2", KEPT]
    >>> fields_of(Flock)["places"].axes
    ('W', 'sheep', '2')

    """
    if kind in KNOWN:
        return KNOWN[kind]
    found = KNOWN[kind] = {}
    texts = [repr(inspect.get_annotations(base)) for base in kind.__mro__]
    hints = get_type_hints(kind, include_extras=True) if any("Annotated[" in text for text in texts) else {}
    for name, hint in hints.items():
        given = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
        mark = next((one for one in given if isinstance(one, Mark)), None)
        if mark is not None:
            axes = next((tuple(one.split()) for one in given if isinstance(one, str)), ())
            bounds = next((one for one in given if isinstance(one, Within)), None)
            found[name] = Declaration(get_args(hint)[0], axes, mark, bounds)
    return found


def make_arrays(owner: Any, **sizes: int) -> None:  # noqa: ANN401
    """Give an object all arrays that its class declares, as zeros of `sizes` by letter.

    Left out are lists, arrays that may be None, and what is READ or OUTSIDE.

    >>> from selforg.arrays import KEPT, Floats
    >>> class Flock:
    ...     places: Annotated[Floats, "W sheep 2", KEPT]
    >>> flock = Flock()
    >>> make_arrays(flock, W=4, sheep=12)
    >>> flock.places.shape
    (4, 12, 2)

    """
    for name, array in arrays_of(type(owner), **sizes).items():
        setattr(owner, name, array)  # `vars` would make each look at the object slower from then on


def arrays_of(kind: type, **sizes: int) -> dict[str, Any]:
    """Return all arrays that a class or a record declares, by name, as `make_arrays` makes them."""
    return {
        name: np.zeros([int(axis) if axis.isdecimal() else sizes[axis] for axis in field.axes], scalar_of(field.hint))
        for name, field in fields_of(kind).items()
        if field.mark not in (READ, OUTSIDE) and get_origin(field.hint) not in (list, UnionType)
    }


class Declared(NamedTuple):
    """All that is declared below an object."""

    kept: dict[str, Found]
    """What is kept or derived, by its path: each array once, where it is first declared so."""
    forgotten: list[str]
    """Paths of arrays and random generators that no class declares."""


def walk(root: object) -> Declared:
    """Find all that is kept below an object, in attributes, records, lists and dictionaries, however deep."""
    kept: dict[str, Found] = {}
    loose: dict[str, tuple[Any, Any]] = {}  # with what holds them
    known: dict[int, Any] = {}  # declared arrays and lists, held so that no other gets their ids
    kept_ids: set[int] = set()
    seen: dict[int, Any] = {}
    waiting: deque[tuple[str, Any, Any]] = deque([("", root, None)])
    while waiting:
        path, thing, holder = waiting.popleft()
        if isinstance(thing, ATOMS) or id(thing) in seen:
            continue
        seen[id(thing)] = thing
        if isinstance(thing, np.ndarray | np.random.Generator):
            loose[path] = thing, holder
            continue
        if isinstance(thing, Shared):
            kept[path] = Found(thing, "", None, 0)
            continue
        owner = thing.record if isinstance(thing, Packed) else thing
        for name, value, field in parts_of(owner):
            inside = f"{path}.{name}".lstrip(".")
            if field is None:
                waiting.append((inside, value, thing))
            elif value is not None:
                known[id(value)] = value
                if field.mark.name in {"kept", "clocked", "derived"} and id(value) not in kept_ids:
                    kept_ids.add(id(value))
                    kept[inside] = Found(owner, name, field, limit_of(owner, field))
    return Declared(kept, [p for p, one in loose.items() if not any(is_known(part, known) for part in one)])


def parts_of(thing: Any) -> Iterator[tuple[str, Any, Declaration | None]]:  # noqa: ANN401
    """Yield name, value and declaration of each part of an object."""
    if isinstance(thing, dict):
        yield from ((str(name), value, None) for name, value in thing.items())
    elif isinstance(thing, list | tuple | set | frozenset) and not hasattr(thing, "_fields"):
        yield from ((str(number), value, None) for number, value in enumerate(thing))
    elif hasattr(thing, "_fields") or hasattr(thing, "__dict__"):
        fields = fields_of(type(thing))
        values = thing._asdict() if hasattr(thing, "_fields") else vars(thing)
        yield from ((name, value, fields.get(name)) for name, value in values.items())


def is_known(thing: Any, known: dict[int, Any]) -> bool:  # noqa: ANN401
    """Return whether something is declared, or is an array that is a part of one that is, or empty or constant."""
    while isinstance(thing, np.ndarray):
        if id(thing) in known or not thing.size or not thing.flags.writeable:
            return True
        thing = thing.base
    return id(thing) in known


def limit_of(owner: Any, field: Declaration) -> int:  # noqa: ANN401
    """Return the length of the axis that bounds the indices in a field of an object."""
    if field.bounds is None:
        return 0
    fields = fields_of(type(owner)).items()
    return next(
        int(getattr(owner, name).shape[other.axes.index(field.bounds.axis)])
        for name, other in fields
        if field.bounds.axis in other.axes
    )
