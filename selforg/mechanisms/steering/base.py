"""The blueprint of steering mechanisms, which change what a movement commands."""

from abc import abstractmethod
from typing import Unpack

from selforg.arrays import Ints
from selforg.commands import Commanded
from selforg.compiler.records import Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.options import LookOptions


class SteeringMechanism(Mechanism):
    """Blueprint of a mechanism that changes the commands of robots in the plane.

    It looks at the poses of the team: those whose gradients reach within `view_distance` [m] of the robot, as far as
    the robot received them; some also look at gradients of the buffer. Subclasses implement `steer`.

    Example:
        >>> mechanism = PredictiveSteering(poses, view_distance=1.0)
        >>> mechanism.steer(0.2, np.array([0, 3]), commands.packed.words)

    """

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[LookOptions]) -> None:
        super().__init__(buffer, **options)
        if self.poses.space.dim != 2:
            raise ValueError(f"{type(self).__name__}: expected a space of 2 dimensions, got {self.poses.space.dim}")

    @abstractmethod
    def steer(self, now: float, rows: Ints, commands: Words[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]; rows without a command stay without one."""

    def reset(self, rows: Ints) -> None:
        """Forget what `rows` (K,) did; most mechanisms remember nothing."""
