"""The registry: a mechanism's class name is the name by which configurations find it."""

from typing import Any, TypeVar

from selforg.mechanisms.base import Mechanism

Class = TypeVar("Class", bound=type[Mechanism])

_known: dict[str, type[Mechanism]] = {}


def register(cls: Class) -> Class:
    """Enter a mechanism class under its name; a name that is taken raises ValueError."""
    if cls.__name__ in _known:
        raise ValueError(f"mechanism {cls.__name__!r} is registered already, by {_known[cls.__name__].__module__}")
    _known[cls.__name__] = cls
    return cls


def names() -> tuple[str, ...]:
    """Return the names of all registered mechanisms, sorted."""
    return tuple(sorted(_known))


def find(name: str) -> type[Mechanism]:
    """Return the class registered under `name`; an unknown name raises KeyError and lists the known ones."""
    if name not in _known:
        raise KeyError(f"unknown mechanism {name!r}; known: {', '.join(names())}")
    return _known[name]


def create(name: str, *arguments: object, **parameters: object) -> Any:  # noqa: ANN401  (any class, by name)
    """Return a new mechanism by name; arguments and parameters are those of its class."""
    factory: Any = find(name)
    return factory(*arguments, **parameters)
