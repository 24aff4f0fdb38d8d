"""The replay page in a headless Chromium: it plays, scrubs, shows its recordings' numbers, and asks for nothing."""

from itertools import product

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.recording.reader import RecordedMission, events_of
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import SeenItem, Sensed
from tests.clean_swarm_env.courses import run_recorded
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from tests.train.live.pages import picture, shows, until
from tests.train.records import checksums
from train.replay.page_file import write_page

pytestmark = [pytest.mark.page, pytest.mark.extra]


def test_every_channel_has_the_same_checksum_in_python_and_in_the_page(opened, recordings):
    page = opened()
    assert page.evaluate("replay.checksums()") == [checksums(recording) for recording in recordings]


def test_it_plays_and_stops(opened):
    page = opened("#t=10")
    page.click("#play")
    until(page, "() => replay.page.time >= 12.0")
    page.keyboard.press(" ")
    shows(page, "#play", "Play")
    stopped = page.evaluate("replay.page.time")
    assert abs(stopped / 0.2 - round(stopped / 0.2)) < 1e-6
    page.wait_for_timeout(300)
    assert page.evaluate("replay.page.time") == stopped


def test_keys_move_one_step(opened):
    page = opened("#t=10")
    page.focus("#time")  # where the slider has keys of its own
    for key, expected in (("ArrowRight", 10.2), ("ArrowLeft", 10.0), ("Shift+ArrowRight", 11.0), ("Home", 0.0)):
        page.keyboard.press(key)
        assert page.evaluate("replay.page.time") == pytest.approx(expected), key
    page.keyboard.press("End")
    assert page.evaluate("replay.page.time === replay.page.end")
    page.keyboard.press("ArrowUp")
    assert page.evaluate("replay.page.robot") == 1


@pytest.mark.long
def test_the_timeline_and_the_charts_scrub(opened):
    page = opened()
    for selector in ("#timeline", ".chart >> nth=1"):
        box = page.locator(selector).bounding_box()
        page.click(selector, position={"x": box["width"] / 2, "y": 40})
        assert page.evaluate("replay.page.time / replay.page.end") == pytest.approx(0.5, abs=0.01)
        page.keyboard.press("Home")


@pytest.mark.long
def test_a_link_opens_a_moment_and_the_address_follows(opened, recordings):
    page = opened("#t=8.4&robot=3&run=1")
    assert page.text_content("#panel h2") == "Robot 3"
    assert page.text_content("#now") == "8.4 s"
    assert page.text_content("[data-channel=x]") == f"{recordings[1]['x'][42, 3]:.3f}"
    page.keyboard.press("ArrowRight")
    assert page.evaluate("location.hash") == "#t=8.6&robot=3&run=1"


@pytest.mark.long
def test_the_page_of_a_robot_by_itself_opens_on_this_robot(opened, tmp_path):
    robot = RobotProcess("table1", 2, record=RecordSettings(tmp_path))
    lies = {"items": {0: SeenItem(2.0, 3.0)}}
    loads = [lies, lies, {"cargo": (0,)}, {"cargo": (0,), "recycled": True}, {}]
    for tick, held in enumerate(loads):
        robot.sense(Sensed(stamp=0.2 * tick, x=2.0, y=3.0, heading=0.0, **held))
        robot.step(0.2 * tick)
    robot.step(1.0)
    robot.close()
    write_page([RecordedMission(tmp_path / "robot_2.swarm")], tmp_path / "robot.html")
    page = opened("", tmp_path / "robot.html")
    assert page.text_content("#panel h2") == "Robot 2"
    assert "It is not there" not in page.text_content("#panel")
    kinds = page.evaluate("replay.events()[0].map(e => e.kind).filter(kind => kind !== 'switch')")
    assert kinds == ["found", "recycled", "dumped"]


@pytest.mark.long
def test_two_runs_stay_on_one_clock_and_part_where_they_part(opened, recordings):
    one, other = recordings
    frames = min(one.frames, other.frames)
    differ = [(one.whole(name)[:frames] != other.whole(name)[:frames]).any(axis=1) for name in ("x", "y", "heading")]
    parting = int(np.flatnonzero(np.any(differ, axis=0))[0])
    page = opened()
    assert page.text_content("#parting") == f"The runs part at {parting * 0.2:.1f} s"
    page.click("#parting")
    assert page.evaluate("replay.page.shown.map(({run}) => replay.page.frameOf(run))") == [parting, parting]


@pytest.mark.long
def test_a_robot_that_is_clicked_is_chosen_where_it_is(opened, recordings):
    page = opened("#t=15")
    recording, frame = recordings[0], 75
    box = page.locator(".world >> nth=0").bounding_box()
    head = recording.head
    for robot in (0, 4, 7):
        x = box["x"] + recording["x"][frame, robot] / head["width"] * box["width"]
        y = box["y"] + (1.0 - recording["y"][frame, robot] / head["height"]) * box["height"]
        page.mouse.click(x, y)
        assert page.text_content("#panel h2") == f"Robot {robot}"
        assert page.text_content("[data-channel=y]") == f"{recording['y'][frame, robot]:.3f}"
        held = head["options"]["AvoidCollision"][recording["held/AvoidCollision"][frame, robot]]
        assert page.text_content("[data-held]") == held


@pytest.mark.long
def test_fingers_choose_move_and_zoom(opened, recordings):
    page = opened("#t=15", has_touch=True)
    recording, box = recordings[0], page.locator(".world >> nth=0").bounding_box()
    place = recording["x"][75, 4] / 11.0 * box["width"], (1.0 - recording["y"][75, 4] / 11.0) * box["height"]
    page.touchscreen.tap(box["x"] + place[0], box["y"] + place[1])
    assert page.text_content("#panel h2") == "Robot 4"
    fingers = page.context.new_cdp_session(page)

    def touch(kind: str, *shares: tuple[float, float]) -> None:
        points = [{"x": box["x"] + x * box["width"], "y": box["y"] + y * box["height"]} for x, y in shares]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", (0.4, 0.5), (0.6, 0.5))
    touch("touchMove", (0.3, 0.5), (0.7, 0.5))
    touch("touchEnd")
    assert page.evaluate("replay.page.shown[0].view.zoom") == pytest.approx(2.0, rel=0.02)
    assert page.text_content("#panel h2") == "Robot 4"
    touch("touchStart", (0.5, 0.5))
    touch("touchMove", (0.25, 0.5))
    touch("touchEnd")
    x, y = page.evaluate("replay.page.shown[0].view.centre")
    assert (x, y) == pytest.approx((5.5 + 0.25 * 11.0 / 2.0, 5.5), abs=0.1)


@pytest.mark.long
def test_any_robot_at_any_time_is_explained_as_by_the_command(opened, explained, recordings):
    page = opened()
    places = [np.stack([recording["x"], recording["y"]], axis=-1) for recording in recordings]
    steps = [np.linalg.norm((np.diff(place, axis=0) + 5.5) % 11.0 - 5.5, axis=-1) for place in places]
    for k, frame, robot, step in explained(page, 20, seed=16):
        rows = page.evaluate(
            "[...document.querySelectorAll('[data-network=robot]')].map(row => ({...row.dataset,"
            " why: row.querySelector('.why').textContent, ran: row.querySelector('[data-ran]')?.textContent}))"
        )
        assert {row["behaviour"] for row in rows} == {account["name"] for account in step["behaviours"]}
        shown = {row["behaviour"]: row for row in rows}
        if recordings[k]["working"][frame, robot]:
            still = f"It has stayed within 0.1 m for {step['stayed_s']:.1f} s."
            moves = f"It moves at {steps[k][frame - 1, robot] / 0.2:.2f} m/s."
            assert page.text_content("[data-movement]") == (still if step["stayed_s"] >= 1.0 else moves)
        for account in step["behaviours"]:
            row, ran = shown[account["name"]], step["running_s"].get(account["name"])
            assert row["why"] == account["why"]
            assert row.get("ran") == (None if ran is None else f"for {ran:.1f} s")
            assert (row["running"] == "1") == account["running"]
            assert float(row["activation"]) == pytest.approx(account["activation"], abs=0.00051)
            parts = [float(part) for part in row["parts"].split(" ")]
            assert parts == pytest.approx(list(account["components"].values()), abs=0.00051)
        read = page.evaluate(
            "[...document.querySelectorAll('[data-sensor]')].map(c => [c.dataset.sensor, +c.dataset.value])"
        )
        assert dict(read) == pytest.approx(step["readings"], abs=0.00051)
        goals = page.evaluate(
            "[...document.querySelectorAll('[data-goal]')].map(c => [c.dataset.goal, +c.dataset.value])"
        )
        assert dict(goals) == pytest.approx({g["name"]: g["satisfaction"] for g in step["goals"]}, abs=0.00051)
        plan = page.evaluate("[...document.querySelectorAll('[data-step]')].map(step => step.textContent)")
        assert plan == (step["plan"] or [])
        assert page.text_content("[data-held]") == step["options"]["AvoidCollision"]


@pytest.mark.long
def test_events_are_those_of_the_recording(opened, recordings):
    page = opened()
    counted = page.evaluate(
        "replay.events().map(events => {"
        " const n = {}; for (const e of events) n[e.kind] = (n[e.kind] ?? 0) + 1; return n; })"
    )
    for recording, counts in zip(recordings, counted, strict=True):
        assert counts.get("dumped", 0) == recording.result["garbage_done"]
        came = np.diff(recording["working"], axis=0)
        assert (counts.get("joined", 0), counts.get("failed", 0)) == ((came > 0).sum(), (came < 0).sum())
        assert came.any()
        assert counts.get("switch", 0) == (np.diff(recording["held/AvoidCollision"], axis=0) != 0).sum()
        assert counts.get("contact", 0) == (recording["contact"][1:] > 0).sum()
    page.keyboard.press("End")
    dumped = recordings[0].result["garbage_done"]
    assert page.locator(".score >> nth=0").text_content().startswith(f"{dumped} of 8 items dumped")


LAYERS = {"fields", "reach", "view", "seen", "paths", "command", "added", "target", "causes"}
"""Those that show something at one of the moments below; contacts may be none there."""
SIGNS = {"command", "what the mechanism adds", "way to the target", "neighbours that count"}


@pytest.mark.long
def test_layers_following_and_colours_change_what_is_drawn_and_have_a_legend(opened):
    page, changing = opened(), set()
    for moment, robot in product((5, 10, 20, 30), range(8)):  # at some of them nobody is seen
        page.evaluate(f"replay.page.go({moment}); replay.page.choose(0, {robot})")
        for name in LAYERS - changing:
            before = picture(page)
            page.click(f"[name={name}]")
            changing |= {name} if picture(page) != before else set()
    assert changing == LAYERS
    drawn = [picture(page)]
    for change in (lambda: page.keyboard.press("f"), lambda: page.click("#theme")):
        change()
        drawn.append(picture(page))
    assert len(set(drawn)) == 3
    signs = dict(
        page.evaluate(
            "[...document.querySelectorAll('#legend span, #boxes label:has(.key)')]"
            ".map(sign => [sign.textContent.trim(), sign.title])"
        )
    )
    assert signs.keys() >= SIGNS
    assert all(signs.values())


@pytest.mark.long
def test_the_field_is_highest_where_robots_have_just_been(opened):
    page = opened("#t=20")
    assert page.evaluate(
        "(() => { const {run, view} = replay.page.shown[0], field = view.field, reach = [...field.at(100)];"
        " const N = run.head.robots, at = (name, t, i) => run.tracks.get(name).data[t * N + i];"
        " const cell = (t, i) => Math.floor(at('y', t, i) / 11000 * field.ny) * field.nx"
        " + Math.floor(at('x', t, i) / 11000 * field.nx);"
        " const left = []; for (let t = 90; t < 100; t++) for (let i = 0; i < 8; i++)"
        " if (at('deposit', t, i)) left.push(reach[cell(t, i)]);"
        " return left.length > 10 && Math.min(...left) > 0.99 && Math.min(...reach) < 0.5; })()"
    )


@pytest.fixture
def page_of(opened, tmp_path):
    """Record a mission; return its page at a link, and its recording."""

    def open_page(mission, link, **settings):
        recording = run_recorded(mission, 3, 3, tmp_path, minds=True)
        write_page([recording], tmp_path / "page.html")
        return opened(link, tmp_path / "page.html", **settings), recording

    return open_page


def colour_of(page, place):
    """Return red, green and blue where a thing is drawn; `place` returns [x, y] on the canvas."""
    return page.evaluate(
        "(() => { const { run, view } = replay.page.shown[0];"
        f" const [x, y] = {place};"
        " return [...view.canvas.getContext('2d').getImageData(x, y, 1, 1).data]; })()"
    )[:3]


@pytest.mark.long
def test_the_page_of_a_task_shows_its_things_its_measures_and_the_minds(page_of):
    mission = MissionConfig.model_validate({"task": "Foraging", "time_limit": 90.0})
    page, recording = page_of(mission, "#t=10&robot=4")
    assert "keeps running" in page.text_content("#panel")
    assert "items dumped" not in page.text_content("#runs").lower()
    red, green, blue = colour_of(
        page,
        "(([x, y]) => [x, y - 7])(view.place(...(({ x, y }) => [x, y])"
        "(run.head.things.find((thing) => thing.channel === 'food'))))",
    )
    assert green > max(red + 20, blue)
    page.keyboard.press("End")
    (value,) = recording.result["measures"].values()
    shows(page, "figcaption", f"items brought per minute {value:.3g}", "includes")
    brought = page.evaluate("replay.events()[0].filter(e => e.kind === 'item brought').map(e => [e.frame, e.robot])")
    assert brought == [[round(one.time / recording.period), one.number] for one in events_of(recording)] != []
    assert "item brought" in page.text_content("#kinds")


@pytest.mark.long
def test_things_that_move_are_drawn_where_they_are(page_of, monkeypatch):
    with_shepherding(monkeypatch)
    mission = MissionConfig.model_validate({"task": "Shepherding", "time_limit": 12.0})
    page, recording = page_of(mission, "#t=12&robot=1")
    x, y = (recording[name][-1] for name in ("thing_x", "thing_y"))
    assert np.hypot(x - recording["thing_x"][0], y - recording["thing_y"][0]).max() > 0.5
    drawn = page.evaluate(
        "(() => { const { run, view } = replay.page.shown[0];"
        " return run.head.things.map((thing) => replay.placeOf(view, thing, run.frames - 1, 0)); })()"
    )
    assert np.allclose(drawn[0], [4.0, 3.0])
    assert np.allclose(drawn[1:], np.stack([x, y], axis=1))


@pytest.mark.long
@pytest.mark.parametrize("size", [(1366, 768), (390, 844)])
def test_zones_walls_and_models_are_drawn_and_explained(page_of, size):
    """A mission with a silent zone and a wall, whose robots are of two models, at a desk and on a phone."""
    groups = [{"model": model, "count": 3} for model in ("scout", "carrier")]
    walls = [{"corners": [[3.0, 0.0], [3.0, 4.0]]}]
    changes = {"robots": {"groups": groups}, "time_limit": 6.0, "world": {"walls": walls}}
    held = load_mission("silent-zone").model_dump() | {"robots": {}}
    mission = MissionConfig.model_validate(with_changes(held, changes))
    page, _ = page_of(mission, "#t=3&robot=1", viewport={"width": size[0], "height": size[1]})
    for name in ("fields", "paths"):
        page.evaluate(f"document.querySelector('[name={name}]').click()")
    inside, outside = (colour_of(page, f"view.place({x}, 0.15)") for x in (8.0, 13.0))
    assert outside == [251, 250, 247]  # paper
    assert np.subtract(outside, inside).min() > 5
    legend = page.text_content("#legend")
    assert {"scout", "carrier"} & set(legend.split())
    assert "zone of lost messages or slow ground" in legend
    assert "wall" in legend.split()
    shown = picture(page)
    page.evaluate("document.querySelector('[name=numbers]').click()")
    assert picture(page) != shown
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
