"""The blueprint of an observation term, and the registry in which all terms stand."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal

from clean_swarm_env.learning.observation.around import Around
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.compiler.records import Packed
from selforg.registry import Registry

Need = Literal["stations", "neighbours"]


@dataclass(frozen=True)
class Observed:
    """What terms look at.

    Attributes:
        worlds: the batch of worlds.
        progress: what happened in the last period.
        around: what is around the robots, brought up to date before terms are written. NumPy code reads
            `around.record`, kernels take `around.words`.

    """

    worlds: Worlds
    progress: MissionProgress
    around: Packed[Around]


class Term(ABC):
    """A named group of components of an observation, each within [-1, 1].

    A subclass is registered by a decorator and says here, and nowhere else, how the term is called, what its components
    are, which settings it takes and how it is computed. Its docstring says what the components mean and by what they
    are divided.

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

        ObservationConfig(terms=["cargo", {"name": "eastness", "factor": 0.5}])

    Keyword-only parameters of the constructor are the settings: those that `ObservationConfig` has (such as
    `neighbour_ranges`) come from there, others are given, or left out, beside the name of the term.

    Attributes:
        name: of the term.
        components: names of the components; the class or the constructor sets them.
        needs: searches whose results the term reads, see `Around`.
        observed: what the term looks at.

    """

    name: ClassVar[str]
    needs: ClassVar[tuple[Need, ...]] = ()
    components: tuple[str, ...] = ()

    def __init__(self, observed: Observed) -> None:
        self.observed = observed

    @abstractmethod
    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components of `rows` (P,) into the columns `rows` of `out` (components, R), which holds zeros.

        Rows are those of robots that are present, in rising order. What is written for other rows does not count.
        """

    @classmethod
    def meaning(cls) -> str:
        """Return what the components mean."""
        return " ".join((cls.__doc__ or "").split())

    @classmethod
    def settings(cls) -> dict[str, bool]:
        """Return the names of the settings, and whether each can be left out."""
        parameters = inspect.signature(cls).parameters.values()
        return {p.name: p.default is not p.empty for p in parameters if p.kind is p.KEYWORD_ONLY}


TERMS: Registry[Term] = Registry("observation term", lambda term: term.name)
