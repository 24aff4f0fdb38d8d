"""Which behaviours run after this step (compiled)."""

from __future__ import annotations

from selforg.compiled import kernel
from selforg.network import reasons as why
from selforg.network import state as st
from selforg.network import tables as t
from selforg.network.sharing import operational
from selforg.network.tables import Floats, Ints, floats_of, ints_of


@kernel
def order_by_activation(activation: Floats, order: Ints) -> None:
    """Fill `order` (B,) with the behaviours in falling activation; ties keep the order of registration."""
    for b in range(activation.shape[0]):
        k = b
        while k > 0 and activation[order[k - 1]] < activation[b]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = b


@kernel
def explain(row: int, b: int, marks: Ints, reason: int, by: int) -> None:
    """Note why `b` runs or does not, in an explained network; what was stopped in this step keeps that reason."""
    if marks.shape[0] == st.EXPLAINED_LAYERS and not marks[st.STOPPED, row, b]:
        marks[st.REASON, row, b] = reason
        marks[st.BY, row, b] = by


@kernel
def stop(row: int, b: int, marks: Ints) -> None:
    """Stop behaviour `b`; it keeps its activation."""
    marks[st.EXECUTING, row, b] = 0
    marks[st.EXECUTION_TIME, row, b] = -1
    if marks[st.STARTED, row, b]:
        marks[st.STARTED, row, b] = 0
    else:
        marks[st.STOPPED, row, b] = 1


@kernel
def start(row: int, b: int, marks: Ints) -> None:
    """Start behaviour `b`."""
    marks[st.EXECUTING, row, b] = 1
    marks[st.EXECUTION_TIME, row, b] = 0
    marks[st.STARTED, row, b] = 1
    if marks.shape[0] == st.EXPLAINED_LAYERS:
        marks[st.REASON, row, b] = why.STARTED_BY_HAND if marks[st.MANUAL, row, b] else why.STARTED
        marks[st.BY, row, b] = -1


@kernel
def influences_same(row: int, b: int, other: int, ints: Ints, marks: Ints) -> bool:
    """Whether the two behaviours have effects on one sensor."""
    first, sensor, tag = ints_of(ints, t.EFFECT_FIRST), ints_of(ints, t.EFFECT_SENSOR), ints_of(ints, t.EFFECT_TAG)
    alternative = marks[st.ALTERNATIVE, row]
    for k in range(first[b], first[b + 1]):
        if tag[k] >= 0 and tag[k] != alternative[b]:
            continue
        for j in range(first[other], first[other + 1]):
            if sensor[j] == sensor[k] and (tag[j] < 0 or tag[j] == alternative[other]):
                return True
    return False


@kernel
def make_room(row: int, b: int, ints: Ints, values: Floats, marks: Ints, counted: Ints) -> int:
    """Stop the running behaviours that influence a sensor of `b`, if every one of them yields; else leave all.

    Returns how many of the `counted` were stopped, -1 if one does not yield.
    """
    interruptable = ints_of(ints, t.INTERRUPTABLE)
    priority, activation = marks[st.PRIORITY, row], values[st.ACTIVATION, row]
    clashes = False
    for other in range(counted.shape[0]):
        if other == b or not marks[st.EXECUTING, row, other] or not influences_same(row, b, other, ints, marks):
            continue
        clashes = True
        weaker = priority[other] == priority[b] and activation[other] < activation[b]
        yields = interruptable[other] and not marks[st.MANUAL, row, other]
        if not (yields and (priority[other] < priority[b] or weaker)):
            explain(row, b, marks, why.BLOCKED, other)
            return -1
    freed = 0
    if clashes:
        for other in range(counted.shape[0]):
            if other != b and marks[st.EXECUTING, row, other] and influences_same(row, b, other, ints, marks):
                explain(row, other, marks, why.DISPLACED, b)
                stop(row, other, marks)
                freed += counted[other]
                counted[other] = 0
    return freed


@kernel
def is_timed_out(row: int, b: int, ints: Ints, marks: Ints) -> bool:
    """Whether a running behaviour has used up its time."""
    timeout = ints_of(ints, t.TIMEOUT)[b]
    return bool(timeout >= 0 and marks[st.EXECUTION_TIME, row, b] >= timeout)


@kernel
def keeps_running(row: int, b: int, ints: Ints, values: Floats, marks: Ints, threshold: float, selected: int) -> bool:
    """Whether a running behaviour goes on."""
    limit = ints_of(ints, t.OPTIONS)[1]
    if marks[st.MANUAL, row, b] or not ints_of(ints, t.INTERRUPTABLE)[b]:
        return True
    if is_timed_out(row, b, ints, marks) or not marks[st.READY, row, b]:
        return False
    return bool(values[st.ACTIVATION, row, b] >= threshold and not (limit > 0 and selected >= limit))


@kernel
def explain_running(row: int, b: int, ints: Ints, values: Floats, marks: Ints, threshold: float, keeps: bool) -> None:
    """Note why a running behaviour goes on or not."""
    if marks[st.MANUAL, row, b]:
        reason = why.KEPT_BY_HAND
    elif not ints_of(ints, t.INTERRUPTABLE)[b]:
        reason = why.KEPT_STUBBORN
    elif keeps:
        reason = why.KEPT
    elif is_timed_out(row, b, ints, marks):
        reason = why.TIMED_OUT
    elif not marks[st.READY, row, b]:
        reason = why.LOST_READINESS
    else:
        reason = why.FELL_BELOW if values[st.ACTIVATION, row, b] < threshold else why.CROWDED_OUT
    explain(row, b, marks, reason, -1)


@kernel
def explain_idle(row: int, b: int, marks: Ints) -> None:
    """Note why a behaviour cannot start whatever the others do."""
    if not marks[st.ENABLED, row, b]:
        reason = why.DISABLED
    else:
        reason = why.BELOW_THRESHOLD if marks[st.READY, row, b] else why.NOT_READY
    explain(row, b, marks, reason, -1)


@kernel
def waiting_by_hand(row: int, marks: Ints, counted: Ints) -> int:
    """How many that are started by hand have not been counted yet."""
    waiting = 0
    for b in range(counted.shape[0]):
        by_hand = marks[st.PRESENT, row, b] and marks[st.MANUAL, row, b]
        waiting += 1 if by_hand and not counted[b] else 0
    return waiting


@kernel
def select_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, advance: bool, counted: Ints,
    order: Ints,
) -> bool:  # fmt: skip
    """One pass of selection for `row`, in falling activation; returns whether anything runs afterwards.

    `counted` and `order` are scratch (B,). With `advance` the time of what keeps running goes on.
    """
    threshold, limit = row_values[st.THRESHOLD, row], ints_of(ints, t.OPTIONS)[1]
    row_values[st.DECIDING, row] = threshold
    executing, activation = marks[st.EXECUTING, row], values[st.ACTIVATION, row]
    order_by_activation(activation, order)
    counted[:] = 0
    explained = marks.shape[0] == st.EXPLAINED_LAYERS
    selected, any_started, any_operational = 0, False, False
    for b in order:
        if not marks[st.PRESENT, row, b]:
            continue
        any_operational = any_operational or marks[st.ENABLED, row, b] == 1
        if executing[b]:
            keeps = keeps_running(row, b, ints, values, marks, threshold, selected)
            if explained:
                explain_running(row, b, ints, values, marks, threshold, keeps)
            if not keeps:
                stop(row, b, marks)
                continue
            marks[st.EXECUTION_TIME, row, b] += 1 if advance else 0
        else:
            if not marks[st.MANUAL, row, b]:
                if not (marks[st.ENABLED, row, b] and marks[st.READY, row, b] and activation[b] >= threshold):
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
    for b in range(executing.shape[0]):
        any_running = any_running or executing[b] == 1
    adapt_threshold(row, floats, row_values, any_started, any_operational and not any_running)
    return any_running


@kernel
def adapt_threshold(row: int, floats: Floats, row_values: Floats, started: bool, idle: bool) -> None:
    """Raise the threshold when something started, lower it when something could run and nothing does."""
    decay = floats_of(floats, t.DYNAMICS)[1]
    if started:
        row_values[st.THRESHOLD, row] /= decay
    elif idle:
        row_values[st.THRESHOLD, row] *= decay


@kernel
def anything_eligible(row: int, values: Floats, marks: Ints) -> bool:
    """Whether a behaviour could start if only the threshold were low enough."""
    for b in range(values.shape[2]):
        if operational(marks, row, b) and marks[st.READY, row, b] and values[st.ACTIVATION, row, b] > 0.0:
            return True
    return False


@kernel
def arbitrate_row(
    row: int, ints: Ints, floats: Floats, values: Floats, marks: Ints, row_values: Floats, guarantee: bool,
    counted: Ints, order: Ints,
) -> bool:  # fmt: skip
    """Stop and start behaviours of `row`; with `guarantee`, again until something runs or nothing could.

    Returns whether a behaviour had used up its time.
    """
    timed_out = False
    for b in range(counted.shape[0]):
        timed_out = timed_out or (marks[st.EXECUTING, row, b] == 1 and is_timed_out(row, b, ints, marks))
        marks[st.STARTED, row, b] = 0
        marks[st.STOPPED, row, b] = 0
    running = select_row(row, ints, floats, values, marks, row_values, True, counted, order)
    while guarantee and not running and anything_eligible(row, values, marks):
        before = row_values[st.THRESHOLD, row]
        running = select_row(row, ints, floats, values, marks, row_values, False, counted, order)
        if row_values[st.THRESHOLD, row] == before:  # a threshold that does not fall lets nothing start, ever
            break
    return timed_out
