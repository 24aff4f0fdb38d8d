"""Progress: what is done of all, the time left, the best so far, on the terminal and in a log."""

import re
from time import sleep

from rich.progress import MofNCompleteColumn

from train.running import commands


def test_a_log_gets_a_line_now_and_then(tmp_path, monkeypatch):
    monkeypatch.setattr(commands, "LOG_EVERY", 0.05)
    with commands.progress("missions", MofNCompleteColumn(), 10, 2, tmp_path) as update:
        sleep(0.12)
        update(advance=4, more="best so far ORCA, 54 s")
        sleep(0.2)
    lines = (tmp_path / commands.LOG).read_text().splitlines()
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 2 of 10 missions, time left: from the first result on", lines[0])
    assert re.fullmatch(r"\d\d:\d\d:\d\d, 6 of 10 missions, 0:00:00 left, best so far ORCA, 54 s", lines[-1])
    sleep(0.1)
    assert (tmp_path / commands.LOG).read_text().splitlines() == lines  # it ends with the bar


def test_the_time_left_counts_what_this_command_did(monkeypatch):
    class Done:
        completed, total, elapsed, fields = 30.0, 90.0, 10.0, {"begun": 20, "more": ""}

    assert commands.time_left(Done()) == "0:01:00 left"
