"""Orders of every kind, with odd values, in any sequence: the session lives, answers in a line, and stays a world."""

import json
import os
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.request import urlopen

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from clean_swarm_env.recording.file import blocks_in
from clean_swarm_env.recording.reader import RecordedMission, RecordedParts, frames_from
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, LYING
from clean_swarm_env.world.by_hand import Change, FollowStrategy
from tests.train.live.sessions import SMALL, asked, ordered, play_of, served
from train.live.chosen import again
from train.live.session import Session

MEANT = {
    **dict.fromkeys(("play", "pause", "step"), ()),
    "speed": ("speed",),
    "open": ("name",),
    "put_robot": ("robot", "x", "y"),
    "add_robot": ("x", "y", "heading"),
    "remove_robot": ("robot",),
    "fail_robot": ("robot",),
    "put_item": ("item", "x", "y"),
    "add_item": ("x", "y"),
    "remove_item": ("item",),
    "set_loss": ("loss",),
    "hold_option": ("option", "robots"),
    "follow_strategy": ("strategy",),
}
"""Kinds of orders, and what they need."""
NUMBERS = st.one_of(
    st.integers(-1, 12),
    st.floats(-20.0, 20.0, width=16),
    st.sampled_from([1e-12, 1e308, -1e308, 5e-324, 2**53, 2**63, 2**64, -(2**63), 10**400, float("nan"), float("inf")]),
)
TEXTS = st.one_of(
    st.sampled_from(
        ["", "RepulsionGradient-view0.5", "Off", "MaxScore", "Random", "rule", "fixed:Off", "fsm:rule", "small"]
    ),
    st.sampled_from(["policy:x.zip", "os:system", "a/b.py:X", "\x00", "a\nb", "\ud800", "x" * 5000]),
)
ODD = st.one_of(NUMBERS, TEXTS, st.none(), st.booleans(), st.just({}), st.lists(NUMBERS, max_size=3))
USUAL = {
    **dict.fromkeys(("robot", "item"), st.integers(0, 9)),
    **dict.fromkeys(("x", "y", "heading"), st.floats(0.0, 11.0, width=16)),
    "loss": st.floats(0.0, 1.0, width=16),
    "speed": st.sampled_from([0.01, 5, 1000]),
    "robots": st.lists(st.integers(0, 7), max_size=3),
    **dict.fromkeys(("option", "strategy", "name"), TEXTS),
}


class Orders(RuleBasedStateMachine):
    """A session that is given orders by its server; its recording runs again to the same state."""

    def __init__(self):
        super().__init__()
        self.folder = TemporaryDirectory()
        self.paths = []
        self.serving = served(self.opened(), speed=1000.0, others={"": self.opened})
        self.server = self.serving.__enter__()

    def opened(self):
        self.paths.append(Path(self.folder.name) / f"{len(self.paths)}.swarm")
        return Session(play_of(SMALL), self.paths[-1], minds=False)

    @property
    def session(self):
        return self.server.conductor.session

    def give(self, order):
        """Give an order; the answer is one line, and never says that carrying out failed."""
        status, content = asked(self.server, "do", json.dumps(order).encode())
        (line,) = content.decode().splitlines()
        said = json.loads(line).get("error", "")
        assert status == (400 if said else 200), line
        assert len(said.splitlines()) <= 1
        assert not said.startswith("the order failed"), said

    @rule(kind=st.sampled_from(tuple(MEANT)), data=st.data())
    def order_as_it_is_meant(self, kind, data):
        self.give({"do": kind, **{name: data.draw(USUAL[name]) for name in MEANT[kind]}})

    @rule(
        kind=st.sampled_from((*MEANT, "dance", None, 1, [], {})),
        values=st.dictionaries(st.sampled_from((*USUAL, "tick")), ODD),
    )
    def order_with_odd_values(self, kind, values):
        self.give({"do": kind, **values})

    @invariant()
    def it_is_a_world(self):
        self.give({"do": "pause"})  # nothing moves from now on
        worlds, garbage = self.session.worlds, self.session.worlds.task.garbage
        present, working = worlds.physics.present, worlds.team.working
        assert working.any()
        assert (present | ~working).all()
        places = worlds.physics.positions[present]
        assert np.isfinite(places).all()
        assert ((places >= 0.0) & (places <= worlds.extent)).all()
        carried = np.flatnonzero(garbage.stage[0] == CARRIED)
        assert np.sort(garbage.cargo[garbage.cargo >= 0]).tolist() == carried.tolist()
        assert garbage.done[0] + len(carried) + (garbage.stage[0] == LYING).sum() == garbage.arrived[0]
        assert set(np.unique(worlds.coordinators[0].held)) <= set(range(len(self.session.options)))

    def teardown(self):
        self.give({"do": "step"})  # what was done after the last frame is in the recording, too
        self.serving.__exit__(None, None, None)
        state, ticks = self.session.worlds.get_state(), self.session.ticks
        second = Session(again(RecordedMission(self.paths[-1])), Path(self.folder.name) / "again.swarm", minds=False)
        while second.ticks < ticks:
            second.tick()
        second.close()
        self.folder.cleanup()
        assert second.worlds.get_state() == state


TestOrders = Orders.TestCase
TestOrders.settings = settings(max_examples=int(os.environ.get("ORDERS", "3")), stateful_step_count=25)


def test_an_order_that_fails_ends_no_session(session, monkeypatch):
    """A mistake of ours in an order is shown, and the session goes on."""

    def fail(change, worlds):
        raise ZeroDivisionError("what\nwas not thought of")

    monkeypatch.setattr(Change, "make", fail)
    with served(session) as server:
        said = ordered(server, do="add_item", x=1.0, y=1.0)
        assert said == "the order failed: ZeroDivisionError: what was not thought of"
        assert ordered(server, do="step") == ""
        assert session.ticks == 1


@pytest.mark.parametrize("playing", [True, False])
def test_a_tick_that_fails_ends_its_mission_and_no_more(sessions, tmp_path, playing):
    """What was played is kept, the page is told, and the same again or another one can be opened."""
    opening = sessions(play_of(SMALL), minds=False)

    def fail(course):
        for _ in range(3):
            yield next(course)
        raise ZeroDivisionError("what\nwas not thought of")

    session = opening[""]()
    session._course = fail(session._course)
    said = "the mission failed: ZeroDivisionError: what was not thought of"
    with served(session, playing=playing, others=opening) as server:
        if playing:
            assert ordered(server, do="play") == ""
        else:
            assert [ordered(server, do="step") for _ in range(4)] == ["", "", "", said]
        stream = server.conductor.stream
        while not (state := stream.state)["failure"]:
            stream.after(10**9, state, 1.0)
        assert (state["failure"], state["over"], state["playing"]) == (said, True, False)
        for order in ({"do": "step"}, {"do": "play"}, {"do": "add_item", "x": 1.0, "y": 1.0}):
            assert ordered(server, **order) == said
        assert ordered(server, do="open", name="") == ""
        assert server.conductor.stream.state["failure"] == ""
        assert ordered(server, do="step") == ""
    assert RecordedMission(tmp_path / "0.swarm").frames == 3


def test_a_slow_session_hears_orders(session):
    with served(session, speed=0.01, playing=True) as server:
        assert "speed: expected a number from 0.01 to 1000" in ordered(server, do="speed", speed=1e-12)
        assert ordered(server, do="speed", speed=1000) == ""
        assert ordered(server, do="play") == ""
        with urlopen(server.address.replace("/?", "/stream?"), timeout=60) as source:
            next(frames_from(RecordedParts(blocks_in(source, "stream"), "stream")))


@pytest.mark.parametrize(
    "name",
    [
        "policy:mine.zip",
        "evil:Strategy",
        "evil.py:Strategy",
        "learned:./x.safetensors",
        "policy:../policies/general",
        "fsm:/tmp/x.yaml",
        "velocity:x.onnx",
        "MaxScore:sharing=team",
    ],
)
def test_orders_take_no_names_of_code_or_of_files(tmp_path, monkeypatch, name):
    """Neither in a live session nor in a recording of one."""
    (tmp_path / "evil.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\nclass Strategy: ...\n")
    (tmp_path / "mine.zip").write_bytes(b"")
    monkeypatch.chdir(tmp_path)
    by_hand = (FollowStrategy(do="follow_strategy", tick=0, strategy=name),)
    session = Session(replace(play_of(SMALL), by_hand=by_hand), tmp_path / "run.swarm")
    for act in (lambda: session.do({"do": "follow_strategy", "strategy": name}), session.tick):
        with pytest.raises(ValueError, match="follow_strategy: unknown strategy"):
            act()
    session.close()
    assert not (tmp_path / "ran").exists()


def test_the_strategy_of_the_command_line_can_be_chosen_again(tmp_path):
    session = Session(play_of(SMALL, "UCB1:prior=2"), tmp_path / "run.swarm")
    for name in ("Random", "UCB1:prior=2", f"fixed:{session.options[0]}"):
        session.do({"do": "follow_strategy", "strategy": name})
    session.close()


def test_another_mission_and_the_same_again_are_opened_by_order(sessions, tmp_path):
    opening = {**sessions(play_of(SMALL), minds=False), "gone": lambda: 1 / 0}
    with served(opening[""](), others=opening) as server:
        assert ordered(server, do="step") == ""
        assert ordered(server, do="open", name="ReachGoal") == ""
        assert server.conductor.stream.state["strategy"] == "MaxScore"
        assert "expected one of" in ordered(server, do="open", name="./mine.yaml")
        assert "ZeroDivisionError" in ordered(server, do="open", name="gone")
        assert ordered(server, do="step") == ""
        assert server.conductor.stream.state["name"] == "ReachGoal"
        assert ordered(server, do="open", name="") == ""
        assert server.conductor.session.ticks == 0
        assert ordered(server, do="step") == ""
    assert [RecordedMission(path).frames for path in sorted(tmp_path.glob("*.swarm"))] == [1, 1, 1]


def test_an_order_opens_a_mission_under_another_strategy(session, sessions):
    with served(session, others=sessions(play_of(SMALL), minds=False)) as server:
        assert ordered(server, do="open", name="", strategy="fixed:ORCA") == ""
        assert server.conductor.stream.state["strategy"] == "fixed:ORCA"
        for strategy in ("os:system", "policy:x.zip", "", None, 3, float("nan"), ["fixed:ORCA"], "x" * 5000):
            said = ordered(server, do="open", name="", strategy=strategy)
            assert (said == "") == (strategy == ""), said
            assert len(said.splitlines()) <= 1
        assert server.conductor.stream.state["strategy"] == "MaxScore"
        assert ordered(server, do="step") == ""  # the session that was there goes on
