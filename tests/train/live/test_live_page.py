"""The page of a session in a headless Chromium: it shows what runs, and what is done by hand happens in the world.

Everything on the page is waited for: it is drawn a picture or more after the server has answered.
"""

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from tests.train.live.pages import FRAMES, drag, free_place, on_screen, picture, place_of, shows, step, until
from tests.train.live.sessions import SMALL, ordered, play_of, served
from tests.train.records import checksums
from train.live.session import Session

pytestmark = [pytest.mark.page, pytest.mark.extra]
COURSE = (
    "([name, robot]) => { const { data, columns } = replay.page.run.tracks.get(name);"
    " return [...Array(28).keys()].map(k => data[(k + 1) * columns + robot] / 1000); }"
)
"""A coordinate of a robot in the frames from 1 on [m]."""
SHOWN_AT = (
    "([robot, x, y]) => { const { view } = replay.page.shown[0];"
    " return Math.hypot(view.x[robot] - x, view.y[robot] - y) < 0.05; }"
)
"""A robot is drawn at a place [m]."""
SET_LOSS = (
    "() => { const loss = document.querySelector('#loss'); loss.value = 0.6; loss.dispatchEvent(new Event('change')); }"
)


def test_a_robot_that_is_dragged_is_there_and_the_world_goes_on(session, opened):
    with served(session) as server:
        page = opened(server)
        place = free_place(session)
        drag(page, place_of(page, 2), place)
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


def test_the_world_is_there_before_the_first_step(session, page):
    assert page.text_content("#now") == "0.0 s"
    assert page.text_content(".score").startswith("0 of 8 items dumped0 collisionscost so far 0 s")
    shown = [page.evaluate(f"[...replay.page.shown[0].view.{axis}]")[:6] for axis in "xy"]
    assert np.transpose(shown) == pytest.approx(session.worlds.physics.positions[:6], abs=0.002)
    assert page.evaluate("replay.page.shown[0].view.rows") == list(range(6))
    assert page.is_disabled("[name=walls]")
    assert "walls (this world has none)" in page.text_content("#layers")
    assert page.evaluate(FRAMES) == session.ticks == 0
    step(page)
    shows(page, "#now", "0.2 s")


@pytest.mark.long
def test_items_are_dragged_added_and_taken_away(session, page):
    garbage, place = session.worlds.task.garbage, free_place(session)
    drag(page, garbage.positions[0, 0].tolist(), place)
    until(page, "() => !replay.page.taken")
    step(page)
    assert garbage.positions[0, 0] == pytest.approx(place, abs=0.05)
    page.select_option("#tool", "add_item")
    other = free_place(session)
    page.mouse.click(*on_screen(page, *other))
    step(page)
    assert garbage.positions[0, 8] == pytest.approx(other, abs=0.05)
    page.select_option("#tool", "remove_item")
    page.mouse.click(*on_screen(page, *other))
    step(page)
    assert garbage.stage[0, 8] == 3


@pytest.mark.long
def test_robots_are_added_fail_and_go(session, page):
    page.select_option("#tool", "add_robot")
    page.mouse.click(*on_screen(page, *free_place(session)))
    step(page)
    assert session.worlds.physics.present[6]
    page.evaluate("replay.page.choose(0, 3)")
    page.click("#fail")
    step(page)
    shows(page, "#panel", "It has failed", "includes")
    page.click("#remove")
    step(page)
    assert not session.worlds.physics.present[3]
    page.click("#remove")
    shows(page, "#said", "robot 3: expected a robot that is there")
    kinds = page.evaluate("replay.events()[0].filter(e => e.kind === 'hand').map(e => [e.frame, e.robot])")
    assert kinds == [[0, -1], [1, 3], [2, 3]]


@pytest.mark.long
def test_options_strategies_and_losses_are_switched(session, page):
    page.evaluate("replay.page.choose(0, 4)")
    page.select_option("#option", "RepulsionFernandez-view2.0")
    page.click("#hold")
    step(page)
    shows(page, "[data-held]", "RepulsionFernandez-view2.0")
    assert session.worlds.coordinators[0].held[:6].tolist() == [0, 0, 0, 0, 3, 0]
    page.select_option("#option", "RepulsionGradient-view0.5")
    page.click("#hold_all")
    step(page)
    assert set(session.worlds.coordinators[0].held.tolist()) == {5}
    page.select_option("#strategy", "fsm:rule")
    shows(page, "figcaption b", ", fsm:rule", "endsWith")
    shows(page, "#panel p", ", fsm:rule", "endsWith")
    page.evaluate(SET_LOSS)
    until(page, "() => replay.page.state.loss === 0.6")
    shows(page, "#loss_now", "60 %")
    assert session.strategy.startswith("fsm:rule sha256")
    for _ in range(4):
        step(page)
    assert page.evaluate("replay.page.run.tracks.get('missed').data.some(missed => missed > 0)")
    page.evaluate("replay.page.go(0)")
    shows(page, "figcaption b", ", MaxScore", "endsWith")


def test_any_speed_is_in_the_list_and_a_fixed_option_stands_alone(session, opened):
    with served(session, speed=3.0) as server:
        page = opened(server)
        speed = "() => document.querySelector('#speed').selectedOptions[0]?.textContent === '{}x'"
        until(page, speed.format(3))
        page.keyboard.press("-")
        until(page, speed.format(2))
        assert ordered(server, do="speed", speed=0.3) == ""
        until(page, speed.format(0.3))
        assert ordered(server, do="follow_strategy", strategy="fixed:ORCA") == ""
        for _ in range(6):
            step(page)
        shows(page, "#panel h3 ~ table", "ORCA")
        assert page.evaluate("[...document.querySelectorAll('#panel h3 ~ table')][0].rows.length") == 1
        shows(page, "#panel details.others", "9 other options, 0.00")
        page.evaluate("document.querySelector('#panel details.others').open = true")
        step(page)
        assert page.evaluate("document.querySelector('#panel details.others').open")


@pytest.mark.long
def test_what_was_is_looked_at_while_the_world_goes_on(session, opened):
    with served(session, speed=1.0, playing=True) as server:
        page = opened(server)
        until(page, "() => replay.page.run.frames > 20")
        page.evaluate("replay.page.go(2)")
        until(page, "([frames]) => replay.page.run.frames > frames + 10", page.evaluate(FRAMES))
        assert page.text_content("#now") == "2.0 s"
        page.click("#head")
        until(page, "() => replay.page.atHead && replay.page.time > 5")
        page.keyboard.press(" ")
        until(page, "() => !replay.page.state.playing && replay.page.run.ahead && !replay.page.waiting")  # it is drawn
        frames = session.ticks
        page.keyboard.press("ArrowRight")
        until(page, "([frames]) => replay.page.run.frames === frames + 1", frames)
        other = opened(server)  # a page that is opened later has the whole run
        assert other.evaluate("replay.checksums()") == page.evaluate("replay.checksums()")
        other.select_option("#speed", label="20x")
        until(page, "() => document.querySelector('#speed').selectedOptions[0].textContent === '20x'")
    recording = RecordedMission(session.batch.recorder.settings.directory / "run.swarm")
    assert page.evaluate("replay.checksums()") == [checksums(recording)]


@pytest.mark.long
def test_a_server_that_goes_is_told_and_what_came_stays(session, opened, tmp_path):
    gone = "The server does not answer. The page tries again; what came until now stays."
    with served(session) as server:
        page = opened(server)
        port = server.server_address[1]
        step(page)
    shows(page, "#said", gone)
    page.evaluate("replay.page.go(0)")
    shows(page, "#now", "0.0 s")
    page.click("#play")
    shows(page, "#said", gone)
    with served(Session(play_of(SMALL), tmp_path / "other.swarm"), port=port):
        shows(page, "#said", "This session is over")
        assert page.evaluate(FRAMES) == 1


@pytest.mark.long
def test_after_the_end_the_same_mission_or_another_one_begins(sessions, tmp_path, opened):
    opening = sessions(play_of({**SMALL, "time_limit": 2.0}))
    with served(opening[""](), others=opening) as server:
        page, other = opened(server), opened(server)
        page.click("#play")
        shows(page, ".caption", "not completed", "includes")
        shows(page, "#play", "Over")
        page.click("#again")
        until(page, "() => globalThis.replay?.page.run.frames === 0 && replay.page.state.name === ''")
        until(other, "() => globalThis.replay?.page.run.frames === 0")  # another page of the session goes along
        step(page)
        page.select_option("#mission", "ReachGoal")
        page.click("#open")
        until(page, "() => document.title === 'Clean Swarm: ReachGoal, live'")
        shows(page, "figcaption b", "ReachGoal, ")
        step(page)
    assert [RecordedMission(path).frames for path in sorted(tmp_path.glob("*.swarm"))] == [10, 1, 1]


@pytest.mark.long
def test_what_if_shows_the_next_seconds_of_every_option(session, page):
    for _ in range(3):
        step(page)
    page.evaluate("replay.page.choose(0, 3)")
    before = picture(page)
    page.click("#what_if")
    until(page, "() => document.querySelector('[data-foretold]')")
    shown = page.evaluate("[...document.querySelectorAll('[data-foretold]')].map(row => row.dataset.foretold)")
    assert shown == list(session.options)
    assert page.text_content("#panel h3").startswith("What if robot 3 took another option at 0.6 s: the next 5 s")
    assert picture(page) != before
    foretold = page.evaluate("replay.page.foretold.options.find(({option}) => option === 'ORCA').path")
    assert session.ticks == 3
    page.select_option("#option", "ORCA")
    page.click("#hold")
    for tick in range(1, 6):
        step(page)
        assert session.worlds.physics.positions[3].tolist() == foretold[tick]
    page.keyboard.press(" ")
    until(page, "() => replay.page.state.playing && !document.querySelector('[data-foretold]')")
