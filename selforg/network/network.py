"""The behaviour network at work: one model, any number of rows, one compiled step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel
from selforg.network.model import packed as t
from selforg.network.model.model import NetworkModel
from selforg.network.model.packed import Floats, Ints, ints_of
from selforg.network.planning.memory import PlanMemory
from selforg.network.planning.planner import Planner
from selforg.network.state import state as st
from selforg.network.state.state import NetworkState
from selforg.network.step import plan_monitoring as pw
from selforg.network.step.plan_monitoring import PlanState
from selforg.network.step.readings import reading_of, refuse
from selforg.network.step.step import DECIDE, SENSE_AND_DECIDE, STEP_TABLES, scratch_of, step_rows


class BehaviourNetwork:
    """R rows (robots) that decide by one model.

    Every decision period: fill `readings` (R, S), call `step()`, then act on what runs (`started`, `executing`).
    With a `planner` each row follows a plan of its own; without one, plans come from `set_plan` or not at all. An
    `explained` network also notes why each behaviour runs or does not (`recording`, `explanation`).
    """

    def __init__(self, model: NetworkModel, rows: int, planner: Planner | None = None, explained: bool = False) -> None:
        self.model = model
        self.rows = rows
        self.planner = planner
        sizes = ints_of(model.ints, t.SIZES)
        self.state = NetworkState(rows, int(sizes[1]), int(sizes[2]), int(sizes[4]), explained)
        self.readings: NDArray[np.float64] = np.zeros((rows, int(sizes[0])))
        self.plans = PlanState(rows, int(sizes[0]))
        self._memory = planner.memory if planner else PlanMemory([], [], [], 0)
        self._keys: NDArray[np.int64] = np.zeros((rows, self._memory.key_words), dtype=np.int64)
        self._priorities = np.array([b.priority for b in model.behaviours], dtype=np.int64)
        self._scratch = scratch_of(model.ints)
        self._bundled, self._tables = self._memory.entries, self._bundle()
        self._all, self._none = np.arange(rows), np.zeros(0, dtype=np.int64)
        self._runs: NDArray[np.int64] = np.zeros((len(model.behaviours), 2, rows), dtype=np.int64)
        self.reset()

    @property
    def executing(self) -> NDArray[np.int64]:
        """(R, B) 1 where a behaviour runs after the last step."""
        executing: NDArray[np.int64] = self.state.marks[st.EXECUTING]
        return executing

    @property
    def started(self) -> NDArray[np.int64]:
        """(R, B) 1 where a behaviour was started in the last step."""
        started: NDArray[np.int64] = self.state.marks[st.STARTED]
        return started

    @property
    def stopped(self) -> NDArray[np.int64]:
        """(R, B) 1 where a behaviour that ran before was stopped in the last step."""
        stopped: NDArray[np.int64] = self.state.marks[st.STOPPED]
        return stopped

    def running(self, behaviour: int, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return those of `rows` (K,) in which a behaviour runs, and those of them in which the last step started it.

        Both hold until the next call for the same behaviour.
        """
        lists = self._runs[behaviour]
        running, started = list_running(rows, self.state.mark_table, behaviour, lists)
        return lists[0, :running], lists[1, :started]

    def reset(self, rows: NDArray[np.int64] | None = None) -> None:
        """Back to the first step, for all rows or `rows` (K,)."""
        chosen = self._all if rows is None else rows
        self.begin(chosen)
        self.readings[chosen] = 0.0

    def begin(self, rows: NDArray[np.int64]) -> None:
        """Back to the first step for `rows` (K,), with the readings that they have."""
        s, p = self.state, self.plans
        st.reset_rows(
            rows, self._priorities, self.model.settings.activation_threshold, s.value_table, s.mark_table, s.row_table,
            s.goal_satisfaction, s.goal_enabled, s.wishes, s.wish_kept, p.mark_table, p.readings,
        )  # fmt: skip

    def read(self, values: Mapping[str, object], rows: NDArray[np.int64] | None = None) -> None:
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
        rows: NDArray[np.int64],
        behaviour: int,
        alternative: int | NDArray[np.int64],
        forgotten: NDArray[np.int64] | None = None,
    ) -> None:
        """Let `behaviour` show another of its alternatives in `rows` (K,); what changes asks for a new plan.

        `forgotten`: sensors whose readings, where it changes, are 0 until they are read anew.
        """
        wanted = np.full(len(rows), alternative) if isinstance(alternative, int) else alternative
        forgotten = self._none if forgotten is None else forgotten
        hold_rows(rows, behaviour, wanted, forgotten, self.state.mark_table, self.plans.mark_table, self.readings)

    def set_plan(self, row: int, behaviours: Sequence[int] | None, index: int = 0) -> None:
        """Give `row` a plan (behaviour indices; None: there is none) of which step `index` is due."""
        steps = behaviours or ()
        if len(steps) > pw.MAX_PLAN:
            raise ValueError(f"a plan holds at most {pw.MAX_PLAN} steps, got {len(steps)}")
        self.plans.steps[row, : len(steps)] = steps
        self.plans.marks[pw.INDEX, row] = index
        self.plans.marks[pw.LENGTH, row] = len(steps)
        self.plans.marks[pw.KNOWN, row] = int(behaviours is not None)

    def finish(self, rows: NDArray[np.int64], behaviour: int) -> None:
        """Let a behaviour end itself in `rows` (K,) where it runs: it stops, and loses its activation next step."""
        running = rows[self.state.marks[st.EXECUTING, rows, behaviour] == 1]
        self.state.marks[st.EXECUTING, running, behaviour] = 0
        self.state.marks[st.EXECUTION_TIME, running, behaviour] = -1
        self.state.marks[st.FINISHED, running, behaviour] = 1

    def halt(self, rows: NDArray[np.int64]) -> None:
        """Stop whatever runs in `rows` (K,); activations stay."""
        halt_rows(rows, self.state.mark_table)

    def enable(self, rows: NDArray[np.int64], behaviour: int, enabled: bool) -> None:
        """Switch a behaviour on or off in `rows` (K,); what is switched off ends itself."""
        self.state.marks[st.ENABLED, rows, behaviour] = int(enabled)
        self.plans.marks[pw.ALARM, rows] = 1
        if not enabled:
            self.finish(rows, behaviour)

    def remove(self, rows: NDArray[np.int64], behaviour: int) -> None:
        """Take a behaviour out of the network of `rows` (K,)."""
        self.state.marks[st.PRESENT, rows, behaviour] = 0
        self.state.marks[st.EXECUTING, rows, behaviour] = 0
        self.plans.marks[pw.ALARM, rows] = 1

    def enable_goal(self, rows: NDArray[np.int64], goal: int, enabled: bool) -> None:
        """Switch a goal on or off in `rows` (K,)."""
        self.state.goal_enabled[rows, goal] = int(enabled)

    def set_priority(self, rows: NDArray[np.int64], behaviour: int, priority: int) -> None:
        """Change the priority of a behaviour in `rows` (K,)."""
        self.state.marks[st.PRIORITY, rows, behaviour] = priority

    def start_by_hand(self, rows: NDArray[np.int64], behaviour: int, wanted: bool) -> None:
        """While `wanted`, run a behaviour in `rows` (K,) whatever it needs and whatever else runs."""
        self.state.marks[st.MANUAL, rows, behaviour] = int(wanted)

    def step(self, rows: NDArray[np.int64] | None = None, guarantee: bool = False) -> None:
        """One decision of `rows` (K,) or all, from the present `readings`.

        With `guarantee`, selection is repeated until something runs or nothing could.

        Raises:
            ReadingError: a fact that reads neither 0 nor 1, or a number that is not one; nothing has changed then.

        """
        chosen = self._all if rows is None else rows
        missing = self._run(chosen, SENSE_AND_DECIDE, guarantee)
        if missing < 0:
            refuse(-1 - missing, self.model.sensors, self.readings)
        if missing and self.planner is not None:
            waiting = chosen[self.plans.marks[pw.NEEDED, chosen] == 1]
            self._plan(self.planner, waiting)
            self._run(waiting, DECIDE, guarantee)

    def _plan(self, planner: Planner, rows: NDArray[np.int64]) -> None:
        """Plan for `rows` (K,), once for each key; keys that the memory has come to tell apart finer are let be."""
        s, reach = self.state, self._memory.reach
        found: dict[bytes, list[int] | None] = {}
        for row in rows.tolist():
            key = self._keys[row].tobytes()
            if key not in found:
                steps = planner.plan(self.readings[row], s.marks[st.ALTERNATIVE, row], s.goal_enabled[row])
                if self._memory.reach == reach:
                    self._memory.insert(self._keys[row], steps)
                    found[key] = steps
            else:
                steps = found[key]
            self.set_plan(row, steps)
            self.plans.marks[pw.NEEDED, row] = 0

    def _run(self, rows: NDArray[np.int64], phase: int, guarantee: bool) -> int:
        if self._bundled is not self._memory.entries:  # another table whenever it grows
            self._bundled = self._memory.entries
            self._tables = self._bundle()
        return step_rows(rows, self._tables, phase, self.planner is not None, guarantee)

    def _bundle(self) -> Bundle:
        s, p, memory = self.state, self.plans, self._memory
        return STEP_TABLES.bundle(
            self.model.ints, self.model.floats, self.readings, s.value_table, s.mark_table, s.row_table,
            s.goal_satisfaction, s.goal_enabled, s.wishes, s.wish_kept, p.steps, p.mark_table, p.readings,
            memory.layout, memory.entries, self._keys, *self._scratch,
        )  # fmt: skip


@lean_kernel
def list_running(rows: Ints, marks: Ints, behaviour: int, lists: Ints) -> tuple[int, int]:
    """List in `lists` (2, R) where of `rows` (K,) a behaviour runs, and where it was started; return how many."""
    running, started = 0, 0
    for row in rows:
        if marks[row, st.EXECUTING, behaviour]:
            lists[0, running] = row
            running += 1
            if marks[row, st.STARTED, behaviour]:
                lists[1, started] = row
                started += 1
    return running, started


@lean_kernel
def halt_rows(rows: Ints, marks: Ints) -> None:
    """Stop whatever runs in `rows` (K,); see `BehaviourNetwork.halt`."""
    for row in rows:
        for b in range(marks.shape[2]):
            marks[row, st.EXECUTING, b] = 0
            marks[row, st.EXECUTION_TIME, b] = -1


@lean_kernel
def hold_rows(
    rows: Ints, behaviour: int, alternatives: Ints, forgotten: Ints, marks: Ints, plan_marks: Ints, readings: Floats
) -> None:
    """Let `behaviour` show `alternatives` (K,) in `rows` (K,); see `BehaviourNetwork.hold`."""
    for k in range(rows.shape[0]):
        row = rows[k]
        if marks[row, st.ALTERNATIVE, behaviour] != alternatives[k]:
            marks[row, st.ALTERNATIVE, behaviour] = alternatives[k]
            plan_marks[row, pw.ALARM] = 1
            for sensor in forgotten:
                readings[row, sensor] = 0.0
