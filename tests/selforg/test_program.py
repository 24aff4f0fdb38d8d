"""Programs: compiled steps by address, steps in Python between them, and lists of rows that steps write."""

import copy
import gc
import os
import pickle
import re
import subprocess
import sys
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from selforg.arrays import KEPT, SCRATCH, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.compiler.switches import BY_ADDRESS
from selforg.program import ACT, FINISHING, LEAVE, SENSE, STOP, Program, Rows, Step, bits_of
from tests.paths import ROOT


class Tally(NamedTuple):
    """What rows have counted."""

    counts: Annotated[Floats, "R", KEPT]
    by: float


class Even(NamedTuple):
    """A list of rows."""

    listed: Annotated[Ints, "R", SCRATCH]
    length: Annotated[Ints, "1", SCRATCH]


open_tally, open_even = opening(Tally), opening(Even)


@lean_kernel
def count_rows(now: float, rows: Ints, tally: Written[Tally]) -> int:
    """Count `by` for each row; return how many counted more than 2 in all."""
    t, many = open_tally(tally), 0
    for row in rows:
        t.counts[row] += t.by
        many += t.counts[row] > 2.0
    return many


@lean_kernel
def list_even(now: float, rows: Ints, tally: Handle[Tally], even: Handle[Even]) -> int:
    """List those of `rows` that are even."""
    e = open_even(even)
    e.length[0] = 0
    for row in rows:
        if row % 2 == 0:
            e.listed[e.length[0]] = row
            e.length[0] += 1
    return 0


@lean_kernel
def answer_half(now: float, rows: Ints) -> float:
    return 0.5


class Counter:
    """Rows that count, even ones twice; rows that have counted enough are noted in Python."""

    def __init__(self, rows=4, by=1.0):
        self.tally, self.noted = Packed(Tally(np.zeros(rows), by)), []
        self.everyone = Rows.of(np.arange(rows))
        self.even = Packed(Even(np.zeros(rows, dtype=np.int64), np.zeros(1, dtype=np.int64)))
        self.program = Program(self.steps)

    def steps(self):
        return [
            Step(LEAVE, self.note, Rows(*self.even.record), count_rows, (self.tally,)),
            Step(ACT, list_even, self.everyone, list_even, (self.tally, self.even), always=True),
            Step(SENSE, self.note, self.everyone, count_rows, (self.tally,)),
            Step(LEAVE, self.note_even, Rows(*self.even.record)),
        ]

    def note(self, now, rows, many):
        self.noted.append((now, many))

    def note_even(self, now, rows):
        self.noted.append(rows.tolist())


def test_steps_run_by_stages_on_lists_that_steps_write_and_go_on_in_python():
    counter = Counter()
    counter.program.run(0.2)
    assert counter.tally.record.counts.tolist() == [2.0, 1.0, 2.0, 1.0]
    assert counter.noted == [[0, 2]]
    counter.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [4.0, 2.0, 4.0, 2.0]
    assert counter.noted[1:] == [(0.4, 2), (0.4, 2), [0, 2]]


def test_without_rows_only_steps_that_write_lists_are_called():
    counter = Counter()
    counter.program.run(0.2)
    counter.everyone.listed[0], counter.everyone.length[0] = 1, 1
    counter.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [2.0, 2.0, 2.0, 1.0]
    assert counter.noted == [[0, 2]]
    counter.everyone.length[0] = 0
    counter.program.run(0.6)
    assert counter.tally.record.counts.tolist() == [2.0, 2.0, 2.0, 1.0]


@pytest.mark.skipif(not BY_ADDRESS, reason="called by address only")
@pytest.mark.parametrize("order", [("even", "tally"), ("tally",), ("tally", "even", "even")])
def test_records_of_another_class_or_number_than_the_kernel_takes_are_one_line(order):
    packed = {"tally": Packed(Tally(np.zeros(2), 1.0)), "even": Packed(Even(*Rows.of(np.arange(2))))}
    records = tuple(packed[name] for name in order)
    line = f"expected the records ['Tally', 'Even'], got {[name.title() for name in order]}"
    steps = [Step(SENSE, list_even, Rows.of(np.arange(2)), list_even, records)]
    with pytest.raises(TypeError, match=re.escape(line)):
        Program(lambda: steps).run(0.2)


@pytest.mark.skipif(not BY_ADDRESS, reason="called by address only")
@pytest.mark.parametrize(("listed", "length"), [(np.arange(4), 4), (np.array([3]), 4), (np.zeros(5, np.int64), 5)])
def test_an_array_that_is_shorter_than_the_rows_of_its_step_is_one_line(listed, length):
    steps = [Step(SENSE, count_rows, Rows.of(listed), count_rows, (Packed(Tally(np.zeros(3), 1.0)),))]
    line = f"step count_rows: expected at least {length} rows in Tally.counts, got 3"
    with pytest.raises(ValueError, match=f"^{line}$"):
        Program(lambda: steps).run(0.2)


def test_records_that_replace_others_have_as_many_rows():
    packed = Packed(Tally(np.zeros(4), 1.0))
    with pytest.raises(ValueError, match=r"^Tally\.counts: expected at least 4 rows, got 2$"):
        packed.replace(Tally(np.zeros(2), 1.0))
    assert len(packed.record.counts) == 4


def test_a_stage_can_be_left_out():
    counter = Counter()
    counter.program.run(0.2, bits_of([SENSE]))
    assert counter.tally.record.counts.tolist() == [1.0, 0.0, 1.0, 0.0]
    counter.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [3.0, 1.0, 3.0, 1.0]


@pytest.mark.parametrize(("stops", "times"), [(9, 4), (3, 3), (1, 1)])
def test_steps_are_repeated_at_the_times_that_one_of_them_counts_until_python_stops(stops, times):
    counter, ticks, told = Counter(), np.full(1, 5), []

    def tick(now, rows):
        ticks[0] += 1

    def end(now, rows):
        told.append(round(now, 9))
        return STOP if len(told) == stops else None

    rows = Rows.of(np.arange(1))
    steps = [*counter.steps(), Step(SENSE, tick, rows), Step(FINISHING, end, rows)]
    Program(lambda: steps).repeat(ticks, 0.2, 4)
    assert told == [1.0, 1.2, 1.4, 1.6][:times]
    assert ticks[0] == 5 + times
    assert counter.tally.record.counts.tolist() == [2.0 * times, times, 2.0 * times, times]


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_runs_on_its_own_arrays_also_without_its_original(duplicate):
    counter = Counter()
    counter.program.run(0.2)
    other = duplicate(counter)
    other.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [2.0, 1.0, 2.0, 1.0]
    del counter
    gc.collect()
    other.program.run(0.6)
    assert other.tally.record.counts.tolist() == [6.0, 3.0, 6.0, 3.0]


def test_a_program_reads_a_record_that_took_the_place_of_another():
    counter = Counter()
    counter.program.run(0.2)
    before = counter.tally.record.counts
    counter.tally.replace(Tally(np.full(4, 10.0), 5.0))
    gc.collect()
    counter.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [20.0, 15.0, 20.0, 15.0]
    assert before.tolist() == [2.0, 1.0, 2.0, 1.0]
    with pytest.raises(TypeError, match=r"Tally\.counts: expected a C-contiguous float64 array"):
        counter.tally.replace(Tally(np.zeros(4, dtype=np.int64), 1.0))
    counter.program.run(0.6)
    assert counter.tally.record.counts[1] == 20.0


def test_an_error_of_a_step_in_python_ends_the_run_and_the_next_one_begins_anew():
    counter = Counter()
    counter.note_even = lambda now, rows: 1 // 0
    with pytest.raises(ZeroDivisionError):
        counter.program.run(0.2)
    with pytest.raises(ZeroDivisionError):
        counter.program.run(0.4)
    assert counter.tally.record.counts.tolist() == [4.0, 2.0, 4.0, 2.0]


@pytest.mark.skipif(not BY_ADDRESS, reason="nothing is called by address")
def test_what_cannot_be_called_by_address_is_refused():
    everyone = Rows.of(np.arange(2))
    with pytest.raises(TypeError, match="step answer_half: expected a result of int64, got float64"):
        Program(lambda: [Step(ACT, print, everyone, answer_half)]).run(0.0)


CHECKED = """
from tests.selforg.test_program import Counter, copy, count_rows, gc, pickle
counter = Counter()
counter.program.run(0.2)
for duplicate in (copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))):
    counter = duplicate(counter)
    gc.collect()
    counter.program.run(0.4)
print(counter.tally.record.counts.tolist())
count_rows(0.6, counter.everyone.now, counter.even.handle)
"""


@pytest.mark.skipif(not BY_ADDRESS, reason="nothing is called by address")
def test_records_of_steps_are_checked_where_that_is_asked_for_and_copies_have_the_right_ones():
    environment = {**os.environ, "CLEAN_SWARM_CHECK_RECORDS": "1"}
    done = subprocess.run([sys.executable, "-c", CHECKED], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.stdout.splitlines() == ["[6.0, 3.0, 6.0, 3.0]"]
    assert done.stderr.splitlines()[-1] == "TypeError: this is not the handle of a record Tally"
