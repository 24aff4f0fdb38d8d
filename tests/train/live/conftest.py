"""A session of six robots and eight items, and its page in a headless Chromium, which must log nothing."""

from itertools import count

import pytest

from tests.train.live.sessions import SMALL, play_of, served
from train.live.chosen import chosen
from train.live.server import LiveServer
from train.live.session import Session


@pytest.fixture
def session(tmp_path):
    return Session(play_of(SMALL), tmp_path / "run.swarm")


@pytest.fixture
def sessions(tmp_path):
    """Sessions to be opened by order, each with a recording of its own: the same again, and another mission."""
    paths = (tmp_path / f"{number}.swarm" for number in count())

    def opening(again, minds=True):
        return {
            "": lambda: Session(again, next(paths), minds=minds),
            "ReachGoal": lambda: Session(chosen("ReachGoal", 1, 0, None, ()), next(paths), minds=False),
        }

    return opening


@pytest.fixture
def opened(watched):
    """Open the page of a server, before the first step of its session; it must log nothing."""
    heard = []

    def open_page(server: LiveServer, **settings):
        page, said, _ = watched(**settings)
        heard.append(said)
        page.goto(server.address)
        page.wait_for_selector("body[data-ready]")
        return page

    yield open_page
    for said in heard:
        assert [words for words in said if not words.startswith("Failed to load resource")] == []


@pytest.fixture
def page(session, opened):
    """The page of a served session."""
    with served(session) as server:
        yield opened(server)
