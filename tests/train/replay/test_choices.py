"""What the page tells of choices: of a pair of options that is kept for a while, in the colours of either goal."""

import numpy as np
import pytest
import yaml

from clean_swarm_env.recording.reader import RecordedMission
from tests.train.commands import done

pytestmark = [pytest.mark.page, pytest.mark.extra, pytest.mark.long]
PAIR = {
    "name": "pair",
    "description": "Eight robots choose how they explore and how they avoid each other.",
    "mission": {
        "base": "exploring",
        "world": {"width": 11.0, "height": 11.0},
        "task": {"stations": {"recycling": [2.75, 5.5], "dump": [8.25, 5.5]}},
        "time_limit": 40.0,
    },
    "robots": [8, 8],
    "items": [8, 8],
}
GOALS = ("ExplorationPatrol", "AvoidCollision")


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Results of a policy that chooses both, of one that holds an option, and of those that every evaluation has."""
    folder = tmp_path_factory.mktemp("pair")
    (folder / "pair.yaml").write_text(yaml.safe_dump(PAIR))
    strategies = ("--strategy", "policy:one", "--strategy", "fixed:ORCA")
    settings = ("--scenarios", 1, "--workers", 1, "--minds", "--output", folder / "run")
    done("evaluate", folder / "pair.yaml", *strategies, *settings)
    done("replay", folder / "run", "--condition", "policy:one", "--html", folder / "page.html")
    return folder


@pytest.fixture
def recording(pair):
    return RecordedMission(pair / "run" / "recordings" / "test-1-policy_one.swarm")


def test_without_a_condition_the_two_cheapest_are_shown_and_the_others_named(pair, tmp_path):
    told = done("replay", pair / "run", "--html", tmp_path / "two.html")
    costs = {}
    for path in (pair / "run" / "recordings").iterdir():
        one = RecordedMission(path, ())
        costs[one.head["about"]["condition"]] = one.result["cost_s"]
    first, second, *others = sorted(costs, key=costs.__getitem__)
    assert f"it shows {first} beside {second}; also there: {', '.join(others)} (--condition); 1 scenarios" in told


def test_probabilities_of_each_goal_add_up(recording):
    for goal in GOALS:
        assert recording[f"opinion/{goal}"].sum(axis=2) == pytest.approx(1.0, abs=0.01)


def test_a_held_option_that_is_not_the_likeliest_is_explained(opened, pair, recording):
    page = opened("", pair / "page.html")
    held, opinions = recording["held/ExplorationPatrol"], recording["opinion/ExplorationPatrol"]
    below = np.take_along_axis(opinions, held[:, :, None], axis=2)[:, :, 0] < opinions.max(axis=2)
    assert below.any()
    assert not below.all()
    for wanted in (True, False):
        frame, robot = np.argwhere(below == wanted)[-1].tolist()
        page.evaluate(f"replay.page.choose(0, {robot}); replay.page.go({frame * 0.2})")
        told = page.evaluate("document.querySelector('[data-why=ExplorationPatrol]')?.textContent ?? ''")
        assert ("a choice is kept for 8 s" in told) == wanted
        shares = page.evaluate(
            "[...document.querySelector('h3 ~ table').querySelectorAll('td.n')].map(one => +one.textContent)"
        )
        assert sum(shares) == pytest.approx(1.0, abs=0.04)


def test_robots_have_the_colours_of_either_goal_and_the_legend_is_short(opened, pair, recording):
    page = opened("#t=20", pair / "page.html")
    for goal in GOALS:
        page.select_option("#goal", goal)
        held = np.unique(recording[f"held/{goal}"])
        legend = page.evaluate("[...document.querySelectorAll('#legend > span')].map(one => one.textContent)")
        assert {recording.head["options"][goal][k] for k in held} <= set(legend)
        assert len(legend) <= 12
        drawn = page.evaluate(
            "(() => { const { view } = replay.page.shown[0], i = 3, [x, y] = view.place(view.x[i], view.y[i]);"
            " const r = 0.6 * view.discs.find(([,,, k]) => k === i)[2], turn = -view.turn[i] + Math.PI / 2;"
            " const c = view.canvas.getContext('2d');"
            " return [...c.getImageData(x + r * Math.cos(turn), y + r * Math.sin(turn), 1, 1).data]; })()"
        )[:3]
        own = recording[f"held/{goal}"][100, 3]
        colour = page.evaluate(f"JSON.parse(document.querySelector('#look').textContent).options[{own}]")
        assert np.abs(np.subtract(drawn, [int(colour[k : k + 2], 16) for k in (1, 3, 5)])).max() < 12


@pytest.mark.parametrize("width", [1366, 390])
def test_no_word_of_the_timeline_is_cut(opened, pair, width):
    page = opened("", pair / "page.html", viewport={"width": width, "height": 844})
    words = page.evaluate(
        "[...document.querySelectorAll('#kinds span')].map(one => [one.offsetLeft, one.scrollWidth - one.clientWidth])"
    )
    assert len(words) >= 5
    left = page.evaluate("document.querySelector('#events').getBoundingClientRect().left")
    assert all(at >= left and cut <= 0 for at, cut in words)
    kinds, line = (page.locator(one).bounding_box() for one in ("#kinds", "#timeline"))
    assert kinds["x"] + kinds["width"] <= line["x"]


def test_the_parts_of_the_cost_add_up_at_every_moment(opened, pair):
    page = opened("", pair / "page.html")
    for time in (0.0, 7.4, 20.0, 33.0):
        page.evaluate(f"replay.page.go({time})")
        whole, seconds, rest = page.evaluate(
            "document.querySelector('.score').textContent"
            ".match(/cost so far (\\d+) s = (\\d+) s \\+ (\\d+) s for \\d+ coll/).slice(1).map(Number)"
        )
        assert whole == seconds + rest
        assert seconds == round(float(page.text_content("#now").removesuffix(" s")))
    page.evaluate("replay.page.shown[0].counts.contacts.fill(437); replay.runs[0].head.prices.limit = 600")
    page.evaluate("replay.page.draw()")
    assert "788 s for 437 collisions (874 s one by one: beyond 600 s each costs less)" in page.text_content(".score")
