"""Motor schemas: a movement that is the weighted sum of others."""

from collections.abc import Mapping
from typing import Any, ClassVar, TypeAlias

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms.base import MECHANISMS, MovementMechanism
from selforg.mechanisms.chemotaxis import ChemotaxisBalch
from selforg.mechanisms.repulsion import RepulsionGradient

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
        for number, (one, weight) in enumerate(self._of):
            if isinstance(one, MovementMechanism):
                one.move_into(now, rows, one._vectors, one._active)
                add_movements(rows, number == 0, weight, one._vectors, one._active, vectors, active)
            else:
                add_movements(rows, number == 0, weight, one.vectors, one.active, vectors, active)


@lean_kernel
def add_movements(
    rows: Ints, first: bool, weight: float, vectors: Floats, active: Flags, sums: Floats, moves: Flags
) -> None:
    """Add the movements of `rows` (K,) times a weight to `sums` (N, D), or write them there if they are the `first`."""
    for row in rows:
        for axis in range(sums.shape[1]):
            own = weight * vectors[row, axis]
            sums[row, axis] = own if first else sums[row, axis] + own
        moves[row] = active[row] or (moves[row] and not first)
