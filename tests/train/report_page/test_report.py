"""The report: its numbers are those of the runs, it needs nothing else, and what cannot be is one line."""

import json
import re
import shutil
from html import escape, unescape
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.train.commands import done, refused, runs
from train.analysis.statistics import by_scenario, summarise
from train.analysis.verdict import amount
from train.report_page.charts import distributions
from train.report_page.page import html_of_markdown
from train.reports.charts import draw_rows, panels
from train.reports.curves import draw_curves
from train.reports.results import results_in
from train.running import needs

FAMILY = {
    "name": "small",
    "description": "Four robots & <items>.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 20.0},
    "robots": [4, 4],
    "items": [4, 4],
}
CONDITIONS = ("fixed:RepulsionGradient-view0.5", "Random")
HISTORY = [
    {"checkpoint": 1, "decisions": 100, "crowded/excess_s": 50.0, "score": 4.0, "best": True},
    {"checkpoint": 2, "decisions": 200, "crowded/excess_s": 40.5, "score": None, "best": True},
]


class Text:
    """Texts of a page by the tag that they follow."""

    def __init__(self, page):
        self.found = {}
        for tag, text in re.findall(r"<(\w+)[^>]*>([^<]+)", page):
            self.found.setdefault(tag, []).append(unescape(text))


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    (folder / "small.yaml").write_text(yaml.safe_dump(FAMILY))
    words = [word for name in CONDITIONS for word in ("--strategy", name)]
    words += ["--scenarios", "3", "--workers", "1", "--record", "--output", str(folder / "run")]
    done("evaluate", folder / "small.yaml", *words)
    return folder / "run"


def costs_in(results):
    return {(row["scenario"], row["condition"]): float(row["cost_s"]) for row in runs(results)}


def trained(folder, history=HISTORY):
    """Write what a training leaves and return its directory."""
    folder.mkdir()
    (folder / "manifest.json").write_text(json.dumps({"identity": {"configuration": {"name": "mine"}}}))
    (folder / "history.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in history))
    return folder


def test_a_report_keeps_what_it_draws_and_is_refused_where_that_fills_the_memory(results, monkeypatch):
    kept = {name for recording in results_in(results).recordings for name in recording}
    assert kept == {"held/AvoidCollision", "working"}
    monkeypatch.setattr(needs, "memory_of_machine", lambda: needs.PROCESS + 12.0 * 1000)
    assert "numbers, for the memory, got more" in refused("report", results)


def test_the_figures_are_those_of_the_runs(results, tmp_path):
    page = tmp_path / "page.html"
    done("report", results, "--output", page)
    text, costs = Text(page.read_text()), costs_in(results)
    conditions = {condition for _, condition in costs}
    assert conditions == {*CONDITIONS, "fixed:Off"}  # which every evaluation has
    for name in conditions:
        found = summarise(np.array([value for (_, condition), value in costs.items() if condition == name]))
        low, high = found.ci95
        assert {amount(found.mean), f"[{amount(max(low, 0.0))}, {amount(high)}]"} <= set(text.found["text"])
    assert len(costs) == 9
    headings = [*text.found["h2"], *text.found["h3"]]
    for heading in ("Distributions", "Selection"):
        assert heading in headings
    assert "Random: AvoidCollision, 3 recorded runs" in headings
    assert not any("fixed:Off: AvoidCollision" in heading for heading in headings)
    assert any("Under fixed:Off every robot held Off for AvoidCollision all the time." in p for p in text.found["p"])
    assert json.loads(text.found["pre"][0]) == json.loads((results / "manifest.json").read_text())
    verdict = json.loads((results / "summary.json").read_text())["verdict"]
    assert verdict[1].startswith("3 scenarios cannot tell 3 strategies apart: 7 may")
    assert all(page.read_text().count(escape(sentence, quote=False)) == 1 for sentence in verdict)
    assert page.read_text().index("<blockquote>") < page.read_text().index("<table>") < page.read_text().index("<svg")
    assert "\n".join(verdict) in text.found["p"]
    assert "Four robots & <items>." in text.found["p"]
    assert {"share of robots", "Off"} <= set(text.found["text"])


def test_two_directories_are_compared_on_the_same_scenarios(results, tmp_path):
    other = shutil.copytree(results, tmp_path / "other")
    lines = [json.loads(line) | {"cost_s": 1.0} for line in (other / "runs.jsonl").read_text().splitlines()]
    (other / "runs.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    done("report", results, other, "--output", tmp_path / "two.html")
    text = Text((tmp_path / "two.html").read_text())
    mean = np.mean([cost for (_, condition), cost in costs_in(results).items() if condition == "Random"])
    assert {"run: Random", "other: Random", amount(mean), "1.0"} <= set(text.found["text"])
    for name in ("run", "other"):  # not taken together
        assert f"{name}: Random: AvoidCollision, 3 recorded runs" in text.found["h3"]


def test_a_training_has_its_curves_and_checkpoints(tmp_path):
    first, second = (trained(tmp_path / name) for name in ("first", "second"))
    done("report", first)
    text = Text((first / "report.html").read_text())
    assert {"crowded", "excess on validation [s]"} <= set(text.found["text"])
    assert {"200", "40.5"} <= set(text.found["td"])
    done("report", first, second, "--output", tmp_path / "both.html")
    text = Text((tmp_path / "both.html").read_text())
    assert "mine, 2 seeds" in text.found["text"]


def test_the_best_checkpoints_are_those_of_the_curve_that_is_drawn(tmp_path):
    """A training of the same name that has measured nothing yet has no curve."""
    unmeasured = trained(tmp_path / "unmeasured", [{"checkpoint": 1, "decisions": 100}])
    both = draw_curves([results_in(unmeasured), results_in(trained(tmp_path / "measured"))])
    assert [line.get_markevery() for line in both.axes[0].lines] == [[0, 1]]


def test_trainings_stand_beside_the_best_fixed_options(tmp_path):
    lost = {
        "learned": {"crowded": [30.0 + k for k in range(31)]},
        "yardstick": {"crowded": [60.0 + k for k in range(31)]},
    }
    folders = []
    for number in (1, 2, 3):
        entries = [entry | {"crowded/excess_s": entry["crowded/excess_s"] + number} for entry in HISTORY]
        folders.append(trained(tmp_path / f"seed{number}", entries))
        (folders[-1] / "validation.json").write_text(json.dumps({**lost, "held": "ORCA"}))
    done("report", *folders)
    page = (folders[0] / "report.html").read_text()
    assert "seed2: Validation on 31 scenarios of crowded" in page
    assert "the best checkpoint costs least: 45 s a mission" in page
    assert "mine, 3 seeds" in page
    assert "fixed: ORCA" in page
    for damaged in ("{}", '{"learned": {"crowded": []}, "yardstick": {"crowded": [1]}, "held": "ORCA"}', "[" * 100_000):
        (folders[1] / "validation.json").write_text(damaged)
        assert "validation.json: " in refused("report", *folders)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "nowhere: cannot be read (No such file or directory)"),
        (lambda path: path.mkdir(), "nowhere: has no manifest.json; expected the results of an evaluation"),
        (
            lambda path: (path.mkdir(), (path / "manifest.json").write_text('{"identity": {}}')),
            "nowhere: has neither finished runs (runs.jsonl) nor checkpoints (history.jsonl)",
        ),
    ],
)
def test_a_directory_that_is_none_of_results_is_one_line(tmp_path, monkeypatch, make, message):
    monkeypatch.chdir(tmp_path)
    make(Path("nowhere"))
    assert refused("report", "nowhere") == f"error: {message}\n"


def test_damaged_foreign_and_unlike_results_are_one_line(results, tmp_path):
    broken = shutil.copytree(results, tmp_path / "broken")
    recording = next((broken / "recordings").iterdir())
    recording.write_bytes(recording.read_bytes()[:8] + b"\x09\0\0\0")
    other = shutil.copytree(results, tmp_path / "other")
    text = (other / "runs.jsonl").read_text()
    (other / "runs.jsonl").write_text(text.replace('"experiment": "small"', '"experiment": "large"'))
    torn = shutil.copytree(results, tmp_path / "torn")
    (torn / "runs.jsonl").write_text(text[20:])
    for words, message in (
        ((broken,), f"{recording}: expected a recording of version 1, got version 9"),
        ((results, other), f"{other}: expected results of small to compare, got large"),
        ((torn,), f"{torn / 'runs.jsonl'}: line 1: expected a finished run"),
        ((results, results, results), "report: expected one or two evaluations, got 3"),
    ):
        assert refused("report", *words, "--output", tmp_path / "page.html").startswith(f"error: {message}")
    assert not (tmp_path / "page.html").exists()


def test_recordings_that_were_stopped_stop_neither_report_nor_replay(results, tmp_path):
    killed = shutil.copytree(results, tmp_path / "killed")
    recording = killed / "recordings" / "test-1-Random.swarm"
    data = recording.read_bytes()
    recording.write_bytes(data[: 12 + 12 + int.from_bytes(data[16:20], "little")])  # the head alone
    done("report", killed)
    assert "Random: AvoidCollision, 2 recorded runs" in Text((killed / "report.html").read_text()).found["h3"]
    for condition in ("Random", "fixed:Off"):  # that which was stopped is run again
        done("replay", killed, "--condition", condition, "--html", tmp_path / "page.html")


@pytest.mark.page
@pytest.mark.extra
@pytest.mark.parametrize("scheme", ["dark", pytest.param("light", marks=pytest.mark.long)])
def test_a_browser_shows_it_without_errors_or_requests(results, tmp_path, watched, scheme):
    page = tmp_path / "page.html"
    done("report", results, "--output", page)
    shown, told, asked = watched(color_scheme=scheme)
    shown.goto(page.as_uri())
    assert (told, asked) == ([], [page.as_uri()])
    assert shown.evaluate("[...document.querySelectorAll('svg')].every(chart => chart.clientHeight > 40)")
    back = shown.evaluate("getComputedStyle(document.body).backgroundColor")
    assert back == {"dark": "rgb(23, 25, 29)", "light": "rgb(255, 255, 255)"}[scheme]


@pytest.mark.page
@pytest.mark.extra
def test_a_desk_is_filled_and_all_words_can_be_read(results, tmp_path, watched):
    page = tmp_path / "page.html"
    done("report", results, "--output", page)
    shown, _, _ = watched(viewport={"width": 1366, "height": 850})
    shown.goto(page.as_uri())
    body = shown.locator("body").bounding_box()
    for one in ("table >> nth=0", "section >> nth=1"):  # the right one of two charts
        box = shown.locator(one).bounding_box()
        assert box["x"] + box["width"] >= body["x"] + body["width"] - 40
    least = "[...document.querySelectorAll('svg text')].map(word => word.getBoundingClientRect().height)"
    assert min(shown.evaluate(least)) >= 11  # [pixels]
    assert shown.evaluate(
        "[...document.querySelectorAll('body *:not(svg *)')].every(e => parseFloat(getComputedStyle(e).fontSize) > 10)"
    )
    assert shown.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_no_line_joins_the_scenarios_of_many_strategies():
    costs = np.arange(21.0).reshape(7, 3) + 1.0
    with panels(1, 1, (6.0, 4.0)) as (_, ((axes,),)):
        draw_rows(axes, costs, ("1", "2", "3"), list("abcdefg"), range(7))
        lines = [line for line in axes.get_lines() if len(set(line.get_ydata())) > 2]
    assert lines == []


def test_charts_of_known_costs():
    costs, names, scenarios = np.array([[10.0, 20.0], [15.0, 10.0], [np.nan, 40.0]]), ("<b>", "a", "c" * 99), ("1", "2")
    drawn = distributions(costs, scenarios, names)
    assert drawn == distributions(costs, scenarios, names)
    text = Text(drawn)
    assert {"<b>", f"{'c' * 41}..."} <= set(text.found["text"])
    assert {"15", "40"} <= set(text.found["text"])  # one scenario: no interval
    assert "currentColor" in drawn


def test_intervals_are_by_the_number_of_scenarios_however_many_worlds_each_has():
    rng, names = np.random.default_rng(1), [f"test-{k}{world}" for k in range(1, 13) for world in ("", ".2", ".3")]
    costs = rng.gamma(4.0, 25.0, (2, 12)).repeat(3, axis=1)  # the same in all worlds of a scenario
    one = by_scenario(costs[0], names)
    assert one == pytest.approx(costs[0, ::3])
    low, high = summarise(one).ci95
    assert f"[{amount(low)}, {amount(high)}]" in distributions(costs, names, ("a", "b"))
    assert by_scenario(np.array([1.0, 3.0, np.nan]), ["1.5", "1.6", "2"]).tolist() == [1.0, 3.0]  # names of starts


def test_markdown_becomes_tables_and_nothing_else():
    page = html_of_markdown("# One\n\n| a | <b> |\n|---|---:|\n| 1 | [2](x) |\n\nsome & ![text](x)\n")
    assert all(part in page for part in ("<h3>One</h3>", "<th>a</th>", "&lt;b&gt;</th>", "<td>1</td>", ">[2](x)</td>"))
    assert "<p>some &amp; ![text](x)</p>" in page
