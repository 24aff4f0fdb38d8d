"""A tick as a program: a list of steps, of which compiled code runs all in a row that need no Python.

A kernel that is a step takes `(now, rows, *handles)` and returns 0, or another number if Python has to go on with it.
What changes from tick to tick are the lists of rows, which steps write for later ones. The list of steps never changes.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from operator import attrgetter
from typing import Annotated, Any, NamedTuple

import numpy as np

from selforg.arrays import SCRATCH, Ints
from selforg.compiler.records import Packed
from selforg.compiler.steps import STEP_COLUMNS, run_steps, words_of_step
from selforg.compiler.switches import BY_ADDRESS

(
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
) = range(13)
"""Stages of a tick in their order; what they are for is in ARCHITECTURE.md."""


class Rows(NamedTuple):
    """Rows that steps are run for, the first ones of a list that compiled code may write."""

    listed: Annotated[Ints, "N", SCRATCH]
    length: Annotated[Ints, "1", SCRATCH]

    @classmethod
    def of(cls, rows: Ints) -> Rows:
        """Return all of `rows` (N,)."""
        return cls(rows, np.full(1, len(rows), dtype=np.int64))

    @property
    def now(self) -> Ints:
        """The rows (K,) as of now."""
        return self.listed[: self.length[0]]

    def fill(self, rows: Ints) -> None:
        """List `rows` (K,), at most as many as there is room for."""
        self.listed[: len(rows)] = rows
        self.length[0] = len(rows)


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
        without: stages that are left out.

    Example:
        >>> network = BehaviourNetwork(model, rows=1)
        >>> everyone, commands = Rows.of(np.arange(1)), Commands(rows=1, dim=2)
        >>> program = Program(lambda: OrganisedRobots(network, sensors, actions).steps(everyone, everyone, commands))
        >>> program.run(now=0.2)

    """

    __slots__ = ("_made", "_steps", "_table", "_without")

    def __init__(self, made: Callable[[], Sequence[Step]], without: Container[int] = ()) -> None:
        self._made, self._without = made, without
        self._steps: tuple[Step, ...] = ()
        self._table: Ints = np.zeros((0, STEP_COLUMNS), dtype=np.int64)

    def __reduce__(self) -> tuple[Any, ...]:
        return Program, (self._made, self._without)

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps in their order."""
        if not self._steps:
            chosen = (step for step in self._made() if step.stage not in self._without)
            self._steps = tuple(sorted(chosen, key=attrgetter("stage")))
            if BY_ADDRESS:
                words = [words_of_step(one.kernel, one.rows, one.records, one.always) for one in self._steps]
                self._table = np.array(words, dtype=np.int64)
        return self._steps

    def run(self, now: float) -> None:
        """Run all steps at `now` [s]."""
        at, steps = 0, self._steps or self.steps
        while at < len(steps):
            at, result = run_steps(now, at, self._table) if BY_ADDRESS else self._run_plainly(now, at)
            if at < len(steps):
                step = steps[at]
                step.python(now, step.rows.now, *(() if step.kernel is None else (result,)))
                at += 1

    def _run_plainly(self, now: float, begin: int) -> tuple[int, int]:
        """Do as `run_steps` does, where nothing is called by address."""
        for at, step in enumerate(self._steps[begin:], begin):
            rows = step.rows.now
            if not (len(rows) or step.always):
                continue
            result = step.kernel(now, rows, *(packed.handle for packed in step.records)) if step.kernel else 0
            if result or not step.kernel:
                return at, result
        return len(self._steps), 0
