"""The base classes of observation terms, and the registry of all terms."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from clean_swarm_env.learning.observation.around import Around
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Packed
from selforg.plugins import Promises, are_numbers
from selforg.registry import Registry

Near = TypeVar("Near")


@dataclass(frozen=True)
class Observed:
    """The data that terms read.

    Attributes:
        worlds: the batch of worlds.
        progress: what happened in the last period.
        around: what is around the robots, filled before terms are written. NumPy code reads `around.record`, kernels
            take `around.handle`.

    """

    worlds: Worlds
    progress: MissionProgress
    around: Packed[Around]


class Term(ABC):
    """A named group of components of an observation, each within [-1, 1].

    A subclass declares the name of the term, its components, its settings and how they are computed. The decorator
    registers the subclass. Its docstring says what the components mean and how they are scaled.

        @TERMS.register
        class Eastness(Term):
            '''How far east on the torus the robot is, times `factor`.'''

            name = "eastness"
            components = ("eastness",)

            def __init__(self, observed: Observed, *, factor: float = 1.0) -> None:
                super().__init__(observed)
                self.factor = factor

            def write(self, rows: Ints, out: Floats) -> None:
                around = self.observed.around.record
                out[0] = self.factor * around.positions[:, 0] / around.extent[0]

        ObservationConfig(terms=["crowd", {"name": "eastness", "factor": 0.5}])

    Keyword-only parameters of the constructor are the settings. Those that `ObservationConfig` has (such as
    `neighbour_ranges`) are taken from there. The others are given beside the name of the term.

    Attributes:
        name: name of the term.
        components: names of the components; the class or the constructor sets them.
        observed: the data that the term reads.
        numbers_rows: whether it tells robots apart that are alike, by the number of their row.

    """

    promises: ClassVar[Promises] = {
        "__init__": ("names of components", lambda term, *_: all(isinstance(name, str) for name in term.components)),
        "write": ("finite numbers", lambda term, _, rows, out: are_numbers(out[:, rows], len(out), len(rows)), 0),
    }
    name: ClassVar[str]
    numbers_rows: ClassVar[bool] = False
    components: tuple[str, ...] = ()

    def __init__(self, observed: Observed) -> None:
        self.observed = observed

    @abstractmethod
    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components of `rows` (P,) into the columns `rows` of `out` (components, R), which holds zeros.

        The rows are those of robots at work, in rising order. Other columns are ignored.
        """

    @classmethod
    def meaning(cls) -> str:
        """Return the meaning of the components."""
        return " ".join((cls.__doc__ or "").split())

    @classmethod
    def settings(cls) -> dict[str, bool]:
        """Return the names of the settings, and whether each can be left out."""
        parameters = inspect.signature(cls).parameters.values()
        return {p.name: p.default is not p.empty for p in parameters if p.kind is p.KEYWORD_ONLY}


TERMS: Registry[Term] = Registry("observation term", lambda term: term.name, base=Term)


class CompiledTerm(Term):
    """A term of a group: `write_row` writes it for one robot, and one kernel writes all terms of the group."""

    group: ClassVar[TermGroup[Any]]

    @staticmethod
    @abstractmethod
    def write_row(seen: Any, row: int, out: Floats) -> None:  # noqa: ANN401  (the record of the group)
        """Write the components of a row into the first places of `out`, which holds zeros (compiled)."""

    def write(self, rows: Ints, out: Floats) -> None:
        """Do nothing: the kernel of the group has written the components already."""


class Writer(Protocol):
    """Searches what a group of terms needs, and writes these terms; made by `TermGroup.writer`."""

    def write(self, worlds: Ints, rows: Ints, seen: Floats) -> None:
        """Write the chosen terms of `rows` (P,), robots at work in `worlds` (C,), into `seen` (R, F)."""


class TermGroup(Generic[Near]):
    """Compiled terms that one kernel writes, from one record of what is around the robots.

    Attributes:
        writer: makes the writer of the terms from the data that they read, the configuration of the observation, and
            the first component (TERMS,) of each term, -1 for one that is not chosen; None: the observer is one.
        names: names of the terms, in the order in which they are written.
        write_terms: writes those that are chosen, for one row (compiled).

    """

    def __init__(self, writer: Callable[[Observed, Any, Ints], Writer] | None = None) -> None:
        self.writer = writer
        self.names: list[str] = []
        self.write_terms: Callable[[Near, Ints, int, Floats], None] = write_nothing

    def register(self, term: type[CompiledTerm]) -> type[CompiledTerm]:
        """Register a term as the next one of the group, as a decorator, before the kernel that writes the group."""
        number, before, write_row = len(self.names), self.write_terms, term.write_row

        @inlined
        def write_both(seen: Near, first: Ints, row: int, out: Floats) -> None:
            before(seen, first, row, out)
            if first[number] >= 0:
                write_row(seen, row, out[first[number] :])

        term.group, self.write_terms = self, write_both
        self.names.append(term.name)
        return TERMS.register(term)

    def term(self, name: str, *components: str) -> Callable[[Callable[[Near, int, Floats], None]], type[CompiledTerm]]:
        """Register a function as `write_row` of a term, as a decorator; its docstring is what the term means."""

        def register(write_row: Callable[[Near, int, Floats], None]) -> type[CompiledTerm]:
            members = {"name": name, "components": components, "write_row": staticmethod(inlined(write_row))}
            members |= {"__doc__": write_row.__doc__, "__module__": write_row.__module__}
            return self.register(type(write_row.__name__, (CompiledTerm,), members))

        return register


@inlined
def write_nothing(seen: Any, first: Ints, row: int, out: Floats) -> None:  # noqa: ANN401  (any record)
    """Write no component."""


AROUND_TERMS: TermGroup[Around] = TermGroup()
"""Compiled terms of all tasks, about the robot and its team."""
