"""A step of your own in a tick: robots forage, and tire; who has driven far is slow until it rests.

clean-swarm evaluate Tiring --import examples/tiring.py --strategy fixed --scenarios 10
"""

from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.tasks.foraging import Foraging
from clean_swarm_env.world.view import TaskView
from selforg.arrays import KEPT, Floats, Ints
from selforg.commands import Commanded, Commands, open_commanded
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.program import MOVE, Rows, Step


class Tired(NamedTuple):
    """How tired robots are."""

    worn: Annotated[Floats, "R", KEPT]  # way driven, which fades [m]


open_tired = opening(Tired)


@lean_kernel
def tire(now: float, rows: Ints, tired: Written[Tired], commands: Handle[Commanded]) -> int:
    """Slow down `rows` (K,) that have driven far; 0: nobody has to go on in Python."""
    t, given = open_tired(tired), open_commanded(commands)
    for row in rows:
        x, y = given.vectors[row, 0], given.vectors[row, 1]
        slower = 1.0 / (1.0 + 0.2 * t.worn[row])
        given.vectors[row, 0], given.vectors[row, 1] = slower * x, slower * y
        t.worn[row] = 0.98 * t.worn[row] + 0.2 * slower * np.sqrt(x * x + y * y)
    return 0


@TASKS.register
class Tiring(Foraging):
    """Robots that tire bring food; the goal is that whose options they hold."""

    goal = "Foraging"

    def __init__(self, world: TaskView) -> None:
        super().__init__(world)
        self.tired = Packed(Tired(np.zeros(world.rows)))

    def reset(self, world: int, rows: slice) -> None:
        """Let the robots of a world begin rested."""
        super().reset(world, rows)
        self.tired.record.worn[rows] = 0.0

    def steps(self, commands: Commands) -> list[Step]:
        """Return the steps of foraging, and one before the drives."""
        everyone, records = Rows.of(self.world.every_row), (self.tired, commands.packed)
        return [*super().steps(commands), Step(MOVE, tire, everyone, tire, records)]
