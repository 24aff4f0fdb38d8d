"""Arbitration, the last stage of a step: which behaviours run from now on (compiled)."""

from __future__ import annotations

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.network.model.packed import PackedModel, Scratch, open_model, open_scratch
from selforg.network.state import RowStates, open_states
from selforg.network.step.activation import is_operational


@inlined
def arbitrate_row(
    row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch], guarantee: bool
) -> bool:
    """Stop and start behaviours of `row`; with `guarantee`, again until something runs or nothing could.

    Returns whether a behaviour was stopped because its time was up (M6).
    """
    s, interruptable = open_states(states), open_model(model).interruptable
    marks, timed_out = s.marks[row], False
    for b in range(marks.shape[1]):
        may_stop = interruptable[b] == 1 and not marks[st.MANUAL, b]
        timed_out = timed_out or (may_stop and marks[st.EXECUTING, b] == 1 and is_timed_out(b, model, marks))
        marks[st.STARTED, b] = 0
        marks[st.STOPPED, b] = 0
    first, again = True, True
    while again:
        before = s.row_values[row, st.THRESHOLD]
        running = select_row(row, model, states, scratch, first)
        # with a threshold that does not fall, nothing ever starts
        falls = first or s.row_values[row, st.THRESHOLD] != before
        again = guarantee and not running and falls and anything_eligible(row, states)
        first = False
    return timed_out


@inlined
def select_row(
    row: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch], advance: bool
) -> bool:
    """Go once through the behaviours of `row` in falling activation; return whether anything runs afterwards.

    With `advance` the time of behaviours that keep running advances.
    """
    s, own, limit = open_states(states), open_scratch(scratch), open_model(model).max_parallel
    marks, threshold = s.marks[row], s.row_values[row, st.THRESHOLD]
    s.row_values[row, st.DECIDING] = threshold
    order_by_activation(row, states, scratch)
    for b in range(own.counted.shape[0]):
        own.counted[b] = 0
    selected, any_started, any_operational = 0, False, False
    for b in own.order:
        if not marks[st.PRESENT, b]:
            continue
        any_operational = any_operational or marks[st.ENABLED, b] == 1
        activation = s.values[row, st.ACTIVATION, b]
        if marks[st.EXECUTING, b]:
            reason = reason_of_running(b, model, marks, activation < threshold, selected)
            note_reason(b, marks, reason, -1)
            if reason not in st.GOES_ON:
                stop(b, marks)
                continue
            marks[st.EXECUTION_TIME, b] += 1 if advance else 0
        else:
            if not marks[st.MANUAL, b]:
                reason = reason_of_idle(b, marks, activation >= threshold)
                if reason == st.UNKNOWN:
                    freed = make_room(row, b, model, states, scratch)
                    selected -= max(freed, 0)
                    if freed < 0:
                        continue
                    if limit > 0 and selected + waiting_by_hand(marks, own.counted) >= limit:
                        reason = st.NO_PLACE
                if reason != st.UNKNOWN:
                    note_reason(b, marks, reason, -1)
                    continue
            start(b, marks)
            any_started = True
        own.counted[b] = 1
        selected += 1
    any_running = False
    for b in range(own.counted.shape[0]):
        any_running = any_running or marks[st.EXECUTING, b] == 1
    adapt_threshold(model, s.row_values[row], any_started, any_operational and not any_running)
    return any_running


@inlined
def order_by_activation(row: int, states: Handle[RowStates], scratch: Handle[Scratch]) -> None:
    """Fill `order` with the behaviours of `row` in falling activation; ties keep the order of registration."""
    activation, order = open_states(states).values[row, st.ACTIVATION], open_scratch(scratch).order
    for b in range(order.shape[0]):
        k = b
        while k > 0 and activation[order[k - 1]] < activation[b]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = b


@inlined
def is_timed_out(b: int, model: Handle[PackedModel], marks: Ints) -> bool:
    """Whether a running behaviour has used up its time; here and below marks are those (MARK, B) of a row."""
    timeout = open_model(model).timeout[b]
    return bool(timeout >= 0 and marks[st.EXECUTION_TIME, b] >= timeout)


@inlined
def reason_of_running(b: int, model: Handle[PackedModel], marks: Ints, below: bool, selected: int) -> int:
    """Return why a running behaviour, `below` the threshold or not, goes on, one of `GOES_ON`, or why it stops."""
    m = open_model(model)
    if marks[st.MANUAL, b]:
        return st.KEPT_BY_HAND
    if not m.interruptable[b]:
        return st.KEPT_STUBBORN
    if is_timed_out(b, model, marks):
        return st.OUT_OF_TIME
    if not marks[st.READY, b]:
        return st.LOST_READINESS
    if below:
        return st.FELL_BELOW
    return st.CROWDED_OUT if 0 < m.max_parallel <= selected else st.KEPT_READY


@inlined
def reason_of_idle(b: int, marks: Ints, active: bool) -> int:
    """Return why a behaviour, `active` enough or not, cannot start whatever the others do, UNKNOWN if it can."""
    if not marks[st.ENABLED, b]:
        return st.DISABLED
    if not marks[st.READY, b]:
        return st.NOT_READY
    return st.UNKNOWN if active else st.BELOW_THRESHOLD


@inlined
def waiting_by_hand(marks: Ints, counted: Ints) -> int:
    """Return how many that are started by hand have not been counted yet."""
    waiting = 0
    for b in range(counted.shape[0]):
        by_hand = marks[st.PRESENT, b] and marks[st.MANUAL, b]
        waiting += 1 if by_hand and not counted[b] else 0
    return waiting


@inlined
def adapt_threshold(model: Handle[PackedModel], row_values: Floats, started: bool, idle: bool) -> None:
    """Raise the threshold when something started, lower it when something could run and nothing does."""
    decay = open_model(model).threshold_decay
    if started:
        row_values[st.THRESHOLD] /= decay
    elif idle:
        row_values[st.THRESHOLD] *= decay


@inlined
def anything_eligible(row: int, states: Handle[RowStates]) -> bool:
    """Whether a behaviour could start if only the threshold were low enough."""
    s = open_states(states)
    values, marks = s.values[row], s.marks[row]
    for b in range(marks.shape[1]):
        if is_operational(b, marks) and marks[st.READY, b] and values[st.ACTIVATION, b] > 0.0:
            return True
    return False


@inlined
def make_room(
    row: int, b: int, model: Handle[PackedModel], states: Written[RowStates], scratch: Handle[Scratch]
) -> int:
    """Stop the running behaviours that influence a sensor of `b`, if every one of them yields; else stop none.

    Returns how many of the `counted` were stopped, -1 if one does not yield.
    """
    s, counted, interruptable = open_states(states), open_scratch(scratch).counted, open_model(model).interruptable
    marks, activation = s.marks[row], s.values[row, st.ACTIVATION]
    priority, clashes = marks[st.PRIORITY, b], False
    for other in range(counted.shape[0]):
        if other == b or not marks[st.EXECUTING, other] or not influences_same(b, other, model, marks):
            continue
        clashes = True
        theirs = marks[st.PRIORITY, other]
        weaker = theirs == priority and activation[other] < activation[b]
        yields = interruptable[other] and not marks[st.MANUAL, other]
        if not (yields and (theirs < priority or weaker)):
            note_reason(b, marks, st.BLOCKED, other)
            return -1
    freed = 0
    if clashes:
        for other in range(counted.shape[0]):
            if other != b and marks[st.EXECUTING, other] and influences_same(b, other, model, marks):
                note_reason(other, marks, st.DISPLACED, b)
                stop(other, marks)
                freed += counted[other]
                counted[other] = 0
    return freed


@inlined
def influences_same(b: int, other: int, model: Handle[PackedModel], marks: Ints) -> bool:
    """Whether the two behaviours have effects on one sensor."""
    m = open_model(model)
    mine, others = marks[st.ALTERNATIVE, b], marks[st.ALTERNATIVE, other]
    for k in range(m.effect_first[b], m.effect_first[b + 1]):
        if m.effect_tag[k] >= 0 and m.effect_tag[k] != mine:
            continue
        for j in range(m.effect_first[other], m.effect_first[other + 1]):
            if m.effect_sensor[j] == m.effect_sensor[k] and (m.effect_tag[j] < 0 or m.effect_tag[j] == others):
                return True
    return False


@inlined
def stop(b: int, marks: Ints) -> None:
    """Stop behaviour `b`; it keeps its activation."""
    marks[st.EXECUTING, b] = 0
    marks[st.EXECUTION_TIME, b] = -1
    if marks[st.STARTED, b]:
        marks[st.STARTED, b] = 0
    else:
        marks[st.STOPPED, b] = 1


@inlined
def start(b: int, marks: Ints) -> None:
    """Start behaviour `b`."""
    marks[st.EXECUTING, b] = 1
    marks[st.EXECUTION_TIME, b] = 0
    marks[st.STARTED, b] = 1
    if marks.shape[0] == st.EXPLAINED_LAYERS:
        marks[st.REASON, b] = st.STARTED_BY_HAND if marks[st.MANUAL, b] else st.STARTED_READY
        marks[st.BY, b] = -1


@inlined
def note_reason(b: int, marks: Ints, reason: int, by: int) -> None:
    """Note why `b` runs or does not, in an explained network; what was stopped in this step keeps that reason."""
    if marks.shape[0] == st.EXPLAINED_LAYERS and not marks[st.STOPPED, b]:
        marks[st.REASON, b] = reason
        marks[st.BY, b] = by
