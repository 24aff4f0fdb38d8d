"""The behaviour network at work: one model, any number of rows, one compiled step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np

from selforg.arrays import READ, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed, Written
from selforg.network import state as st
from selforg.network.model.model import NetworkModel
from selforg.network.model.packed import DECIDE_ONLY, SENSE_AND_DECIDE, scratch_for
from selforg.network.planning.memory import PlanMemory
from selforg.network.planning.planner import Planner
from selforg.network.state import MAX_PLAN, RowStates, new_states, open_states, reset_rows
from selforg.network.step.readings import reading_of, refuse
from selforg.network.step.step import step_rows
from selforg.program import Rows, Step


class BehaviourNetwork:
    """R rows (robots) that decide by one model.

    In every decision period: fill `readings` (R, S), call `step()`, then act on `started` and `executing`.
    With a `planner` each row follows a plan of its own; without one, plans come from `set_plan` only. An
    `explained` network also notes why each behaviour runs or does not (`explanation`).

    Attributes:
        packed: the record of the `state`.

    """

    model: Annotated[NetworkModel, READ]
    planner: Annotated[Planner | None, READ]
    _memory: Annotated[PlanMemory, READ]
    _all: Annotated[Ints, "R", READ]
    _none: Annotated[Ints, "0", READ]

    def __init__(self, model: NetworkModel, rows: int, planner: Planner | None = None, explained: bool = False) -> None:
        self.model = model
        self.rows = rows
        self.planner = planner
        arrays = model.packed.record
        self._memory = planner.memory if planner else PlanMemory([], [], [], 0)
        self.explained = explained
        packed = new_states(rows, arrays, explained, planner is not None, self._memory.key_words)
        self.state, self.packed = packed.record, packed
        phases = SENSE_AND_DECIDE, DECIDE_ONLY
        self._scratch = [[scratch_for(arrays, phase, guarantee) for guarantee in (0, 1)] for phase in phases]
        self._all, self._none = np.arange(rows), np.zeros(0, dtype=np.int64)
        self.reset()

    @property
    def readings(self) -> Floats:
        """(R, S) what the sensors read now; facts 0 or 1."""
        return self.state.readings

    @property
    def executing(self) -> Ints:
        """(R, B) 1 where a behaviour runs after the last step."""
        return self.state.marks[:, st.EXECUTING]

    @property
    def activation(self) -> Floats:
        """(R, B) activation of each behaviour after the last step."""
        return self.state.values[:, st.ACTIVATION]

    @property
    def components(self) -> dict[str, Floats]:
        """What the last step added to each activation (R, B), by name."""
        return {name: self.state.values[:, st.PRECONDITIONS + k] for k, name in enumerate(st.COMPONENTS)}

    @property
    def started(self) -> Ints:
        """(R, B) 1 where a behaviour was started in the last step."""
        return self.state.marks[:, st.STARTED]

    @property
    def stopped(self) -> Ints:
        """(R, B) 1 where a behaviour that ran before was stopped in the last step."""
        return self.state.marks[:, st.STOPPED]

    def reset(self, rows: Ints | None = None) -> None:
        """Return to the first step in all rows or `rows` (K,), with all readings 0."""
        chosen = self._all if rows is None else rows
        self.restart(chosen)
        self.readings[chosen] = 0.0

    def restart(self, rows: Ints) -> None:
        """Return to the first step in `rows` (K,), with the readings that they have."""
        reset_rows(rows, self.model.packed.handle, self.packed.handle)

    def read(self, values: Mapping[str, object], rows: Ints | None = None) -> None:
        """Set the readings of some sensors by name, for all rows or `rows` (K,).

        Raises:
            ReadingError: a value that the sensor cannot have.
            ValueError: an unknown sensor.

        """
        chosen = self._all if rows is None else rows
        for name, value in values.items():
            column = self.model.sensor(name, "reading")
            self.readings[chosen, column] = reading_of(self.model.sensors[column], value)

    def hold(
        self,
        rows: Ints,
        behaviour: int,
        alternative: int | Ints,
        forgotten: Ints | None = None,
    ) -> None:
        """Switch `behaviour` to one of its alternatives in `rows` (K,); a row that changes asks for a new plan.

        `forgotten`: sensors whose readings become 0 in the rows that change, until they are read again.
        """
        wanted = np.full(len(rows), alternative) if isinstance(alternative, int) else alternative
        forgotten = self._none if forgotten is None else forgotten
        hold_rows(rows, behaviour, wanted, forgotten, self.packed.handle)

    def set_plan(self, row: int, behaviours: Sequence[int] | None, index: int = 0) -> None:
        """Give `row` a plan (behaviour indices; None: there is none) of which step `index` is due.

        Raises:
            ValueError: a plan of more than MAX_PLAN steps.

        """
        steps, marks = behaviours or (), self.state.plan_marks
        if len(steps) > MAX_PLAN:
            raise ValueError(f"a plan holds at most {MAX_PLAN} steps, got {len(steps)}")
        self.state.plan[row, : len(steps)] = steps
        marks[row, st.PLAN_INDEX], marks[row, st.PLAN_LENGTH] = index, len(steps)
        marks[row, st.PLAN_KNOWN] = int(behaviours is not None)

    def finish(self, rows: Ints, behaviour: int) -> None:
        """End a behaviour in `rows` (K,) where it runs, as if by itself: it loses its activation in the next step."""
        running = rows[self.state.marks[rows, st.EXECUTING, behaviour] == 1]
        self.state.marks[running, st.EXECUTING, behaviour] = 0
        self.state.marks[running, st.EXECUTION_TIME, behaviour] = -1
        self.state.marks[running, st.ENDED, behaviour] = 1

    def enable(self, rows: Ints, behaviour: int, enabled: bool) -> None:
        """Switch a behaviour on or off in `rows` (K,); one that is switched off ends."""
        self.state.marks[rows, st.ENABLED, behaviour] = int(enabled)
        self.state.plan_marks[rows, st.PLAN_ALARM] = 1
        if not enabled:
            self.finish(rows, behaviour)

    def remove(self, rows: Ints, behaviour: int) -> None:
        """Take a behaviour out of the network of `rows` (K,)."""
        self.state.marks[rows, st.PRESENT, behaviour] = 0
        self.state.marks[rows, st.EXECUTING, behaviour] = 0
        self.state.plan_marks[rows, st.PLAN_ALARM] = 1

    def enable_goal(self, rows: Ints, goal: int, enabled: bool) -> None:
        """Switch a goal on or off in `rows` (K,)."""
        self.state.goal_enabled[rows, goal] = int(enabled)

    def set_priority(self, rows: Ints, behaviour: int, priority: int) -> None:
        """Change the priority of a behaviour in `rows` (K,)."""
        self.state.marks[rows, st.PRIORITY, behaviour] = priority

    def start_by_hand(self, rows: Ints, behaviour: int, wanted: bool) -> None:
        """Run a behaviour in `rows` (K,) while `wanted`, even if it is not ready or others run."""
        self.state.marks[rows, st.MANUAL, behaviour] = int(wanted)

    def step(self, rows: Ints | None = None, guarantee: bool = False) -> None:
        """Decide once in all rows or `rows` (K,), from the present `readings`.

        With `guarantee`, selection is repeated until some behaviour runs, or none is able to.

        Raises:
            ReadingError: a fact that reads neither 0 nor 1, or a number that is not one; nothing has changed then.

        """
        chosen = self._all if rows is None else rows
        self._go_on(chosen, self._run(chosen, SENSE_AND_DECIDE, guarantee), guarantee)

    def deciding(self, stage: int, rows: Rows, guarantee: bool) -> Step:
        """Return the step of a program that does as `step` does."""
        records = self._records(SENSE_AND_DECIDE, guarantee)
        return Step(stage, lambda now, rows, result: self._go_on(rows, result, guarantee), rows, step_rows, records)

    def _go_on(self, rows: Ints, missing: int, guarantee: bool) -> None:
        """Go on where `step_rows` has ended in `rows` (K,) with a result that says how many plans are missing."""
        if missing < 0:
            refuse(-1 - missing, self.model.sensors, self.readings)
        if missing and self.planner is not None:
            waiting = rows[self.state.plan_marks[rows, st.PLAN_NEEDED] == 1]
            self._plan(self.planner, waiting)
            self._run(waiting, DECIDE_ONLY, guarantee)

    def _plan(self, planner: Planner, rows: Ints) -> None:
        """Plan for `rows` (K,), once for each key."""
        reach = self._memory.reach
        found: dict[bytes, list[int] | None] = {}
        for row in rows.tolist():
            key = self.state.plan_keys[row].tobytes()
            if key not in found:
                alternatives = self.state.marks[row, st.ALTERNATIVE]
                enabled = self.state.goal_enabled[row]
                steps = planner.plan(self.readings[row], alternatives, enabled) if enabled.any() else None
                if self._memory.reach == reach:  # otherwise the keys of this step stand for too many readings
                    self._memory.insert(self.state.plan_keys[row], steps)
                    found[key] = steps
            else:
                steps = found[key]
            self.set_plan(row, steps)
            self.state.plan_marks[row, st.PLAN_NEEDED] = 0

    def _run(self, rows: Ints, phase: int, guarantee: bool) -> int:
        handles = (packed.handle for packed in self._records(phase, guarantee))
        return step_rows(0.0, rows, *handles)

    def _records(self, phase: int, guarantee: bool) -> tuple[Packed[Any], ...]:
        return self.model.packed, self.packed, self._memory.packed, self._scratch[phase][int(guarantee)]


@lean_kernel
def hold_rows(
    rows: Ints,
    behaviour: int,
    alternatives: Ints,
    forgotten: Ints,
    states: Written[RowStates],
) -> None:
    """Switch `behaviour` to `alternatives` (K,) in `rows` (K,); see `BehaviourNetwork.hold`."""
    s = open_states(states)
    marks, readings = s.marks, s.readings
    for k in range(rows.shape[0]):
        row = rows[k]
        if marks[row, st.ALTERNATIVE, behaviour] != alternatives[k]:
            marks[row, st.ALTERNATIVE, behaviour] = alternatives[k]
            s.plan_marks[row, st.PLAN_ALARM] = 1
            for sensor in forgotten:
                readings[row, sensor] = 0.0
