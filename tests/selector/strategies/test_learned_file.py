import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import safetensors.numpy

from selector.documents.arrays import load_arrays, save_arrays
from selector.documents.errors import DocumentError
from selector.knowledge import Definition
from selector.strategies.learned_file import description_of, load_strategy, save_strategy
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create
from selector.strategies.streams import row_keys
from tests.selector.refusing import refusal

PROBLEM = Problem("Goal", ("a", "b", "c"), np.array([1.0, 2.0, 3.0]), ("x", "y"))
LEARNING = sorted(set(STRATEGIES.names()) - {"Fixed", "MaxScore", "Random"})


def made(name, parameters=None, *, problem=PROBLEM, rows=6, groups=None, seed=1):
    return create(name, problem, row_keys(np.random.SeedSequence(seed), rows), parameters, groups=groups)


def live(strategy, steps=20, seed=0):
    generator, chosen = np.random.default_rng(seed), []
    for _ in range(steps):
        context = generator.normal(size=(strategy.rows, 2))
        chosen.append(strategy.select(context))
        strategy.update(chosen[-1], generator.normal(size=strategy.rows) + chosen[-1], context)
    return np.array(chosen)


@pytest.mark.parametrize("name", LEARNING)
def test_a_strategy_goes_on_from_a_file_exactly(tmp_path, name):
    first, second = made(name), made(name, seed=2)
    live(first)
    save_strategy(tmp_path / "learned", first)
    load_strategy(tmp_path / "learned", second)
    first.reseed(np.arange(first.rows), second.keys)
    np.testing.assert_array_equal(live(first, seed=1), live(second, seed=1))
    for key, value in first.learned().items():
        np.testing.assert_array_equal(second.learned()[key], value)


@pytest.mark.parametrize("name", LEARNING)
def test_what_was_learned_serves_any_number_of_robots(tmp_path, name):
    first = made(name, {"prior": 2.0})
    live(first)
    save_strategy(tmp_path / "learned", first)
    assert description_of(tmp_path / "learned").spec.name == name
    assert description_of(tmp_path / "learned").spec.parameters["prior"] == 2.0
    for groups in (None, np.arange(9)):
        second = made(name, description_of(tmp_path / "learned").spec.parameters, rows=9, groups=groups)
        load_strategy(tmp_path / "learned", second)
        for key, value in second.learned().items():
            np.testing.assert_array_equal(value, np.broadcast_to(first.learned()[key], value.shape))
    load_strategy(tmp_path / "learned", made(name, {"prior": 2.0}))  # a file is not used up


def means(configuration):
    return {"Goal": {"a": Definition(configuration=configuration)}}


def other(**changes):
    return Problem(
        **({field: getattr(PROBLEM, field) for field in ("goal", "options", "scores", "features")} | changes)
    )


@pytest.mark.parametrize(
    ("strategy", "message"),
    [
        (lambda: made("EpsilonGreedy"), "strategy: expected EpsilonGreedy, got UCB1"),
        (lambda: made("UCB1", {"prior": 7.0}), r"parameters: expected .*'prior': 7\.0.*, got .*'prior': 1\.0"),
        (lambda: made("UCB1", problem=other(goal="Else")), "goal: expected Else, got Goal"),
        (
            lambda: made("UCB1", problem=other(options=("a", "b", "d"))),
            "options: does not know d; knows c, which does not exist here",
        ),
        (
            lambda: made("UCB1", problem=other(options=("b", "a", "c"))),
            "options: expected the order b, a, c, got a, b, c",
        ),
        (lambda: made("UCB1", problem=other(features=("x",))), "features: knows y, which does not exist here"),
        (lambda: made("UCB1", problem=other(definitions=means("B"))), "Goal: option 'a': expected A {}, got B {}"),
    ],
)
def test_a_file_of_something_else_says_what_differs(tmp_path, strategy, message):
    save_strategy(tmp_path / "file", made("UCB1", problem=other(definitions=means("A"))))
    taker = strategy()
    before = taker.learned()
    assert re.search(message, refusal(load_strategy, tmp_path / "file", taker))
    for key, value in taker.learned().items():
        np.testing.assert_array_equal(value, before[key])


def test_groups_that_do_not_fit_are_said(tmp_path):
    save_strategy(tmp_path / "file", made("UCB1", groups=np.arange(6)))
    with pytest.raises(DocumentError, match=r"file: state 'counts': expected \(3, 3\) of float64, got \(6, 3\)"):
        load_strategy(tmp_path / "file", made("UCB1", rows=3, groups=np.arange(3)))


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda path: None, "cannot be read"),
        (lambda path: path.write_bytes(b"pickle"), "cannot be read"),
        (lambda path: path.write_bytes(safetensors.numpy.save({"a": np.zeros(1)})), "expected a description"),
        (lambda path: save_arrays(path, {}, {"kind": "recipe"}), "kind: expected 'clean-swarm strategy', got 'recipe'"),
        (lambda path: save_arrays(path, {}, {"version": 2}), "version: expected at most 1, got 2 from a newer release"),
        (lambda path: save_arrays(path, {}, {}), "strategy: missing key"),
    ],
)
def test_other_files_are_one_line(tmp_path, write, message):
    path = tmp_path / "file"
    write(path)
    assert re.search(message, refusal(load_strategy, path, made("UCB1")))


def test_a_place_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(DocumentError, match="cannot be written"):
        save_strategy(tmp_path / "file" / "below", made("UCB1"))
    assert (tmp_path / "file").read_text() == "in the way"


WRITER = """
import sys, numpy as np
from pathlib import Path
from selector.documents.arrays import save_arrays
number = 0
while True:
    save_arrays(Path(sys.argv[1]), {"array": np.full(200_000, number)}, {"number": number})
    print(number, flush=True)
    number += 1
"""


@pytest.mark.long
def test_a_writer_that_is_killed_leaves_a_whole_file(tmp_path):
    path, generator = tmp_path / "file", np.random.default_rng(0)
    for _ in range(5):
        writer = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE)
        assert writer.stdout is not None
        writer.stdout.readline()
        time.sleep(generator.uniform(0.0, 0.05))
        os.kill(writer.pid, signal.SIGKILL)
        writer.wait()
        writer.stdout.close()
        arrays, description = load_arrays(path)
        assert (arrays["array"] == description["number"]).all()
