"""The page of a session in a headless Chromium: it shows what runs, and what is done by hand happens in the world."""

import statistics
from itertools import count

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from tests.train.live.pages import drag, free_place, on_screen, until
from tests.train.live.sessions import SMALL, play_of, served
from train.live.chosen import chosen
from train.live.session import Session

pytestmark = pytest.mark.page
FRAMES = "() => replay.page.run.frames"
COURSE = (
    "([name, robot]) => { const { data, columns } = replay.page.run.tracks.get(name);"
    " return [...Array(28).keys()].map(k => data[(k + 1) * columns + robot] / 1000); }"
)
"""A coordinate of a robot in the frames from 1 on [m]."""
SHOWN_AT = (
    "([robot, x, y]) => { const { view } = replay.page.shown[0];"
    " return Math.hypot(view.x[robot] - x, view.y[robot] - y) < 0.05; }"
)
"""A robot is drawn at a place [m]: a picture or more after the page has heard of it."""
SET_LOSS = (
    "() => { const loss = document.querySelector('#loss'); loss.value = 0.6; loss.dispatchEvent(new Event('change')); }"
)


def step(page) -> None:
    frames = page.evaluate(FRAMES)
    page.click("#step")
    until(page, "([frames]) => replay.page.run.frames > frames && !replay.page.waiting", frames)


def test_a_robot_that_is_dragged_is_there_and_the_world_goes_on(session, opened):
    with served(session) as server:
        page = opened(server)
        shown = [page.evaluate(f"replay.page.shown[0].view.{axis}[2]") for axis in "xy"]
        place = free_place(session)
        drag(page, shown, place)
        until(page, SHOWN_AT, 2, *place)  # paused, and before the first step
        assert page.evaluate("replay.page.held") is None
        assert page.evaluate(FRAMES) == session.ticks == 0
        assert session.worlds.physics.positions[2] == pytest.approx(place, abs=0.05)
        page.click("#play")
        until(page, "() => replay.page.run.frames > 30")
        page.click("#play")
        until(page, "() => !replay.page.state.playing")
        x, y = (page.evaluate(COURSE, [axis, 2]) for axis in "xy")
        steps = np.hypot(*((np.diff([x, y]) + 5.5) % 11.0 - 5.5))
        assert steps.max() <= 0.21
        assert steps.sum() > 0.5
    recording = RecordedMission(session.batch.recorder.settings.directory / "run.swarm")
    assert [(change.do, change.tick) for change in recording.by_hand] == [("put_robot", 0)]


def test_items_are_dragged_added_and_taken_away(session, opened):
    with served(session) as server:
        page = opened(server)
        item = session.worlds.task.garbage.positions[0, 0].tolist()
        place = free_place(session)
        drag(page, item, place)
        until(page, "() => !replay.page.taken")
        step(page)
        assert session.worlds.task.garbage.positions[0, 0] == pytest.approx(place, abs=0.05)
        page.select_option("#tool", "add_item")
        other = free_place(session)
        page.mouse.click(*on_screen(page, *other))
        step(page)
        assert session.worlds.task.garbage.positions[0, 8] == pytest.approx(other, abs=0.05)
        page.select_option("#tool", "remove_item")
        page.mouse.click(*on_screen(page, *other))
        step(page)
        assert session.worlds.task.garbage.stage[0, 8] == 3


def test_robots_are_added_fail_and_go(session, opened):
    with served(session) as server:
        page = opened(server)
        page.select_option("#tool", "add_robot")
        place = free_place(session)
        page.mouse.click(*on_screen(page, *place))
        step(page)
        assert session.worlds.physics.present[6]
        page.evaluate("replay.page.choose(0, 3)")
        page.click("#fail")
        step(page)
        assert "It has failed" in page.text_content("#panel")
        page.click("#remove")
        step(page)
        assert not session.worlds.physics.present[3]
        page.click("#remove")
        until(page, "() => document.querySelector('#said').textContent")
        assert page.text_content("#said") == "robot 3: expected a robot that is there"
        kinds = page.evaluate("replay.events()[0].filter(e => e.kind === 'hand').map(e => [e.frame, e.robot])")
        assert kinds == [[0, -1], [1, 3], [2, 3]]


def test_options_strategies_and_losses_are_switched(session, opened):
    with served(session) as server:
        page = opened(server)
        page.evaluate("replay.page.choose(0, 4)")
        page.select_option("#option", "RepulsionFernandez-view2.0")
        page.click("#hold")
        step(page)
        assert page.text_content("[data-held]") == "RepulsionFernandez-view2.0"
        assert session.worlds.coordinators[0].held[:6].tolist() == [0, 0, 0, 0, 3, 0]
        page.select_option("#option", "RepulsionGradient")
        page.click("#hold_all")
        step(page)
        assert set(session.worlds.coordinators[0].held.tolist()) == {5}
        page.select_option("#strategy", "fsm:rule")
        until(page, "() => replay.page.state.strategy === 'fsm:rule'")
        page.evaluate(SET_LOSS)
        until(page, "() => replay.page.state.loss === 0.6")
        assert page.text_content("#loss_now") == "60 %"
        assert session.strategy.startswith("fsm:rule sha256")
        for _ in range(4):
            step(page)
        assert page.evaluate("replay.page.run.tracks.get('missed').data.some(missed => missed > 0)")


def test_what_was_is_looked_at_while_the_world_goes_on(session, opened):
    with served(session, playing=True) as server:
        page = opened(server)
        until(page, "() => replay.page.run.frames > 20")
        page.evaluate("replay.page.go(2)")
        frames = page.evaluate(FRAMES)
        until(page, "([frames]) => replay.page.run.frames > frames + 10", frames)
        assert page.text_content("#now") == "2.0 s"
        page.click("#head")
        until(page, "() => replay.page.atHead && replay.page.time > 5")
        page.keyboard.press(" ")
        until(page, "() => !replay.page.state.playing")
        frames = session.ticks
        page.keyboard.press("ArrowRight")
        until(page, "([frames]) => replay.page.run.frames === frames + 1", frames)
        other = opened(server)  # a page that is opened later has the whole run
        assert other.evaluate("replay.checksums()") == page.evaluate("replay.checksums()")
        other.select_option("#speed", label="20x")
        until(page, "() => document.querySelector('#speed').selectedOptions[0].textContent === '20x'")
    page.wait_for_timeout(100)
    recording = RecordedMission(session.batch.recorder.settings.directory / "run.swarm")
    assert page.evaluate("replay.checksums()") == [recording.checksums()]


def test_a_server_that_goes_is_told_and_what_came_stays(session, opened, tmp_path):
    with served(session) as server:
        page = opened(server)
        port = server.server_address[1]
        step(page)
    until(page, "() => document.querySelector('#said').textContent")
    assert page.text_content("#said") == "The server does not answer. The page tries again; what came until now stays."
    page.evaluate("replay.page.go(0)")
    assert page.text_content("#now") == "0.0 s"
    page.click("#play")
    until(page, "() => document.querySelector('#said').textContent.startsWith('The server does not answer')")
    with served(Session(play_of(SMALL), tmp_path / "other.swarm"), port=port):
        until(page, "() => document.querySelector('#said').textContent.startsWith('This session is over')")
        assert page.evaluate(FRAMES) == 1


def test_after_the_end_the_same_mission_or_another_one_begins(tmp_path, opened):
    paths = (tmp_path / f"{number}.swarm" for number in count())
    short = play_of({**SMALL, "time_limit": 2.0})
    sessions = {
        "": lambda: Session(short, next(paths)),
        "ReachGoal": lambda: Session(chosen("ReachGoal", 1, 0, None, ()), next(paths), minds=False),
    }
    with served(sessions[""](), others=sessions) as server:
        page, other = opened(server), opened(server)
        page.click("#play")
        until(page, "() => document.querySelector('.caption').textContent.includes('not completed')")
        assert page.text_content("#play") == "Over"
        page.click("#again")
        until(page, "() => globalThis.replay?.page.run.frames === 0 && replay.page.state.name === ''")
        until(other, "() => globalThis.replay?.page.run.frames === 0")  # another page of the session goes along
        step(page)
        page.select_option("#mission", "ReachGoal")
        page.click("#open")
        until(page, "() => document.title === 'Clean Swarm: ReachGoal, live'")
        assert page.text_content("figcaption b").startswith("ReachGoal, ")
        step(page)
    assert [RecordedMission(path).frames for path in sorted(tmp_path.glob("*.swarm"))] == [10, 1, 1]


def test_the_world_is_there_before_the_first_step(session, opened):
    with served(session) as server:
        page = opened(server)
        assert page.text_content("#now") == "0.0 s"
        assert page.text_content(".score").startswith("0 of 8 items dumped0 collisionscost so far 0 s")
        shown = [page.evaluate(f"[...replay.page.shown[0].view.{axis}]")[:6] for axis in "xy"]
        assert np.transpose(shown) == pytest.approx(session.worlds.physics.positions[:6], abs=0.002)
        assert page.evaluate("replay.page.shown[0].view.rows") == list(range(6))
        assert page.evaluate(FRAMES) == session.ticks == 0
        step(page)
        until(page, "() => document.querySelector('#now').textContent === '0.2 s'")  # drawn after it has come


def test_titles_follow_the_strategy(session, opened):
    with served(session) as server:
        page = opened(server)
        step(page)
        page.select_option("#strategy", "fsm:rule")
        until(page, "() => document.querySelector('figcaption b').textContent.endsWith(', fsm:rule')")
        assert page.text_content("#panel p").endswith(", fsm:rule")
        step(page)
        page.evaluate("replay.page.go(0)")
        assert page.text_content("figcaption b").endswith(", MaxScore")


def test_the_page_is_shown_in_no_frame_of_another_page(session, watched):
    with served(session) as server:
        page, said, _ = watched()
        page.set_content(f"<iframe src='{server.address}'></iframe>")
        page.wait_for_timeout(500)
        assert [frame.url for frame in page.frames if "token" in frame.url] == []
        assert any("frame-ancestors" in words for words in said)


def test_frames_are_on_the_screen_as_they_are_made(tmp_path, opened):
    """It takes 50 ms on an idle machine; the wide bound, for a busy one, still finds a page that only polls."""
    session = Session(play_of({**SMALL, "task": {"garbage": {"count": 8, "respawn": 5.0}}}), tmp_path / "long.swarm")
    with served(session, playing=True) as server:
        page = opened(server)
        until(page, "() => replay.page.lags.length >= 200")
        lag = statistics.median(page.evaluate("replay.page.lags"))
    print(f"median lag {lag} ms")
    assert lag < 500.0


def test_walls_are_named_among_the_layers(session, opened):
    with served(session) as server:
        page = opened(server)
        assert page.is_disabled("[name=walls]")
        assert "walls (this world has none)" in page.text_content("#layers")


def test_walls_are_drawn_and_can_be_hidden(opened, tmp_path):
    walled = {"world": {"ground": "walled", "walls": [{"corners": [[5.0, 0.0], [5.0, 8.0]]}]}}
    with served(Session(play_of({**SMALL, **walled}), tmp_path / "walled.swarm")) as server:
        page = opened(server)
        assert page.is_checked("[name=walls]")
        drawn = page.evaluate("document.querySelector('.world').toDataURL()")
        page.uncheck("[name=walls]")
        assert page.evaluate("document.querySelector('.world').toDataURL()") != drawn
        wide, high = page.evaluate("[replay.page.shown[0].view.wide, replay.page.shown[0].view.high]")
        assert wide == high  # the field, not the whole torus


def test_a_period_that_fails_is_said_and_the_same_again_can_be_opened(session, opened, tmp_path, monkeypatch):
    monkeypatch.setattr(session, "_course", (1 / 0 for _ in range(1)))
    others = {"": lambda: Session(play_of(SMALL), tmp_path / "again.swarm")}
    with served(session, others=others) as server:
        page = opened(server)
        page.click("#step")
        until(
            page, "() => document.querySelector('#said').textContent.includes('the mission failed: ZeroDivisionError')"
        )
        assert page.locator("#step").is_disabled()
        page.click("#again")
        until(page, "() => window.replay?.page && !replay.page.state.failure && replay.page.state.number == 2")
        step(page)


def test_what_if_shows_the_next_seconds_of_every_option(session, opened):
    with served(session) as server:
        page = opened(server)
        for _ in range(3):
            step(page)
        page.evaluate("replay.page.choose(0, 3)")
        before = page.evaluate("document.querySelector('.world').toDataURL()")
        page.click("#what_if")
        until(page, "() => document.querySelector('[data-foretold]')")
        shown = page.evaluate("[...document.querySelectorAll('[data-foretold]')].map(row => row.dataset.foretold)")
        assert shown == list(session.options)
        assert page.text_content("#panel h3").startswith("What if robot 3 took another option at 0.6 s: the next 5 s")
        assert page.evaluate("document.querySelector('.world').toDataURL()") != before
        foretold = page.evaluate("replay.page.foretold.options.find(({option}) => option === 'ORCA').path")
        assert session.ticks == 3
        page.select_option("#option", "ORCA")
        page.click("#hold")
        for tick in range(1, 6):
            step(page)
            assert session.worlds.physics.positions[3].tolist() == foretold[tick]
        page.keyboard.press(" ")
        until(page, "() => replay.page.state.playing && !document.querySelector('[data-foretold]')")
