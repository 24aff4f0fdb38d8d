"""A session of six robots and eight items, and its page in a headless Chromium, which must log nothing."""

import pytest

from tests.train.live.sessions import SMALL, play_of
from train.live.server import LiveServer
from train.live.session import Session


@pytest.fixture
def session(tmp_path):
    return Session(play_of(SMALL), tmp_path / "run.swarm")


@pytest.fixture
def opened(watched):
    """Open the page of a server, before the first step of its session; it must log nothing."""
    heard = []

    def open_page(server: LiveServer, address: str = ""):
        page, said, _ = watched()
        heard.append(said)
        page.goto(address or server.address)
        page.wait_for_selector("body[data-ready]")
        return page

    yield open_page
    for said in heard:
        assert [words for words in said if not words.startswith("Failed to load resource")] == []
