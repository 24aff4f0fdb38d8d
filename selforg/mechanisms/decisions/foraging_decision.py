"""Foraging: whether to explore or to exploit what is known."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Unpack

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms.base import MECHANISMS, LookOptions
from selforg.mechanisms.decisions.base import DecisionMechanism


@MECHANISMS.register
class ForagingDecision(DecisionMechanism):
    """State Exploration with a probability, else Exploitation; value: that probability.

    generators: one per row, so that the draws of a row depend on no other.
    """

    states = ("None", "Exploration", "Exploitation", "Return")
    example: ClassVar[Mapping[str, Any]] = {"probability": 1.0}  # needs no generators

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        probability: float = 0.5,
        generators: Sequence[np.random.Generator] = (),
        **options: Unpack[LookOptions],
    ) -> None:
        if not 0.0 <= probability <= 1.0:
            raise ValueError(f"ForagingDecision: probability must lie in [0, 1], got {probability!r}")
        if 0.0 < probability < 1.0 and len(generators) != buffer.poses.rows:
            raise ValueError(f"ForagingDecision: {buffer.poses.rows} generators expected, got {len(generators)}")
        super().__init__(buffer, value=probability, **options)
        self.probability = float(probability)
        self._generators = generators  # not copied: the host may give a row another one

    def _decide(self, now: float, rows: Ints, values: Floats, states: Ints, decided: Flags) -> None:
        values[:] = self.probability
        decided[:] = True  # no pose is needed
        if 0.0 < self.probability < 1.0:
            explores = np.array([self._generators[row].random() < self.probability for row in rows], dtype=np.bool_)
        else:
            explores = np.full(len(rows), self.probability == 1.0)
        states[:] = np.where(explores, self.states.index("Exploration"), self.states.index("Exploitation"))
