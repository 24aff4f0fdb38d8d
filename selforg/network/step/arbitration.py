"""Which behaviours run after this step (compiled)."""

from __future__ import annotations

from selforg.compiler.decorators import inlined
from selforg.network.model import packed as t
from selforg.network.model.packed import Floats, Ints, begin_of, float_begin_of
from selforg.network.state import reasons as why
from selforg.network.state import state as st
from selforg.network.step.sharing import operational


@inlined
def order_by_activation(row: int, values: Floats, order: Ints) -> None:
    """Fill `order` (B,) with the behaviours of `row` in falling activation; ties keep the order of registration."""
    for b in range(order.shape[0]):
        k = b
        while k > 0 and values[row, st.ACTIVATION, order[k - 1]] < values[row, st.ACTIVATION, b]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = b


@inlined
def explain(row: int, b: int, marks: Ints, reason: int, by: int) -> None:
    """Note why `b` runs or does not, in an explained network; what was stopped in this step keeps that reason."""
    if marks.shape[1] == st.EXPLAINED_LAYERS and not marks[row, st.STOPPED, b]:
        marks[row, st.REASON, b] = reason
        marks[row, st.BY, b] = by


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
        marks[row, st.REASON, b] = why.STARTED_BY_HAND if marks[row, st.MANUAL, b] else why.STARTED
        marks[row, st.BY, b] = -1


@inlined
def influences_same(row: int, b: int, other: int, ints: Ints, marks: Ints) -> bool:
    """Whether the two behaviours have effects on one sensor."""
    first, sensor, tag = begin_of(ints, t.EFFECT_FIRST), begin_of(ints, t.EFFECT_SENSOR), begin_of(ints, t.EFFECT_TAG)
    mine, others = marks[row, st.ALTERNATIVE, b], marks[row, st.ALTERNATIVE, other]
    for k in range(ints[first + b], ints[first + b + 1]):
        if ints[tag + k] >= 0 and ints[tag + k] != mine:
            continue
        for j in range(ints[first + other], ints[first + other + 1]):
            if ints[sensor + j] == ints[sensor + k] and (ints[tag + j] < 0 or ints[tag + j] == others):
                return True
    return False


@inlined
def make_room(row: int, b: int, ints: Ints, values: Floats, marks: Ints, counted: Ints) -> int:
    """Stop the running behaviours that influence a sensor of `b`, if every one of them yields; else leave all.

    Returns how many of the `counted` were stopped, -1 if one does not yield.
    """
    interruptable = begin_of(ints, t.INTERRUPTABLE)
    priority, activation = marks[row, st.PRIORITY, b], values[row, st.ACTIVATION, b]
    clashes = False
    for other in range(counted.shape[0]):
        if other == b or not marks[row, st.EXECUTING, other] or not influences_same(row, b, other, ints, marks):
            continue
        clashes = True
        theirs = marks[row, st.PRIORITY, other]
        weaker = theirs == priority and values[row, st.ACTIVATION, other] < activation
        yields = ints[interruptable + other] and not marks[row, st.MANUAL, other]
        if not (yields and (theirs < priority or weaker)):
            explain(row, b, marks, why.BLOCKED, other)
            return -1
    freed = 0
    if clashes:
        for other in range(counted.shape[0]):
            if other != b and marks[row, st.EXECUTING, other] and influences_same(row, b, other, ints, marks):
                explain(row, other, marks, why.DISPLACED, b)
                stop(row, other, marks)
                freed += counted[other]
                counted[other] = 0
    return freed


@inlined
def is_timed_out(row: int, b: int, ints: Ints, marks: Ints) -> bool:
    """Whether a running behaviour has used up its time."""
    timeout = ints[begin_of(ints, t.TIMEOUT) + b]
    return bool(timeout >= 0 and marks[row, st.EXECUTION_TIME, b] >= timeout)


@inlined
def keeps_running(row: int, b: int, ints: Ints, values: Floats, marks: Ints, threshold: float, selected: int) -> bool:
    """Whether a running behaviour goes on."""
    limit = ints[begin_of(ints, t.OPTIONS) + 1]
    if marks[row, st.MANUAL, b] or not ints[begin_of(ints, t.INTERRUPTABLE) + b]:
        return True
    if is_timed_out(row, b, ints, marks) or not marks[row, st.READY, b]:
        return False
    return bool(values[row, st.ACTIVATION, b] >= threshold and not (limit > 0 and selected >= limit))


@inlined
def explain_running(row: int, b: int, ints: Ints, values: Floats, marks: Ints, threshold: float, keeps: bool) -> None:
    """Note why a running behaviour goes on or not."""
    if marks[row, st.MANUAL, b]:
        reason = why.KEPT_BY_HAND
    elif not ints[begin_of(ints, t.INTERRUPTABLE) + b]:
        reason = why.KEPT_STUBBORN
    elif keeps:
        reason = why.KEPT
    elif is_timed_out(row, b, ints, marks):
        reason = why.TIMED_OUT
    elif not marks[row, st.READY, b]:
        reason = why.LOST_READINESS
    else:
        reason = why.FELL_BELOW if values[row, st.ACTIVATION, b] < threshold else why.CROWDED_OUT
    explain(row, b, marks, reason, -1)


@inlined
def explain_idle(row: int, b: int, marks: Ints) -> None:
    """Note why a behaviour cannot start whatever the others do."""
    if not marks[row, st.ENABLED, b]:
        reason = why.DISABLED
    else:
        reason = why.BELOW_THRESHOLD if marks[row, st.READY, b] else why.NOT_READY
    explain(row, b, marks, reason, -1)


@inlined
def waiting_by_hand(row: int, marks: Ints, counted: Ints) -> int:
    """How many that are started by hand have not been counted yet."""
    waiting = 0
    for b in range(counted.shape[0]):
        by_hand = marks[row, st.PRESENT, b] and marks[row, st.MANUAL, b]
        waiting += 1 if by_hand and not counted[b] else 0
    return waiting


@inlined
def select_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, advance: bool, counted: Ints,
    order: Ints,
) -> bool:  # fmt: skip
    """One pass of selection for `row`, in falling activation; returns whether anything runs afterwards.

    `counted` and `order` are scratch (B,). With `advance` the time of what keeps running goes on.
    """
    threshold, limit = row_values[row, st.THRESHOLD], ints[begin_of(ints, t.OPTIONS) + 1]
    row_values[row, st.DECIDING] = threshold
    order_by_activation(row, values, order)
    for b in range(counted.shape[0]):
        counted[b] = 0
    explained = marks.shape[1] == st.EXPLAINED_LAYERS
    selected, any_started, any_operational = 0, False, False
    for b in order:
        if not marks[row, st.PRESENT, b]:
            continue
        any_operational = any_operational or marks[row, st.ENABLED, b] == 1
        if marks[row, st.EXECUTING, b]:
            keeps = keeps_running(row, b, ints, values, marks, threshold, selected)
            if explained:
                explain_running(row, b, ints, values, marks, threshold, keeps)
            if not keeps:
                stop(row, b, marks)
                continue
            marks[row, st.EXECUTION_TIME, b] += 1 if advance else 0
        else:
            if not marks[row, st.MANUAL, b]:
                if not (
                    marks[row, st.ENABLED, b] and marks[row, st.READY, b] and values[row, st.ACTIVATION, b] >= threshold
                ):
                    if explained:
                        explain_idle(row, b, marks)
                    continue
                freed = make_room(row, b, ints, values, marks, counted)
                selected -= max(freed, 0)
                if freed < 0 or (limit > 0 and selected + waiting_by_hand(row, marks, counted) >= limit):
                    if explained and freed >= 0:
                        explain(row, b, marks, why.NO_PLACE, -1)
                    continue
            start(row, b, marks)
            any_started = True
        counted[b] = 1
        selected += 1
    any_running = False
    for b in range(counted.shape[0]):
        any_running = any_running or marks[row, st.EXECUTING, b] == 1
    adapt_threshold(row, floats, row_values, any_started, any_operational and not any_running)
    return any_running


@inlined
def adapt_threshold(row: int, floats: Floats, row_values: Floats, started: bool, idle: bool) -> None:
    """Raise the threshold when something started, lower it when something could run and nothing does."""
    decay = floats[float_begin_of(floats, t.DYNAMICS) + 1]
    if started:
        row_values[row, st.THRESHOLD] /= decay
    elif idle:
        row_values[row, st.THRESHOLD] *= decay


@inlined
def anything_eligible(row: int, values: Floats, marks: Ints) -> bool:
    """Whether a behaviour could start if only the threshold were low enough."""
    for b in range(values.shape[2]):
        if operational(row, b, marks) and marks[row, st.READY, b] and values[row, st.ACTIVATION, b] > 0.0:
            return True
    return False


@inlined
def arbitrate_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, guarantee: bool,
    counted: Ints, order: Ints,
) -> bool:  # fmt: skip
    """Stop and start behaviours of `row`; with `guarantee`, again until something runs or nothing could.

    Returns whether a behaviour had used up its time.
    """
    timed_out = False
    for b in range(counted.shape[0]):
        timed_out = timed_out or (marks[row, st.EXECUTING, b] == 1 and is_timed_out(row, b, ints, marks))
        marks[row, st.STARTED, b] = 0
        marks[row, st.STOPPED, b] = 0
    first, again = True, True
    while again:
        before = row_values[row, st.THRESHOLD]
        running = select_row(row, ints, floats, values, marks, row_values, first, counted, order)
        # a threshold that does not fall lets nothing start, ever
        falls = first or row_values[row, st.THRESHOLD] != before
        again = guarantee and not running and falls and anything_eligible(row, values, marks)
        first = False
    return timed_out
