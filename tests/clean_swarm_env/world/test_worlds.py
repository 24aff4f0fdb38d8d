"""Worlds: the same alone and in a batch and in any order of rows; items go through their stages."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, DONE, LYING, NOTHING
from tests.clean_swarm_env.courses import (
    CROWD,
    begin,
    course,
    difference,
    long_course,
    mission,
    moved,
    snapshot,
    ticked,
    worlds_at_start,
)
from tests.paths import ROOT

MISSIONS = ("table1", "reference")
GOING = ({"at": 2.0, "do": "fail", "robots": [1]}, {"at": 3.0, "do": "remove", "robots": [2]})


@long_course
@pytest.mark.parametrize("name", MISSIONS)
def test_a_world_has_the_same_bits_later_and_while_others_begin_anew(name):
    """300 s: pheromones of the first course are long gone, those of the second evaporate ten times."""
    alone = course(worlds_at_start(mission(name), [5], 0), 0, 1500)
    worlds = ticked(worlds_at_start(mission(name), [11, 12, 13], 0), 437)
    begin(worlds, 1, 5)
    again = []
    for tick in range(1500):
        worlds.tick()
        again.append(snapshot(worlds, 1))
        if tick % 100 == 50:
            begin(worlds, 2 * (tick // 100 % 2), tick)
    assert difference(alone, again) == ""


@pytest.mark.parametrize(("name", "events"), [("table1", ()), ("reference", ()), ("reference", GOING)])
@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_the_robots_does_not_matter(name, events, seed):
    """Up to the rounding of sums, which chaos makes visible after some ten seconds."""
    config, order = mission(name, events=events), np.random.default_rng(seed).permutation(5)
    robots = [(int(np.argsort(order)[event.robots[0]]),) for event in config.events]
    going = [event.model_copy(update={"robots": own}) for event, own in zip(config.events, robots, strict=True)]
    other = config.model_copy(update={"events": tuple(going)})
    start = random_start(config, seed, 0)
    first, second = worlds_at_start(config, [seed]), worlds_at_start(other, [seed])
    second.reset(0, moved(start, order), seed)
    first.reset(0, start, seed)
    streams = np.random.SeedSequence(seed).spawn(5)
    second.minds.directions.reset(np.arange(5), [np.random.default_rng(streams[k]) for k in order])
    for one, two in zip(course(first, 0, 40), course(second, 0, 40), strict=True):
        np.testing.assert_allclose(one["positions"][order], two["positions"], atol=1e-6)
        np.testing.assert_allclose(one["values"][order], two["values"], atol=1e-6)
        assert np.array_equal(one["cargo"][order], two["cargo"])
        assert np.array_equal(one["samples"], two["samples"])


@long_course
@pytest.mark.parametrize("name", MISSIONS)
def test_every_item_is_found_then_carried_then_recycled_then_dumped(name):
    worlds = worlds_at_start(mission(name), [3])
    stations = worlds.mission.task.stations
    before = snapshot(worlds, 0)
    picked = recycled = dumped = 0
    while worlds.task.garbage.done[0] < 10:
        worlds.tick()
        now = snapshot(worlds, 0)
        assert ((now["stage"] - before["stage"] >= 0) & (now["stage"] - before["stage"] <= 1)).all()
        carried = now["cargo"][now["cargo"] != NOTHING]
        assert len(set(carried)) == len(carried)  # no item has two robots (a robot cannot have two items: cargo is one)
        assert set(carried) == set(np.flatnonzero(now["stage"] == CARRIED))
        assert not now["recycled"][now["cargo"] == NOTHING].any()
        for robot in range(5):
            place, had, has = before["positions"][robot], before["cargo"][robot], now["cargo"][robot]
            if had == NOTHING and has != NOTHING:
                picked += 1
                assert _apart(place, worlds.task.garbage.positions[0, has], worlds) <= 0.6
            if now["recycled"][robot] > before["recycled"][robot]:
                recycled += 1
                assert _apart(place, stations.recycling, worlds) <= 0.5
            if had != NOTHING and has == NOTHING:
                dumped += 1
                assert before["recycled"][robot]
                assert now["stage"][had] == DONE
                assert _apart(place, stations.dump, worlds) <= 0.5
        assert (now["stage"] == DONE).sum() == worlds.task.garbage.done[0] == dumped
        assert worlds.minds.buffers["items"].count(0, "garbage") == (now["stage"] == LYING).sum()
        before = now
    assert picked == recycled == dumped == 10


def _apart(place, other, worlds):
    offset = np.abs(place - np.asarray(other))
    return np.hypot(*np.minimum(offset, worlds.extent - offset))


@long_course
@pytest.mark.parametrize("name", MISSIONS)
def test_a_forced_option_is_held_and_the_only_one_that_runs(name):
    for option in range(3):
        worlds = worlds_at_start(mission(name), [1], option)
        for _ in range(300):
            worlds.tick()
            assert (worlds.minds.coordinator_of(AVOIDANCE).held == option).all()
        ran = [bool(content.network.state.values.any()) for content in worlds.minds.coordinator_of(AVOIDANCE).contents]
        assert ran == [k == option for k in range(3)]


def test_holding_what_is_held_already_changes_nothing():
    plain, repeated = worlds_at_start(mission(), [6]), worlds_at_start(mission(), [6])
    first, second = [], []
    for _ in range(300):
        repeated.hold(np.full(5, 2))
        first += course(plain, 0, 1)
        second += course(repeated, 0, 1)
    assert difference(first, second) == ""


def test_what_cannot_be_is_refused():
    worlds = worlds_at_start(mission(), [1])
    with pytest.raises(ValueError, match=r"expected options 0\.\.2"):
        worlds.hold(np.full(5, 3))
    start = random_start(mission(robots={"count": 4}), 1, 0)
    with pytest.raises(ValueError, match="expected 5 robots and 10 items, got 4 and 10"):
        worlds.reset(0, start, 1)


def test_the_clock_of_the_buffers_keeps_time():
    worlds = ticked(worlds_at_start(mission(garbage={"count": 0}), [1]), 150)
    assert 30.0 <= worlds.now < 30.0 + 1e-6  # a period of whole ticks is over with its last tick, not one later


COURSE = (
    "import numpy as np; from tests.clean_swarm_env.courses import CROWD, course, mission, worlds_at_start;"
    "steps = course(worlds_at_start({config}, [5], 0), 0, 40);"
    "print(*np.ravel([step['positions'] for step in steps]).tolist())"
)


def _switched(switch: str, config: str) -> list[float]:
    """Return the course of a mission, number by number, in a process with a switch set."""
    done = subprocess.run(
        [sys.executable, "-c", COURSE.format(config=config)], cwd=ROOT, env={**os.environ, switch: "1"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [float(number) for number in done.stdout.split()]


def test_compiled_and_plain_python_take_the_same_course():
    """The kernels are plain functions: compiled and plain they must give the same."""
    compiled = np.ravel([step["positions"] for step in course(worlds_at_start(mission(), [5], 0), 0, 40)])
    np.testing.assert_allclose(_switched("NUMBA_DISABLE_JIT", "mission()"), compiled, atol=1e-9)


@pytest.mark.long  # compiles every kernel again
def test_without_records_by_address_robots_that_touch_take_the_same_course():
    """Records are named tuples then, references are counted, and Chipmunk is called from Python."""
    steps = course(worlds_at_start(CROWD, [5], 0), 0, 40)
    assert steps[-1]["events"][0] > 0  # they do touch
    assert _switched("CLEAN_SWARM_PLAIN_NUMBA", "CROWD") == np.ravel([step["positions"] for step in steps]).tolist()


COURSES = """
import hashlib
from clean_swarm_env import clean_swarm_v0

for family in ("crowded", "table1"):
    env = clean_swarm_v0.parallel_env(family=family, knowledge="avoidance")
    env.reset(seed=5)
    course = hashlib.sha256()
    for tick in range(300):
        if not env.agents:
            break
        options = {agent: (tick // 7 + row) % env.action_space(agent).n for row, agent in enumerate(env.agents)}
        _, rewards, *_ = env.step({agent: int(option) for agent, option in options.items()})
        course.update(repr(sorted(rewards.items())).encode() + env.state().tobytes())
    print(family, course.hexdigest())
"""
WITHOUT_FMA = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL",
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512_SKX",
}


@pytest.mark.skipif(
    platform.machine() != "x86_64" or platform.libc_ver()[0] != "glibc",
    reason="glibc on x86-64 can be told to leave out what the CPU has",
)
def test_a_course_has_the_same_bits_without_fused_multiply_add(capsys):
    exec(COURSES, {})
    done = subprocess.run(
        [sys.executable, "-c", COURSES], env=os.environ | WITHOUT_FMA, capture_output=True, text=True, check=True
    )
    assert done.stdout.count("\n") == 2
    assert capsys.readouterr().out == done.stdout
