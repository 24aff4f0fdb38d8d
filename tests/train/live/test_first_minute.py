"""The first minute of a play: it opens with the best strategy, jams beside it, and ends with a verdict."""

from itertools import count

import pytest

from tests.train.live.pages import drag, free_place, on_screen, until
from tests.train.live.sessions import SMALL, ordered, play_of, served
from train.live.chosen import AVOIDING, NEVER, STRATEGY, TRAINED, chosen, usual
from train.live.session import Session

FRAMES = "() => replay.page.run.frames"
SIZES = ((1366, 768), (1440, 1100), (390, 844))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("crowded", (AVOIDING, STRATEGY)),
        ("crowded-exploring", (TRAINED, NEVER)),
        ("table1", (STRATEGY, "")),
        ("bumpers", (AVOIDING, "")),
        ("ReachGoal", (STRATEGY, "")),
    ],
)
def test_a_mission_opens_with_the_strategy_that_is_best_there(name, expected):
    play = chosen(name, 1, 0, None, ())
    assert (play.strategy, *usual(play.scenario.mission, ())) == (expected[0], *expected)
    assert chosen(name, 1, 0, "Random", ()).strategy == "Random"


def test_something_happens_within_ten_seconds(tmp_path):
    session = Session(chosen("crowded", 1, 0, None, ()), tmp_path / "crowded.swarm", minds=False)
    for _ in range(50):
        session.tick()
    assert (session.worlds.task.garbage.cargo >= 0).sum() >= 5
    assert session.worlds.task.garbage.recycled.any()
    session.close()


def test_an_order_opens_a_mission_under_another_strategy(session, tmp_path):
    paths = (tmp_path / f"{number}.swarm" for number in count())
    with served(session, others={"": lambda: Session(play_of(SMALL), next(paths), minds=False)}) as server:
        assert ordered(server, do="open", name="", strategy="fixed:ORCA") == ""
        assert server.conductor.stream.state["strategy"] == "fixed:ORCA"
        for strategy in ("os:system", "policy:x.zip", "", None, 3, float("nan"), ["fixed:ORCA"], "x" * 5000):
            said = ordered(server, do="open", name="", strategy=strategy)
            assert (said == "") == (strategy == ""), said
            assert len(said.splitlines()) <= 1
        assert server.conductor.stream.state["strategy"] == "MaxScore"
        assert ordered(server, do="step") == ""  # the session that was there goes on


@pytest.mark.page
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_world_fits_without_scrolling(session, watched, size, scheme):
    page, said, _ = watched(viewport={"width": size[0], "height": size[1]}, color_scheme=scheme)
    with served(session) as server:
        page.goto(server.address)
        page.wait_for_selector("body[data-ready]")
        box = page.locator(".world").bounding_box()
        assert box["y"] >= 0.0
        assert box["y"] + box["height"] <= size[1]
        assert box["height"] >= (560 if size[0] > 900 else 360)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        opened = page.evaluate("[...document.querySelectorAll('#groups details:not(#keys)')].map(group => group.open)")
        assert set(opened) == {size[0] > 900}
    assert said == []


@pytest.mark.page
def test_only_kinds_of_events_that_happened_have_a_line(session, opened):
    with served(session) as server:
        page = opened(server)
        assert page.text_content("#kinds") == "no event yet"
        page.click("#play")
        until(page, "() => replay.page.run.frames > 60")
        shown = page.evaluate("[...document.querySelectorAll('#kinds span')].map(line => line.textContent)")
        assert "item found" in shown
        assert "stopped by a collision" not in shown
        assert len(shown) * 12 == page.evaluate("document.querySelector('#timeline').height")


@pytest.mark.page
def test_a_paused_play_says_what_to_do(session, opened):
    with served(session) as server:
        page = opened(server)
        assert page.text_content(".banner").startswith("Ready: press Play or space")
        page.keyboard.press(" ")
        until(page, "() => document.querySelector('.banner').hidden")
        page.keyboard.press(" ")
        until(page, "() => document.querySelector('.banner').textContent === 'Paused. Space goes on.'")


@pytest.mark.page
def test_a_robot_is_dragged_while_the_world_runs(session, opened):
    with served(session, speed=0.25, playing=True) as server:
        page = opened(server)
        until(page, "() => replay.page.run.frames > 2")
        place = free_place(session)
        drag(page, [page.evaluate(f"replay.page.shown[0].view.{axis}[2]") for axis in "xy"], place)
        until(page, "() => replay.page.run.byHand.concat(replay.page.run.coming).some(({robot}) => robot === 2)")
        assert page.evaluate("replay.page.state.playing")


@pytest.mark.page
def test_click_and_drag_take_the_same_things(session, opened):
    """Ten pixels beside the middle of an item or robot is near enough for both, 40 for none."""
    with served(session) as server:
        page = opened(server)
        page.evaluate("replay.page.choose(0, 0)")
        robot = [page.evaluate(f"replay.page.shown[0].view.{axis}[3]") for axis in "xy"]
        x, y = on_screen(page, *robot)
        for away, near in ((10, True), (60, False)):
            page.evaluate("replay.page.choose(0, 0)")
            page.mouse.click(x + away, y)
            assert page.text_content("#panel h2") == ("Robot 3" if near else "Robot 0")
            page.mouse.move(x + away, y)
            page.mouse.down()
            assert page.evaluate("replay.page.taken?.number ?? -1") == (3 if near else -1)
            page.mouse.up()


@pytest.mark.page
def test_the_pointer_says_what_a_press_would_do(session, opened):
    with served(session) as server:
        page = opened(server)
        robot = [page.evaluate(f"replay.page.shown[0].view.{axis}[3]") for axis in "xy"]
        page.mouse.move(*on_screen(page, *robot))
        assert page.text_content("#hint") == "a click chooses robot 3, dragging moves the robot"
        assert page.evaluate("document.querySelector('.world').style.cursor") == "grab"
        page.mouse.move(*on_screen(page, *free_place(session)))
        assert page.locator("#hint").is_hidden()
        page.select_option("#tool", "add_item")
        page.mouse.move(*on_screen(page, *robot))
        assert page.text_content("#hint") == "a click adds an item here"


@pytest.mark.page
def test_the_end_has_a_verdict_and_leads_on(tmp_path, opened):
    paths = (tmp_path / f"{number}.swarm" for number in count())
    short = play_of({**SMALL, "time_limit": 2.0, "robots": {"count": 10}}, "fixed:ORCA")
    sessions = {
        "": lambda: Session(short, next(paths)),
        "ReachGoal": lambda: Session(chosen("ReachGoal", 1, 0, None, ()), next(paths), minds=False),
    }
    with served(sessions[""](), others=sessions) as server:
        page = opened(server)
        page.click("#play")
        until(page, "() => !document.querySelector('.verdict').hidden")
        assert page.text_content(".verdict h2") == "Not clean: 0 of 8 items when the time was over."
        assert page.text_content("#jam") == "Watch it jam (MaxScore)"
        page.click("[data-press=jam]")
        until(page, "() => window.replay?.page?.state.number === 2")
        page.click("#play")
        until(page, "() => !document.querySelector('.verdict').hidden")
        assert page.text_content("figcaption b").endswith(", MaxScore")
        assert page.text_content("#jam") == "Watch the best (fixed:ORCA)"
        plays = page.evaluate("[...document.querySelectorAll('.verdict td:first-child')].map(cell => cell.textContent)")
        assert sorted(plays) == ["MaxScore", "fixed:ORCA"]
        page.click("[data-press=open]")
        until(page, "() => document.title === 'Clean Swarm: ReachGoal, live'")


@pytest.mark.page
def test_a_keyboard_is_enough(session, opened):
    with served(session) as server:
        page = opened(server)
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
        assert page.text_content("#panel h2") == "Robot 1"
        page.focus("#strategy")
        page.keyboard.press("ArrowDown")
        until(page, "() => replay.page.state.strategy !== 'MaxScore'")
        assert page.text_content("#panel h2") == "Robot 1"


@pytest.mark.page
def test_every_control_has_a_plain_line(session, opened):
    with served(session) as server:
        page = opened(server)
        without = page.evaluate(
            "[...document.querySelectorAll('button, select, summary, label, input:not([data-layer])')]"
            ".filter(one => one.checkVisibility() && !one.title && !one.closest('.charts')).map(one => one.outerHTML)"
        )
        assert without == []
