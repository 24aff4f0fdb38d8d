"""Programs of robots without a world."""

import numpy as np

from selforg.commands import Commands
from selforg.program import Program, Rows


class Alone:
    """Robots that sense, decide and act in a program of their own."""

    def __init__(self, robots, guarantee=False):
        count = robots.network.rows
        self.rows, self.commands = Rows.of(np.arange(count)), Commands(count, 2)
        self.program = Program(lambda: robots.steps(self.rows, self.rows, self.commands, guarantee))

    def tick(self, now, rows=None):
        chosen = np.arange(len(self.rows.listed)) if rows is None else rows
        self.rows.listed[: len(chosen)], self.rows.length[0] = chosen, len(chosen)
        self.commands.clear()
        self.program.run(now)
        return self.commands


def run(steps, now, *stages):
    """Run the steps of some stages, of all if none is given."""
    Program(lambda: [step for step in steps if not stages or step.stage in stages]).run(now)
