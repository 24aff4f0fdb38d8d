"""The first minute of a play on its page: it fits, says what to do, and ends with a verdict."""

import time

import numpy as np
import pytest

from tests.train.live.pages import shows, step, until
from tests.train.live.sessions import SMALL, play_of, served

pytestmark = [pytest.mark.page, pytest.mark.extra, pytest.mark.long]  # one of its kind in the gate: test_live_page.py


@pytest.mark.parametrize(
    ("size", "scheme"), [((1366, 768), "light"), ((1440, 1100), "dark"), ((390, 844), "light"), ((390, 844), "dark")]
)
def test_the_world_fits_without_scrolling(session, opened, size, scheme):
    with served(session) as server:
        page = opened(server, viewport={"width": size[0], "height": size[1]}, color_scheme=scheme)
        box = page.locator(".world").bounding_box()
        assert box["y"] >= 0.0
        assert box["y"] + box["height"] <= size[1]
        assert box["height"] >= (560 if size[0] > 900 else 360)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        groups = page.evaluate("[...document.querySelectorAll('#groups details:not(#keys)')].map(group => group.open)")
        assert set(groups) == {size[0] > 900}


def test_the_end_has_a_verdict_and_leads_on(sessions, opened):
    opening = sessions(play_of({**SMALL, "time_limit": 2.0, "robots": {"count": 10}}, "fixed:ORCA"))
    with served(opening[""](), others=opening) as server:
        page = opened(server)
        page.click("#play")
        until(page, "() => !document.querySelector('.verdict').hidden")
        assert page.text_content(".verdict h2") == "Not clean: 0 of 8 items when the time was over."
        shows(page, "#jam", "Watch it jam (MaxScore)")
        page.click("[data-press=jam]")
        until(page, "() => window.replay?.page?.state.number === 2")
        page.click("#play")
        until(page, "() => !document.querySelector('.verdict').hidden")
        shows(page, "figcaption b", ", MaxScore", "endsWith")
        shows(page, "#jam", "Watch the best (fixed:ORCA)")
        plays = page.evaluate("[...document.querySelectorAll('.verdict td:first-child')].map(cell => cell.textContent)")
        assert sorted(plays) == ["MaxScore", "fixed:ORCA"]
        page.click("[data-press=open]")
        until(page, "() => document.title === 'Clean Swarm: ReachGoal, live'")


def test_a_play_begins_when_its_page_is_there(session, opened):
    with served(session, playing=True) as server:
        time.sleep(1.0)
        assert session.ticks == 0
        page = opened(server)
        until(page, "() => replay.page.run.frames > 5")
        page.keyboard.press(" ")
        until(page, "() => !replay.page.state.playing")
        page.reload()  # what was paused stays so
        page.wait_for_selector("body[data-ready]")
        assert not page.evaluate("replay.page.state.playing")


def test_figures_are_of_the_same_moment_while_it_runs(session, opened):
    """Also where the charts are drawn seldom, as those of long runs are."""
    with served(session, playing=True) as server:
        page = opened(server)
        page.evaluate("replay.page.chartsAt = Infinity")
        until(page, "() => replay.page.run.frames > 60")
        read = "(() => { const now = parseFloat(document.querySelector('#now').textContent);"
        read += " return [now, document.querySelector('.score').textContent]; })()"
        for _ in range(5):
            now, score = page.evaluate(read)
            assert f"= {np.floor(now + 0.5):,.0f} s + " in score
        page.keyboard.press(" ")


def test_a_strategy_that_has_not_decided_yet_has_no_bars(page):
    for _ in range(2):
        step(page)
    thought = "What the chooser thinks of each option"
    assert thought in page.text_content("#panel")
    page.click("#what_if")
    until(page, "() => document.querySelector('[data-foretold]')")
    page.select_option("#strategy", "fixed:ORCA")
    shows(page, "[data-waits]", "fixed:ORCA has not decided yet")
    assert thought not in page.text_content("#panel")
    assert page.evaluate("document.querySelector('[data-foretold]')") is None
    for _ in range(3):
        step(page)
    assert page.evaluate("document.querySelector('[data-waits]')") is not None  # it decides once in a second
    step(page)
    until(page, "() => !document.querySelector('[data-waits]')")
    shows(page, "[data-held]", "ORCA")


def test_a_keyboard_is_enough(page):
    for _ in range(2):
        page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "step"
    page.keyboard.press("Enter")
    until(page, "() => replay.page.run.frames === 1")
    page.keyboard.press("Space")  # on the button, which it presses
    until(page, "() => replay.page.run.frames === 2")
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Enter")
    until(page, "() => replay.page.state.playing")
    page.keyboard.press("ArrowUp")
    shows(page, "#panel h2", "Robot 1")
    page.focus("#strategy")
    page.keyboard.press("ArrowDown")
    until(page, "() => replay.page.state.strategy !== 'MaxScore'")
    shows(page, "#panel h2", "Robot 1")
