"""A tick as a program: a list of steps, of which compiled code runs all in a row that need no Python.

A kernel that is a step takes `(now, rows, *handles)` and returns 0, or another number if Python has to go on with it.
What changes from tick to tick are the lists of rows, which steps write for later ones. The list of steps never changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import attrgetter
from typing import Annotated, Any, Final, NamedTuple

import numpy as np

from selforg.arrays import SCRATCH, Floats, Ints
from selforg.compiler.records import Packed
from selforg.compiler.steps import STEP_COLUMNS, repeat_steps, words_of_step
from selforg.compiler.switches import BY_ADDRESS

(
    COMING,
    STARTING,
    BEGINNING,
    SENSE,
    DECIDE,
    AFTER_DECIDING,
    COMMANDING,
    ACT,
    STEER,
    AFTER_ACTING,
    LEAVE,
    AFTER_LEAVING,
    LEAD,
    FOLLOW,
    MOVE,
    AFTER_MOVING,
    TELLING,
    COUNTING,
    FINISHING,
) = range(19)
"""Stages of a tick in their order; what they are for is in ARCHITECTURE.md."""
STOP: Final = "stop"
"""What the last step of a program returns, in Python, to have it not repeated any more."""


class Rows(NamedTuple):
    """Rows that steps are run for, the first ones of a list that compiled code may write."""

    listed: Annotated[Ints, "R", SCRATCH]
    length: Annotated[Ints, "1", SCRATCH]

    @classmethod
    def of(cls, rows: Ints) -> Rows:
        """Return all of `rows` (N,)."""
        return cls(rows, np.full(1, len(rows), dtype=np.int64))

    @property
    def now(self) -> Ints:
        """The rows (K,) as of now."""
        return self.listed[: self.length[0]]


class Step(NamedTuple):
    """One step of a program.

    A step without a kernel is `python(now, rows)`, called if there are any rows. With a kernel, `python(now, rows,
    result)` goes on where the kernel's result is not 0.
    """

    stage: int
    python: Callable[..., object]
    rows: Rows
    kernel: Any = None
    records: tuple[Packed[Any], ...] = ()
    always: bool = False
    """Whether the kernel is called without rows, too, because it writes lists."""


class Program:
    """Steps that are run one after the other, in the order of their stages, and as they are listed within a stage.

    A copy or a pickle makes its steps anew, from the copied arrays.

    Args:
        made: returns the steps; called before the first run.

    Example:
        >>> network = BehaviourNetwork(model, rows=1)
        >>> everyone, commands = Rows.of(np.arange(1)), Commands(rows=1, dim=2)
        >>> program = Program(lambda: OrganisedRobots(network, sensors, actions).steps(everyone, everyone, commands))
        >>> program.run(now=0.2)

    """

    __slots__ = ("_made", "_now", "_steps", "_table")

    def __init__(self, made: Callable[[], Sequence[Step]]) -> None:
        self._made = made
        self._steps: tuple[Step, ...] = ()
        self._table: Ints = np.zeros((0, STEP_COLUMNS), dtype=np.int64)
        self._now: Floats = np.zeros(1)

    def __reduce__(self) -> tuple[Any, ...]:
        return Program, (self._made,)

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps in their order."""
        if not self._steps:
            self._steps = tuple(sorted(self._made(), key=attrgetter("stage")))
            if BY_ADDRESS:
                words = [words_of_step(one.kernel, one.rows, one.records, one.always, one.stage) for one in self._steps]
                self._table = np.array(words, dtype=np.int64)
        return self._steps

    def run(self, now: float, without: int = 0) -> None:
        """Run all steps at `now` [s], but those of the stages in `without`; see `bits_of`."""
        self.repeat(ONCE, now, 1, without)

    def repeat(self, ticks: Ints, length: float, times: int, without: int = 0) -> None:
        """Run all steps several times, each at `ticks` (1,) times `length` [s], where some step counts `ticks` on.

        A step in Python that returns STOP ends that.
        """
        at, now, steps = 0, self._now, self._steps or self.steps
        while times > 0:
            if BY_ADDRESS:
                at, result, times = repeat_steps(ticks, length, now, at, times, without, self._table)
            else:
                at, result, times = self._repeat_plainly(ticks, length, at, times, without)
            if at == len(steps):
                return
            step = steps[at]
            if step.python(float(now[0]), step.rows.now, *(() if step.kernel is None else (result,))) is STOP:
                return
            at += 1

    def _repeat_plainly(self, ticks: Ints, length: float, at: int, times: int, without: int) -> tuple[int, int, int]:
        """Do as `repeat_steps` does, where nothing is called by address."""
        while times > 0:
            if at == 0:
                self._now[0] = ticks[0] * length
            for place, step in enumerate(self._steps[at:], at):
                rows = step.rows.now
                if 1 << step.stage & without or not (len(rows) or step.always):
                    continue
                handles = (packed.handle for packed in step.records)
                result = step.kernel(float(self._now[0]), rows, *handles) if step.kernel else 0
                if result or not step.kernel:
                    return place, result, times
            at, times = 0, times - 1
        return len(self._steps), 0, 0


ONCE: Ints = np.ones(1, dtype=np.int64)
"""Ticks of a program that runs once."""


def bits_of(stages: Iterable[int]) -> int:
    """Return the number with the bits of some stages."""
    return sum(1 << stage for stage in stages)
