"""Progress: what is done of all, the time left, the best so far, on the terminal and in a log."""

import io
import re
from dataclasses import dataclass, replace
from time import sleep
from types import SimpleNamespace

import pytest
from rich.console import Console

from tests.train.records import record
from train.evaluation.family import FamilyEvaluation
from train.request import Request
from train.running import commands, pulse
from train.running.processes import Processes


def test_a_log_gets_a_line_now_and_then(tmp_path, monkeypatch):
    monkeypatch.setattr(commands, "LOG_EVERY", 0.05)
    with commands.progress("missions", 10, 2, tmp_path) as update:
        sleep(0.12)
        update(advance=4, more="best so far ORCA, 54 s")
        sleep(0.2)
    lines = (tmp_path / commands.LOG).read_text().splitlines()
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 2 of 10 missions, time left: not known yet", lines[0])
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 6 of 10 missions, 0:00:00 left, best so far ORCA, 54 s", lines[-1])
    sleep(0.1)
    assert (tmp_path / commands.LOG).read_text().splitlines() == lines  # it ends with the bar


def test_a_narrow_terminal_shows_what_is_counted_whole_and_the_cost_before_the_name(monkeypatch):
    console = Console(width=80, file=io.StringIO(), force_terminal=True, color_system=None)
    monkeypatch.setattr(commands, "Console", lambda stderr: console)
    with commands.progress("missions", 10, 2) as update:
        update(advance=4, more="lowest mean cost 54 s: models:fly=fixed:ORCA+Patrol;mule=fixed:ORCA+RecentFinds")
    text = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]|\r", "\n", console.file.getvalue())
    last = [line for line in text.split("\n") if line.startswith("missions ")][-1]
    assert re.search(r" 6/10 \d:\d\d:\d\d \d:\d\d:\d\d left lowest mean cost 54 s:", last)
    assert len(last) <= 80


def time_left(completed, total, elapsed, **fields):
    fields = {"begun": 0, "most": 0.0, "ran": 0.0, "first": 0.0, **fields}
    return commands.time_left(SimpleNamespace(completed=completed, total=total, elapsed=elapsed, fields=fields))


def test_the_time_left_counts_what_this_command_did():
    assert time_left(30.0, 90.0, 10.0, begun=20) == "0:01:00 left"
    assert time_left(95.0, 90.0, 10.0, begun=20) == "0:00:00 left"  # a training ends with a whole round
    for most in (-1.0, float("nan")):  # a time that is refused later
        assert time_left(0.0, 1.0, 10.0, most=most, ran=1.0) == "time left: not known yet"


def test_before_there_are_results_the_simulated_seconds_bound_the_time_left():
    assert time_left(0, 30, 4.0, most=30 * 600.0, ran=1800.0) == "at most 0:00:36 left"
    assert time_left(0, 30, 40.0, most=30 * 600.0, ran=10.0) == "time left: not known yet"  # a mechanism is compiled
    assert time_left(1, 30, 4.0, most=30 * 600.0, ran=1800.0) == "at most 0:00:36 left"  # one result is too few
    assert time_left(6, 30, 4.0, most=30 * 600.0, ran=1800.0) == "0:00:16 left"
    assert time_left(0, 30, 24.0, most=30 * 600.0, ran=1800.0, first=20.0) == "at most 0:00:36 left"  # workers started


def test_missions_of_a_batch_tell_how_far_they_are_long_before_the_first_has_ended(monkeypatch):
    monkeypatch.setattr(pulse, "TELL_EVERY", 0.0)
    tasks = FamilyEvaluation(Request("crowded", ("MaxScore",), 1, 2)).tasks({})
    limit = {"time_limit": 20.0}
    drawn = [one for task in tasks for one in task.scenarios][:2]
    short = [replace(one, mission=one.mission.model_copy(update=limit)) for one in drawn]
    heard, at_first = [], []
    with pulse.listening(heard.append):
        for _ in replace(tasks[0], scenarios=tuple(short)).each():
            at_first.append(sum(heard))
    assert at_first[0] >= 2 * 19.0
    assert sum(heard) == pytest.approx(2 * 20.0)


@dataclass(frozen=True)
class Telling:
    """A task whose one run tells ten seconds, one by one."""

    name: str

    @property
    def keys(self):
        return (("1", self.name),)

    def each(self):
        pulse.TELL_EVERY = 0.0
        for _ in range(10):
            pulse.tell(1.0)
        yield record("1", self.name)


def test_workers_tell_their_command_how_far_they_are():
    heard = []
    with pulse.listening(heard.append), Processes(2).rounds() as done:
        found = list(done([Telling("a"), Telling("b")]))
        pulse.TELL_EVERY = 0.0
        pulse.tell(0.0)  # what has been gathered since
        pulse.TELL_EVERY = 0.5
    assert len(found) == 2
    assert sum(heard) == 20.0


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
