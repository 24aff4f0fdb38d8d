"""What holds for every model: rows are independent, the same life gives the same state, inputs stay as they are."""

import copy

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.network import BehaviourNetwork
from tests.selforg.network.random_models import Draw

ROWS, STEPS = 6, 25
SEEDS = range(12)


def drawn(seed):
    draw = Draw(np.random.default_rng(seed))
    model = draw.model()
    before, readings = [{s.name: 0.0 for s in draw.sensors}] * ROWS, np.zeros((STEPS, ROWS, len(draw.sensors)))
    for step in range(STEPS):
        before = [draw.readings(row) for row in before]
        readings[step] = [[row[s.name] for s in draw.sensors] for row in before]
    return model, readings


def everything(network):
    s = network.state
    arrays = (s.values, s.marks, s.row_values, s.goal_satisfaction, s.goal_enabled, s.wishes, s.wish_kept)
    return [a.copy() for a in arrays]


def lived(model, readings, rows=None):
    """Everything after each step of a network with the rows of `readings`."""
    network = BehaviourNetwork(model, readings.shape[1])
    history = []
    for now in readings:
        network.readings[:] = now
        network.step(rows)
        history.append(everything(network))
    return history


def of_rows(step, rows):
    return [array[rows] for array in step]


def assert_same(one, other):
    for step, (a, b) in enumerate(zip(one, other, strict=True)):
        for ours, theirs in zip(a, b, strict=True):
            np.testing.assert_array_equal(ours, theirs, err_msg=f"step {step}")


@pytest.mark.parametrize("seed", SEEDS)
def test_permuted_rows_give_permuted_results(seed):
    model, readings = drawn(seed)
    order = np.random.default_rng(seed).permutation(ROWS)
    straight, permuted = lived(model, readings), lived(model, readings[:, order])
    assert_same([of_rows(step, order) for step in straight], permuted)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_row_alone_lives_as_among_others(seed):
    model, readings = drawn(seed)
    together = lived(model, readings)
    for row in range(ROWS):
        assert_same([of_rows(step, [row]) for step in together], lived(model, readings[:, [row]]))


def test_only_the_rows_asked_for_are_stepped():
    model, readings = drawn(1)
    chosen = np.array([4, 1])
    history = lived(model, readings, chosen)
    assert_same([of_rows(step, chosen) for step in history], lived(model, readings[:, chosen]))
    others = of_rows(history[-1], [0, 2, 3, 5])
    assert_same([others], [of_rows(everything(BehaviourNetwork(model, ROWS)), [0, 2, 3, 5])])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_step_changes_neither_model_nor_readings(seed):
    model, readings = drawn(seed)
    before = copy.deepcopy(model.packed.record)
    network = BehaviourNetwork(model, ROWS)
    for now in readings:
        network.readings[:] = now
        network.step()
        np.testing.assert_array_equal(network.readings, now)
    for name, ours, theirs in zip(before._fields, before, model.packed.record, strict=True):
        np.testing.assert_array_equal(ours, theirs, err_msg=name)


@pytest.mark.parametrize("seed", SEEDS)
def test_reset_begins_anew(seed):
    model, readings = drawn(seed)
    network, rows = BehaviourNetwork(model, ROWS), np.array([0, 3])
    for now in readings:
        network.readings[:] = now
        network.step()
    before = everything(network)
    network.reset(rows)
    assert_same([of_rows(everything(network), rows)], [of_rows(everything(BehaviourNetwork(model, ROWS)), rows)])
    assert_same([of_rows(everything(network), [1, 2, 4, 5])], [of_rows(before, [1, 2, 4, 5])])


@pytest.mark.parametrize("seed", SEEDS)
def test_arbitration_keeps_its_promises(seed):
    model, readings = drawn(seed)
    limit, decay = model.settings.max_parallel, model.settings.threshold_decay
    threshold = np.full(ROWS, model.settings.activation_threshold)
    may_overrun = not all(b.interruptable for b in model.behaviours)
    for values, marks, row_values, *_ in lived(model, readings):
        running, started = marks[:, st.EXECUTING] == 1, marks[:, st.STARTED] == 1
        assert (running == (marks[:, st.EXECUTION_TIME] >= 0)).all()
        assert (marks[:, st.READY][started] == 1).all()
        assert (values[:, st.ACTIVATION] >= 0.0).all()
        assert (values[:, st.ACTIVATION] >= threshold[:, None])[started].all()
        assert limit is None or may_overrun or running.sum(axis=1).max() <= limit
        idle = ~running.any(axis=1)
        factor = np.where(started.any(axis=1), 1.0 / decay, np.where(idle, decay, 1.0))
        np.testing.assert_allclose(row_values[:, st.THRESHOLD], threshold * factor, rtol=1e-12)
        threshold = row_values[:, st.THRESHOLD]
