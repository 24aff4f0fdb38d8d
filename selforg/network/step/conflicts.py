"""Conflicts: a behaviour starts when those that influence the same sensors yield (compiled)."""

from __future__ import annotations

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Words, Written
from selforg.network.model.packed import PackedModel, open_model
from selforg.network.state import reasons as why
from selforg.network.state import state as st
from selforg.network.state.state import RowStates, open_states
from selforg.network.step.scratch import Scratch, open_scratch


@inlined
def make_room(row: int, b: int, model: Words[PackedModel], states: Written[RowStates], scratch: Words[Scratch]) -> int:
    """Stop the running behaviours that influence a sensor of `b`, if every one of them yields; else stop none.

    Returns how many of the `counted` were stopped, -1 if one does not yield.
    """
    s, counted, interruptable = open_states(states), open_scratch(scratch).counted, open_model(model).interruptable
    values, marks = s.values, s.marks
    priority, activation = marks[row, st.PRIORITY, b], values[row, st.ACTIVATION, b]
    clashes = False
    for other in range(counted.shape[0]):
        if other == b or not marks[row, st.EXECUTING, other] or not influences_same(row, b, other, model, marks):
            continue
        clashes = True
        theirs = marks[row, st.PRIORITY, other]
        weaker = theirs == priority and values[row, st.ACTIVATION, other] < activation
        yields = interruptable[other] and not marks[row, st.MANUAL, other]
        if not (yields and (theirs < priority or weaker)):
            note_reason(row, b, marks, why.BLOCKED, other)
            return -1
    freed = 0
    if clashes:
        for other in range(counted.shape[0]):
            if other != b and marks[row, st.EXECUTING, other] and influences_same(row, b, other, model, marks):
                note_reason(row, other, marks, why.DISPLACED, b)
                stop(row, other, marks)
                freed += counted[other]
                counted[other] = 0
    return freed


@inlined
def influences_same(row: int, b: int, other: int, model: Words[PackedModel], marks: Ints) -> bool:
    """Whether the two behaviours have effects on one sensor."""
    m = open_model(model)
    first, sensor, tag = m.effect_first, m.effect_sensor, m.effect_tag
    mine, others = marks[row, st.ALTERNATIVE, b], marks[row, st.ALTERNATIVE, other]
    for k in range(first[b], first[b + 1]):
        if tag[k] >= 0 and tag[k] != mine:
            continue
        for j in range(first[other], first[other + 1]):
            if sensor[j] == sensor[k] and (tag[j] < 0 or tag[j] == others):
                return True
    return False


@inlined
def stop(row: int, b: int, marks: Ints) -> None:
    """Stop behaviour `b`; it keeps its activation."""
    marks[row, st.EXECUTING, b] = 0
    marks[row, st.EXECUTION_TIME, b] = -1
    if marks[row, st.STARTED, b]:
        marks[row, st.STARTED, b] = 0
    else:
        marks[row, st.STOPPED, b] = 1


@inlined
def start(row: int, b: int, marks: Ints) -> None:
    """Start behaviour `b`."""
    marks[row, st.EXECUTING, b] = 1
    marks[row, st.EXECUTION_TIME, b] = 0
    marks[row, st.STARTED, b] = 1
    if marks.shape[1] == st.EXPLAINED_LAYERS:
        marks[row, st.REASON, b] = why.STARTED_BY_HAND if marks[row, st.MANUAL, b] else why.STARTED_READY
        marks[row, st.BY, b] = -1


@inlined
def note_reason(row: int, b: int, marks: Ints, reason: int, by: int) -> None:
    """Note why `b` runs or does not, in an explained network; what was stopped in this step keeps that reason."""
    if marks.shape[1] == st.EXPLAINED_LAYERS and not marks[row, st.STOPPED, b]:
        marks[row, st.REASON, b] = reason
        marks[row, st.BY, b] = by
