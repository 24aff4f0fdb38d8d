"""Registries, which find classes of one kind by name: ours, and those of plug-ins."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, Generic, TypeVar

from selforg import plugins

Base = TypeVar("Base")
Class = TypeVar("Class")
MOST_LISTED = 150
"""Letters of known names that fit a line on an unknown one."""


class UnknownNameError(KeyError):
    """Nothing is registered under a name; the text lists the known names and the most similar one."""

    def __str__(self) -> str:
        return str(self.args[0])


class Registry(Generic[Base]):
    """Subclasses of `Base` by name.

    Example:
        >>> MECHANISMS: Registry[Mechanism] = Registry("mechanism")
        >>> @MECHANISMS.register
        ... class Mine(Mechanism): ...
        >>> MECHANISMS.find("Mine")

    Args:
        kind: word for an entry in messages, such as "mechanism".
        name_of: returns the name of a class; the name of the class itself by default.
        home: package that registers our classes where the module of the registry does not; imported before others'.
        base: the class that all entries are below; None: they are functions.

    """

    def __init__(
        self,
        kind: str,
        name_of: Callable[[type[Base]], str] = lambda cls: cls.__name__,
        home: str = "",
        base: type | None = None,
    ) -> None:
        self.kind, self._base = kind, base
        self.name_of = name_of
        self._home = home
        self._classes: dict[str, type[Base]] = {}
        REGISTRIES.append(self)

    def register(self, cls: Class) -> Class:
        """Enter a class (or a function) under its name, as a decorator; ValueError if the name is taken.

        TypeError for what is none of the kind.
        """
        entry: Any = cls
        if not (callable(cls) if self._base is None else isinstance(cls, type) and issubclass(cls, self._base)):
            expected = "a function" if self._base is None else f"a class below {self._base.__name__}"
            raise TypeError(f"a {self.kind}: expected {expected}, got {cls!r:.60}")
        if self._home and plugins.is_own(cls):
            import_module(self._home)
        name = self.name_of(entry)
        if name in self._classes:
            raise ValueError(f"{self.kind} {name!r} is registered already, by {self._classes[name].__module__}")
        self._classes[name] = entry
        if isinstance(entry, type) and plugins.is_own(entry):
            plugins.guard(entry)
        return cls

    def names(self) -> tuple[str, ...]:
        """Return all registered names, also those of plug-ins, sorted."""
        plugins.load()
        return tuple(sorted(self._classes))

    def origins(self) -> dict[str, str]:
        """Return where each name comes from that a plug-in has registered; see `plugins.origin_of`."""
        return {
            name: plugins.origin_of(self._classes[name].__module__)
            for name in self.names()
            if plugins.is_own(self._classes[name])
        }

    def find(self, name: str) -> type[Base]:
        """Return the class registered under `name`; UnknownNameError lists the known names."""
        if name not in self:
            raise UnknownNameError(self.unknown(name))
        return self._classes[name]

    def unknown(self, name: str) -> str:
        """Return the message for a name under which nothing is registered."""
        return f"{unknown(self.kind, name, self.names())}; a {self.kind} of your own: --import MODULE or FILE.py"

    def __contains__(self, name: object) -> bool:
        if name not in self._classes:
            plugins.load()
        return name in self._classes

    def __iter__(self) -> Iterator[type[Base]]:
        """Iterate over the classes, in the order of their names."""
        return (self._classes[name] for name in self.names())


REGISTRIES: list[Registry[Any]] = []
"""All registries of the modules that have been imported."""


def import_modules(package: str) -> None:
    """Import every module of a package to register the classes in them; the `__init__` of the package calls this."""
    for module in iter_modules(sys.modules[package].__path__, f"{package}."):
        import_module(module.name)


def unknown(what: str, name: str, known: Sequence[str]) -> str:
    """Return the message for an unknown `name`, with the known names that fit and the most similar one."""
    near, listed = difflib.get_close_matches(name, known, n=1), ", ".join(known) or "none"
    if len(listed) > MOST_LISTED:
        listed = listed[:MOST_LISTED].rpartition(", ")[0]
        listed += f" and {len(known) - listed.count(', ') - 1} more"
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return f"unknown {what} {name!r:.60} (known: {listed}{hint})"
