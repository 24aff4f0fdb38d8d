"""The example of docs/play.md follows a session, and its table names every change by hand."""

import re
from typing import get_args

import pytest

from clean_swarm_env.recording.by_hand import ByHand
from tests.paths import ROOT
from tests.train.live.sessions import SMALL, play_of, served
from train.live.session import Session

PAGE = (ROOT / "docs" / "play.md").read_text(encoding="utf-8")


def test_the_example_follows_a_session(tmp_path):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    names: dict = {}
    exec(code, names)
    with served(Session(play_of(SMALL), tmp_path / "run.swarm")) as server:
        frames = names["follow"](server.address)
        names["order"](server.address, do="put_robot", robot=2, x=1.0, y=3.0)
        names["order"](server.address, do="step")
        frame = next(frames)
        assert [frame["x"][2], frame["y"][2]] == pytest.approx([1.0, 3.0])


def test_every_change_by_hand_is_on_the_page():
    rows = re.findall(r"^\| `(\w+)` \| (`.*`) \| (.*) \|$", PAGE, flags=re.MULTILINE)
    told = {do: (set(re.findall(r"`(\w+)`", names)), about) for do, names, about in rows}
    (union, *_) = get_args(ByHand)
    coded = {}
    for change in get_args(union):
        (do,) = get_args(change.model_fields["do"].annotation)
        coded[do] = (set(change.model_fields) - {"do", "tick"}, change.__doc__)
    assert told == coded
