"""Progress: what is done of all, the time left, the best so far, on the terminal and in a log."""

import re
import threading
from dataclasses import replace
from types import SimpleNamespace

import pytest

from tests.train.waiting import until
from train.evaluation.comparing import Comparing
from train.request import Request
from train.running import commands, pulse


def test_a_log_gets_a_line_now_and_then_until_the_bar_ends(tmp_path, monkeypatch):
    monkeypatch.setattr(commands, "LOG_EVERY", 0.01)
    log, before = tmp_path / commands.LOG, threading.active_count()
    with commands.progress("missions", 10, 2, tmp_path) as update:
        until(log.exists)
        update(advance=4, more="best so far ORCA, 54 s")
        until(lambda: "ORCA" in log.read_text())
    until(lambda: threading.active_count() == before)
    first, *_, last = log.read_text().splitlines()
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 2 of 10 missions, time left: not known yet", first)
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 6 of 10 missions, \d:\d\d:\d\d left, best so far ORCA, 54 s", last)


MOST = {"most": 30 * 600.0, "ran": 1800.0}


@pytest.mark.parametrize(
    ("completed", "total", "elapsed", "fields", "expected"),
    [
        (30.0, 90.0, 10.0, {"begun": 20}, "0:01:00 left"),  # what this command did
        (95.0, 90.0, 10.0, {"begun": 20}, "0:00:00 left"),  # a training ends with a whole round
        (0.0, 1.0, 10.0, {"most": -1.0, "ran": 1.0}, "time left: not known yet"),  # a time that is refused later
        (0.0, 1.0, 10.0, {"most": float("nan"), "ran": 1.0}, "time left: not known yet"),
        (0, 30, 4.0, MOST, "at most 0:00:36 left"),  # the simulated seconds, before there are results
        (0, 30, 40.0, MOST | {"ran": 10.0}, "time left: not known yet"),  # a mechanism is compiled
        (1, 30, 4.0, MOST, "at most 0:00:36 left"),  # one result is too few
        (6, 30, 4.0, MOST, "0:00:16 left"),
        (49, 50, 441.0, {"latest": 441.0}, "0:00:09 left"),  # a result has just come
        (49, 50, 601.0, {"latest": 441.0}, "0:02:40 left"),  # the slowest is the last
        (0, 30, 40.0, MOST, "at most 0:06:00 left"),  # that is a bound, however long one waits
        (0, 30, 24.0, MOST | {"first": 20.0}, "at most 0:00:36 left"),  # workers started
    ],
)
def test_the_time_left(completed, total, elapsed, fields, expected):
    fields = {"begun": 0, "most": 0.0, "ran": 0.0, "first": 0.0, "latest": elapsed, **fields}
    task = SimpleNamespace(completed=completed, total=total, elapsed=elapsed, fields=fields)
    assert commands.time_left(task) == expected


def test_missions_of_a_batch_tell_how_far_they_are_long_before_the_first_has_ended(monkeypatch):
    monkeypatch.setattr(pulse, "TELL_EVERY", 0.0)
    tasks = Comparing(Request("crowded", ("MaxScore",), 1, 2)).tasks({})
    limit = {"time_limit": 20.0}
    drawn = [one for task in tasks for one in task.scenarios][:2]
    short = [replace(one, mission=one.mission.model_copy(update=limit)) for one in drawn]
    heard, at_first = [], []
    with pulse.listening(heard.append):
        for _ in replace(tasks[0], scenarios=tuple(short)).each():
            at_first.append(sum(heard))
    assert at_first[0] >= 2 * 19.0
    assert sum(heard) == pytest.approx(2 * 20.0)


def test_what_a_listener_hears_is_gathered(monkeypatch):
    now, heard = [0.0], []
    monkeypatch.setattr(pulse, "monotonic", lambda: now[0])
    with pulse.listening(heard.append):
        for _ in range(30):
            pulse.tell(1.0)
            now[0] += 0.2
    assert heard == [4.0, *[3.0] * 8]  # what is left at the end is not told
    now[0] += 9.0
    pulse.tell(1.0)
    assert len(heard) == 9  # nobody listens any more
