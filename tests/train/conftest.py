"""A headless Chromium for the tests of pages, a Dask cluster, and missions that take no time for those of commands."""

import shutil

import pytest

from tests.train.cluster.loopback import loopback_cluster
from tests.train.commands import faked_missions
from train.reports import charts


@pytest.fixture
def fake_missions():
    """Let missions of experiments take no time."""
    with faked_missions():
        yield


@pytest.fixture
def undrawn(monkeypatch):
    """Let the figures of results take no time: files without content."""
    monkeypatch.setattr(charts, "picture_of", lambda figure, suffix: b"")


@pytest.fixture
def cluster(tmp_path):
    """A cluster on loopback, or skip."""
    pytest.importorskip("distributed", reason="Dask is not installed (extra `cluster`)")
    with loopback_cluster(tmp_path) as running:
        yield running


@pytest.fixture(scope="session")
def browser():
    """Chromium for all tests of a run, or skip."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="needs Playwright: pip install playwright")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("needs Chromium: apt-get install chromium")
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def watched(browser):
    """Open empty pages of some settings, each with the list of what it logs and the list of what it asks for."""
    pages = []

    def open_page(**settings):
        page = browser.new_page(**{"viewport": {"width": 1500, "height": 950}, **settings})
        page.set_default_timeout(60_000)  # the machine may be busy
        said, asked = [], []
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        pages.append(page)
        return page, said, asked

    yield open_page
    for page in pages:
        page.close()
