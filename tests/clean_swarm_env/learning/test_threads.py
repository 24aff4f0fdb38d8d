"""Worlds in blocks that several threads step: the same bits, whole errors, whole interruptions."""

import gc
import hashlib
import os
import signal
import threading
import time

import numpy as np
import pytest

from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv
from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.joined import Joined, batches_of, in_threads
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState
from clean_swarm_env.world.task import Task
from selforg.mechanisms import MECHANISMS, MovementMechanism
from selforg.mechanisms.formula import FormulaMechanism
from selforg.plugins import PluginError
from tests.clean_swarm_env.courses import begun, mission

WORLDS = 5
SHORT = mission(garbage={"count": 2}, time_limit=12.0)


def course_of(joined, steps=20, state=None):
    """Return the hash of what a learner sees in some steps from a reset or a state on, and how many missions end."""
    seen = joined.reset(range(joined.count)) if state is None else joined.set_state(state)
    digest, rng, ended = hashlib.sha256(seen.tobytes()), np.random.default_rng(3), 0
    for _ in range(steps):
        step = joined.step(rng.integers(0, joined.batches[0].choices.counts[0], joined.rows))
        ended += len(joined.finished)
        for array in (*step, joined.masks()):
            digest.update(array.tobytes())
        digest.update(repr([(end.world, end.scenario.seed, end.result) for end in joined.finished]).encode())
    return digest.hexdigest(), ended


def test_any_number_of_threads_gives_the_same_bits():
    each = [Joined(batches_of(SHORT, WORLDS, threads), threads) for threads in (1, 2, 3, 5)]
    courses = {course_of(joined) for joined in each}
    assert len(courses) == 1
    assert courses.pop()[1] > 0, "missions end and begin anew"
    states = [joined.get_state() for joined in each]
    crossed = {course_of(joined, state=state) for joined, state in zip(each, reversed(states), strict=True)}
    assert len(crossed) == 1, "a state goes on in any number of threads"
    one = each[1].get_state([3])
    assert np.array_equal(each[2].set_state(one, [4])[20:], each[1].set_state(one, [0])[:5])


def test_more_threads_than_worlds_are_no_mistake_and_none_is():
    assert [batch.count for batch in batches_of(SHORT, 2, 7)] == [1, 1]
    with pytest.raises(ValueError, match="threads: expected a whole number of at least 1, got 0"):
        batches_of(SHORT, 2, 0)


def test_worlds_with_a_source_and_recorded_ones_stay_together(tmp_path):
    assert len(batches_of(SHORT, 2, 2, record=RecordSettings(tmp_path))) == 1
    assert len(batches_of(SHORT, 2, 2, source=lambda world: None)) == 1
    with pytest.raises(ValueError, match=r"^size: expected one torus for worlds that are recorded or have a source"):
        batches_of("unseen", 4, record=RecordSettings(tmp_path))


def test_a_family_has_blocks_of_each_torus():
    parts = batches_of("unseen", 7, 2)
    assert sum(batch.count for batch in parts) == 7
    assert len(parts) == 2 * len(batches_of("unseen", 7))
    assert RobotVectorEnv(7, "unseen").num_envs == sum(batch.rows for batch in parts)


def test_a_wrong_action_moves_no_world():
    joined = begun(Joined(batches_of(SHORT, 4, 2), 2), range(4))
    before = [batch.get_state() for batch in joined.batches]
    wrong = np.zeros(joined.rows, dtype=np.int64)
    wrong[-1] = 99
    with pytest.raises(ValueError, match="expected 0"):
        joined.step(wrong)
    assert [batch.get_state() for batch in joined.batches] == before


def test_an_error_of_one_call_waits_for_the_others():
    ended = []

    def fail():
        raise ValueError("one")

    def last():
        time.sleep(0.2)
        ended.append(True)

    with pytest.raises(ValueError, match="one"):
        in_threads([fail, last], 2)
    assert ended == [True]


def test_ctrl_c_waits_for_the_end_of_the_step():
    ended, main = [], threading.main_thread().ident

    def interrupt():
        time.sleep(0.1)
        signal.pthread_kill(main, signal.SIGINT)

    def last():
        time.sleep(0.5)
        ended.append(True)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # the tests may have been told to ignore it
    try:
        with pytest.raises(KeyboardInterrupt):
            in_threads([interrupt, last], 2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended == [True]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_makes_threads_of_its_own():
    assert in_threads([os.getpid] * 2, 2) == [os.getpid()] * 2
    child = os.fork()
    if child == 0:
        os._exit(0 if in_threads([os.getpid] * 2, 2) == [os.getpid()] * 2 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_one_batch_is_stepped_in_the_thread_of_the_caller():
    joined, threads = begun(Joined([Batch(SHORT)], 3), [1]), []
    joined.batches[0].rewards.of = lambda *_: threads.append(threading.current_thread())
    joined.step(np.zeros(joined.rows, dtype=np.int64))
    assert threads == [threading.main_thread()]


class Wandering(MovementMechanism):
    """Robots go ahead; something goes wrong where `wrong` is set."""

    wrong = None

    def move_into(self, now, rows, vectors, active):
        active[rows], vectors[rows] = True, 0.3
        if Wandering.wrong is not None:
            Wandering.wrong(rows, vectors)


class Uncountable(FormulaMechanism):
    """A sum that is no number."""

    @staticmethod
    def formula(pair):
        return np.nan


OWN = """
parameters: {view_distance: 2.0}
mechanisms: {own: {type: %s, parameters: {view_distance: $view_distance}}}
sensors: {there: {type: VectorPresent, mechanism: own}}
behaviours:
  Go:
    action: {type: Move, mechanism: own}
    preconditions: [{sensor: there, activator: {type: Boolean}}]
    effects: [{sensor: there, change: -1.0}]
"""


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(
    ("kind", "wrong", "line"),
    [
        (Wandering, lambda rows, vectors: vectors.fill(np.nan), "Wandering.move_into: expected finite vectors"),
        (Wandering, lambda rows, vectors: vectors[9999], r"test_threads.py:\d+: IndexError"),
        (Uncountable, None, "Uncountable.move_into: expected finite vectors"),
    ],
)
def test_a_mechanism_of_ones_own_that_fails_is_one_line(threads, kind, wrong, line, tmp_path, monkeypatch):
    monkeypatch.setattr(MECHANISMS, "_classes", dict(MECHANISMS._classes))
    MECHANISMS.register(kind)
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "RepulsionFernandez.yaml").write_text(OWN % kind.__name__)
    parts = batches_of(SHORT, 2 * threads, threads, directories=(tmp_path,))
    joined = begun(Joined(parts, threads), range(2 * threads))
    options = np.zeros(joined.rows, dtype=np.int64)
    if wrong is not None:
        joined.step(options)
        monkeypatch.setattr(kind, "wrong", staticmethod(wrong))
    with pytest.raises(PluginError, match=line) as raised:
        _ = [joined.step(options) for _ in range(20)]
    assert "\n" not in str(raised.value)


class Failing(Task[TaskSettings, TaskState]):
    """Robots wait; something goes wrong in a tick of some worlds."""

    measures = (Measure("waited", "s", "higher", 2.0, "half of the time"),)
    goal = "CollectiveExploration"
    wrong = None
    """What then happens to the task, if anything."""

    def result(self):
        return {"waited": self.world.ticks * 0.2}

    def after_moving(self):
        if Failing.wrong is not None and self.world.worlds == 2 and self.world.ticks[0] == 8:
            Failing.wrong(self)


def _raised(error):
    def fail(task):
        raise error

    return fail


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        (_raised(KeyError("lost")), r"test_threads.py:\d+: KeyError: 'lost'"),
        (_raised(SystemExit(0)), r"test_threads.py:\d+: SystemExit: 0"),
        (lambda task: task.world.positions.fill(np.nan), "Failing.after_moving: expected robots and things to be at"),
        (_raised(KeyboardInterrupt()), "^$"),
    ],
)
def test_a_step_in_python_that_fails_is_one_line_and_a_state_before_goes_on_with_the_same_bits(
    threads, wrong, line, monkeypatch
):
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    TASKS.register(Failing)
    joined = begun(Joined(batches_of("Failing", 2 * threads, threads), threads), range(2 * threads))
    options = np.zeros(joined.rows, dtype=np.int64)
    joined.step(options)
    state = joined.get_state()
    expected = course_of(joined, 5, state)
    joined.set_state(state)
    monkeypatch.setattr(Failing, "wrong", staticmethod(wrong))
    with pytest.raises(KeyboardInterrupt if line == "^$" else PluginError, match=line) as raised:
        joined.step(options)
    assert "\n" not in str(raised.value)
    monkeypatch.setattr(Failing, "wrong", None)
    gc.collect()
    assert course_of(joined, 5, state) == expected
