"""The state of a network: what its rows (robots) know between two steps, and the numbers of the last step.

Values, marks and plans of a row have layers, one for each quantity below: `state.marks[:, EXECUTING]` is (R, B).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import KEPT, SCRATCH, Floats, Ints
from selforg.compiler.decorators import kernel, lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.network import state as st
from selforg.network.model.packed import PackedModel, open_model

# layers of values
(
    ACTIVATION,
    SATISFACTION,
    PRECONDITIONS,  # from here on: the components of the last step's activation
    GOALS,
    INHIBITION,
    PREDECESSORS,
    SUCCESSORS,
    CONFLICTORS,
    PLAN,
    VALUE_LAYERS,
) = range(10)

COMPONENTS = {
    "preconditions": PRECONDITIONS,
    "goals": GOALS,
    "goal_inhibition": INHIBITION,
    "predecessors": PREDECESSORS,
    "successors": SUCCESSORS,
    "conflictors": CONFLICTORS,
    "plan": PLAN,
}

# layers of marks
(
    PRESENT,  # part of the network at all
    ENABLED,
    EXECUTING,
    EXECUTION_TIME,  # steps since it started, -1: not running
    READY,
    STARTED,  # in the last step
    STOPPED,  # in the last step
    ENDED,  # ended itself since the last step
    MANUAL,  # started by hand: nothing is checked and nothing stops it
    PRIORITY,
    ALTERNATIVE,  # which of its alternatives it holds, -1: none
    REASON,  # why it runs or does not, see below; this and the next layer exist only in an explained network
    BY,  # the behaviour that the reason is about, -1: none
    EXPLAINED_LAYERS,
) = range(14)
MARK_LAYERS = REASON

# layers of row_values
(
    THRESHOLD,
    TOTAL,  # activation of all operational behaviours before the last step
    DECIDING,  # the threshold by which the last step decided
    ROW_LAYERS,
) = range(4)


# layers of plan_marks
(
    PLAN_INDEX,  # of the step that is due
    PLAN_LENGTH,
    PLAN_KNOWN,  # the last attempt found a plan
    PLAN_ALARM,  # something happened that asks for a new plan
    PLAN_NEEDED,  # this step needs a new plan
    PLAN_LAYERS,
) = range(6)

# layers of plan_readings, with six decimals
(
    LAST_STEP,
    LAST_CHANGE,  # in the last step
    TWO_STEPS,  # what changed in the last two steps
    SINCE_IDLE,  # what changed since nothing ran or a plan was asked for
    READING_LAYERS,
) = range(5)

MAX_PLAN = 64

# in the layer REASON of the marks of an explained network; the layer BY says which other behaviour it was, -1: none
(
    UNKNOWN,
    STARTED_READY,
    STARTED_BY_HAND,
    KEPT_READY,
    KEPT_BY_HAND,
    KEPT_STUBBORN,
    OUT_OF_TIME,
    LOST_READINESS,
    FELL_BELOW,
    CROWDED_OUT,
    DISPLACED,
    DISABLED,
    NOT_READY,
    BELOW_THRESHOLD,
    BLOCKED,
    NO_PLACE,
) = range(16)

GOES_ON = KEPT_READY, KEPT_BY_HAND, KEPT_STUBBORN
"""Reasons of behaviours that go on."""

WORDS = {
    UNKNOWN: "not part of the network, or no step yet",
    STARTED_READY: "started: ready and active enough",
    STARTED_BY_HAND: "started by hand",
    KEPT_READY: "keeps running: ready and active enough",
    KEPT_BY_HAND: "keeps running: started by hand",
    KEPT_STUBBORN: "keeps running: not interruptable",
    OUT_OF_TIME: "stopped: its time is up",
    LOST_READINESS: "stopped: no longer ready",
    FELL_BELOW: "stopped: activation fell below the threshold",
    CROWDED_OUT: "stopped: enough others run",
    DISPLACED: "stopped: had to make room for {by}",
    DISABLED: "takes no turn: it corrects what the others command",
    NOT_READY: "does not start: not ready",
    BELOW_THRESHOLD: "does not start: activation below the threshold",
    BLOCKED: "does not start: {by} influences the same sensor and does not yield",
    NO_PLACE: "does not start: enough others run",
}


class RowStates(NamedTuple):
    """What compiled code reads and writes of R rows; S sensors, B behaviours, G goals, U wishes."""

    readings: Annotated[Floats, "R S", KEPT]  # what the sensors read now; facts 0 or 1
    values: Annotated[Floats, "R VALUE B", KEPT]  # activation, satisfaction and the terms of activation
    marks: Annotated[Ints, "R MARK B", KEPT]
    row_values: Annotated[Floats, "R ROW", KEPT]  # thresholds and total activation
    goal_satisfaction: Annotated[Floats, "R G", KEPT]
    goal_enabled: Annotated[Ints, "R G", KEPT]  # 1 while a goal is on
    wishes: Annotated[Floats, "R U", KEPT]  # signed change that is wanted
    wish_kept: Annotated[Ints, "R U", KEPT]  # 0: of another alternative, or a smaller wish about the same sensor counts
    planned: int  # 1 if a planner answers
    plan: Annotated[Ints, "R MAX_PLAN", KEPT]  # behaviours in their order
    plan_marks: Annotated[Ints, "R PLAN", KEPT]
    plan_readings: Annotated[Floats, "R READING S", KEPT]  # since the plan was made
    plan_keys: Annotated[Ints, "R KEY", KEPT]  # what the plan of a row depends on, see `planning.memory`
    running: Annotated[Ints, "B 2 R", SCRATCH]  # rows in which each behaviour runs, and in which it has just started,
    counts: Annotated[Ints, "B 2 1", SCRATCH]  # the first ones; and how many; see `list_running`


open_states = opening(RowStates)


def new_states(
    rows: int, model: PackedModel, explained: bool, planned: bool = False, key_words: int = 0
) -> Packed[RowStates]:
    """Return the state of R rows, all zero but for the goals, which are on; `explained`: with room for reasons."""
    sensors, behaviours = len(model.is_fact), len(model.priority)
    goals, wishes = len(model.goal_permanent), len(model.wish_owner)
    layers = EXPLAINED_LAYERS if explained else MARK_LAYERS
    return Packed(
        RowStates(
            readings=np.zeros((rows, sensors)),
            values=np.zeros((rows, VALUE_LAYERS, behaviours)),
            marks=np.zeros((rows, layers, behaviours), dtype=np.int64),
            row_values=np.zeros((rows, ROW_LAYERS)),
            goal_satisfaction=np.zeros((rows, goals)),
            goal_enabled=np.ones((rows, goals), dtype=np.int64),
            wishes=np.zeros((rows, wishes)),
            wish_kept=np.zeros((rows, wishes), dtype=np.int64),
            planned=int(planned),
            plan=np.zeros((rows, MAX_PLAN), dtype=np.int64),
            plan_marks=np.zeros((rows, PLAN_LAYERS), dtype=np.int64),
            plan_readings=np.zeros((rows, READING_LAYERS, sensors)),
            plan_keys=np.zeros((rows, key_words), dtype=np.int64),
            running=np.zeros((behaviours, 2, rows), dtype=np.int64),
            counts=np.zeros((behaviours, 2, 1), dtype=np.int64),
        )
    )


@kernel
def reset_rows(rows: Ints, model: Handle[PackedModel], states: Written[RowStates]) -> None:
    """Clear `rows` (K,): nothing runs, nothing is activated, known or planned, all goals are on; readings stay."""
    m, s = open_model(model), open_states(states)
    for row in rows:
        s.values[row] = 0.0
        s.marks[row] = 0
        s.marks[row, st.PRESENT] = 1
        s.marks[row, st.ENABLED] = 1
        s.marks[row, st.EXECUTION_TIME] = -1
        for b in range(len(m.priority)):  # one by one, because a slice assigned to a slice takes two seconds to compile
            s.marks[row, st.PRIORITY, b] = m.priority[b]
        s.row_values[row] = 0.0
        s.row_values[row, st.THRESHOLD] = s.row_values[row, st.DECIDING] = m.activation_threshold
        s.goal_satisfaction[row] = 0.0
        s.goal_enabled[row] = 1
        s.wishes[row] = 0.0
        s.wish_kept[row] = 0
        s.plan_marks[row] = 0
        s.plan_readings[row] = 0.0


@lean_kernel
def list_running(now: float, rows: Ints, states: Handle[RowStates]) -> int:
    """List where of `rows` (K,) behaviours run, and where they were started; a step, see `selforg.program`."""
    s = open_states(states)
    for b in range(len(s.running)):
        runs, starts = 0, 0
        for row in rows:
            if s.marks[row, st.EXECUTING, b]:
                s.running[b, 0, runs] = row
                runs += 1
                if s.marks[row, st.STARTED, b]:
                    s.running[b, 1, starts] = row
                    starts += 1
        s.counts[b, 0, 0], s.counts[b, 1, 0] = runs, starts
    return 0
