"""The blueprint of a mechanism that is one formula."""

from typing import ClassVar, Unpack

from selforg.arrays import Ints
from selforg.compiler.records import Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.records import Sight
from selforg.mechanisms.base import LimitedMechanism
from selforg.mechanisms.kernels.formula import UserFormula, make_walk
from selforg.mechanisms.kernels.moving import Movements
from selforg.mechanisms.kernels.rules import ALL_IN_VIEW, MovementRule
from selforg.mechanisms.options import MoveOptions


class FormulaMechanism(LimitedMechanism):
    """A movement mechanism that sums one formula of one pair; subclasses set `formula`.

    `formula` is a function of (distance, own goal radius, own reach, diffusion, goal radius [m], attraction), compiled
    with `selforg.compiler.decorators.kernel`; see `selforg.mechanisms.kernels.formula`. It must not return NaN.

    Example:
        >>> @kernel
        ... def spring(distance, own_goal, own_reach, diffusion, goal, attraction):
        ...     return distance - own_reach
        >>> @MECHANISMS.register
        ... class Spring(FormulaMechanism):
        ...     formula = spring

    """

    rule = MovementRule(combination=0, looks=ALL_IN_VIEW)
    formula: ClassVar[UserFormula]

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        min_speed: float = 0.0,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, min_speed=min_speed, max_speed=max_speed, **options)

    def _run(self, now: float, rows: Ints, places: Ints, movements: Words[Movements], sight: Words[Sight]) -> int:
        steering, poses, store = self._steering.words, self.poses.packed.words, self.buffer.table.packed.words
        return make_walk(type(self).formula)(now, rows, places, movements, sight, steering, poses, store)
