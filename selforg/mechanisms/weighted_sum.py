"""Motor schemas: a movement that is the weighted sum of others."""

from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple, TypeAlias

from selforg.arrays import Flags, Floats, Ints
from selforg.commands import Moved, open_moved
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms.base import MECHANISMS, MovementMechanism
from selforg.mechanisms.chemotaxis import ChemotaxisBalch
from selforg.mechanisms.repulsion import RepulsionGradient
from selforg.program import ACT, Program, Rows, Step


class Summand(NamedTuple):
    """What a movement is in a sum."""

    is_first: int  # 1: the sum begins with it
    weight: float


open_summand = opening(Summand)

MovementWeights: TypeAlias = Mapping[Any, float]
"""Weights of movement mechanisms, or of their sources; a document gives their names."""


@MECHANISMS.register
class WeightedSum(MovementMechanism):
    """The weighted sum of the movements of other mechanisms, as the motor schemas of Arkin (1989).

    doi:10.1177/027836498900800406. A robot moves where one of them moves it; a negative weight turns a movement round.

    Args:
        buffer: the buffer that one of the mechanisms reads.
        of: mechanism -> its weight [-]. Sources in place of mechanisms are asked by whoever asks all sources once.

    Attributes:
        parts: the sources, each after those that it reads itself.

    """

    example: ClassVar[Mapping[str, Any]] = {
        "of": lambda buffer: {RepulsionGradient(buffer): 0.5, ChemotaxisBalch(buffer): -2.0}
    }

    def __init__(self, buffer: SoBuffer, *, of: MovementWeights) -> None:
        if not of:
            raise ValueError("of: expected the weights of one or more movement mechanisms, got none")
        mechanisms = [one if isinstance(one, MovementMechanism) else one.mechanism for one in of]
        super().__init__(buffer, view_distance=max(one.view_distance for one in mechanisms))
        self._of = [(one, float(weight)) for one, weight in of.items()]
        sources = [one for one in of if not isinstance(one, MovementMechanism)]
        self.parts = [part for source in sources for part in (*source.parts, source)]

    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Add up the movements of `rows` (K,), those of sources as they have answered."""
        moved = Packed(Moved(vectors, active))
        Program(lambda: self.moving(ACT, Rows.of(rows), moved)).run(now)

    def moving(self, stage: int, rows: Rows, moved: Packed[Moved]) -> list[Step]:
        """Return the steps that ask mechanisms, and add up all movements."""
        if type(self).move_into is not WeightedSum.move_into:
            return super().moving(stage, rows, moved)
        steps = []
        for number, (one, weight) in enumerate(self._of):
            if isinstance(one, MovementMechanism):
                own = Packed(Moved(one._vectors, one._active))
                steps += one.moving(stage, rows, own)
            else:
                own = one.moved
            records = own, Packed(Summand(int(number == 0), weight)), moved
            steps.append(Step(stage, add_movements, rows, add_movements, records))
        return steps


@lean_kernel
def add_movements(now: float, rows: Ints, moved: Handle[Moved], summand: Handle[Summand], sums: Handle[Moved]) -> int:
    """Add the movements of `rows` (K,) times a weight to their sums; a step, see `selforg.program`."""
    given, total, own = open_moved(moved), open_moved(sums), open_summand(summand)
    for row in rows:
        for axis in range(total.vectors.shape[1]):
            weighed = own.weight * given.vectors[row, axis]
            total.vectors[row, axis] = weighed if own.is_first else total.vectors[row, axis] + weighed
        total.active[row] = given.active[row] or (total.active[row] and not own.is_first)
    return 0
