"""Strategies under disturbances, by the command line: figures, going on, repeated runs, mistakes."""

import json

import pytest
import scipy.stats
import yaml

from clean_swarm_env.config.load import load_experiment
from selector.documents.errors import DocumentError
from tests.train.commands import cut, done, refused, runs
from tests.train.records import record
from train.analysis.intervals import share_interval
from train.analysis.robustness_report import RobustnessReport
from train.analysis.runs import Runs
from train.evaluation.repeat import task_of
from train.running.runs import under

pytestmark = pytest.mark.usefixtures("undrawn")
SMALL = {
    "name": "small",
    "description": "Two disturbances.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 20.0, "task": {"garbage": {"count": 3}}},
    "items": [3, 3],
    "scenarios": 2,
    "strategies": ["fixed:RepulsionGradient-view0.5", "fsm:rule"],
    "disturbances": [
        {"kind": "loss", "level": "all", "mission": {"delivery": {"loss": 1.0}}},
        {"kind": "failing", "level": "1", "mission": {"events": [{"at": 2.0, "do": "fail", "robots": [0]}]}},
    ],
}
"""An experiment that takes seconds."""


BESIDE = ("fixed:Off", "Random")
"""Strategies that come beside those of the document."""


def written(path, **changes):
    path.write_text(yaml.safe_dump(SMALL | changes))
    return path


def test_a_disturbance_changes_the_mission_and_nothing_else(tmp_path):
    families = load_experiment(str(written(tmp_path / "small.yaml"))).variants
    assert list(families) == ["none", "loss all", "failing 1"]
    base, lossy, failing = (family.scenario(3, 1, "test") for family in families.values())
    assert base.seed == lossy.seed == failing.seed
    assert base.start == lossy.start == failing.start
    assert lossy.mission.delivery.loss == 1.0
    assert [event.do for event in failing.mission.events] == ["fail"]
    assert base.mission == lossy.mission.model_copy(update={"delivery": base.mission.delivery})


def test_figures_have_intervals_and_an_evaluation_goes_on_to_the_same_results(tmp_path):
    words = ("evaluate", written(tmp_path / "small.yaml"), "--workers", 1, "--output")
    done(*words, tmp_path / "whole")
    assert len(runs(tmp_path / "whole")) == 2 * 3 * len((*SMALL["strategies"], *BESIDE))
    cut(tmp_path / "whole", tmp_path / "cut", slice(None, None, 3))
    done(*words, tmp_path / "cut", "--resume")
    whole, again = ((tmp_path / name / "summary.json").read_text() for name in ("whole", "cut"))
    assert whole == again
    for by_strategy in json.loads(whole)["disturbances"].values():
        for figures in by_strategy.values():
            assert all(each["ci95"][0] <= each["value"] <= each["ci95"][1] for each in figures.values())
    repeated = task_of(tmp_path / "whole", "test-2", "loss all - fsm:rule")
    assert (repeated.scenarios[0].mission.delivery.loss, repeated.member) == (1.0, "fsm:rule")
    done("explain", tmp_path / "whole", "--condition", "failing 1 - fsm:rule", "--robot", 1, "--time", 3)


def test_the_interval_of_a_share_is_by_the_scenarios_however_many_members_do_them():
    for scenarios, ended in ((20, 18), (25, 25), (7, 0)):
        expected = scipy.stats.binomtest(ended, scenarios).proportion_ci()
        assert share_interval(ended / scenarios, scenarios) == pytest.approx((expected.low, expected.high))
    family = load_experiment("robustness")
    records = [
        record(name, under(disturbance, member), completed=name != "test-1")
        for name in (f"test-{k + 1}" for k in range(10))
        for disturbance in family.variants
        for member in ("a", "b", "c")
    ]
    names = tuple((f"test-{k + 1}",) for k in range(10))
    members = {"one": ("a",), "three": ("a", "b", "c")}
    found = RobustnessReport.of(Runs(family, "", 0, names, members, records))
    assert found.estimates["none"]["three"] == found.estimates["none"]["one"]
    assert found.estimates["none"]["one"]["duration_s"].ci95 == (10.0, 10.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"disturbances": [{"kind": "a", "level": "1", "mission": {"delivery": {"los": 1.0}}}]}, "delivery.los"),
        ({"disturbances": [SMALL["disturbances"][0]] * 2}, "'loss all' twice"),
        ({"disturbances": 3}, "disturbances"),
        ({"disturbances": [{"kind": "a", "level": "1", "mission": 3}]}, r"disturbances\.0\.mission"),
        ({"changes": {"number": [1, 1], "kinds": ["fail"]}}, "none where events are drawn"),
        ({"strategies": 3}, "strategies"),
    ],
)
def test_mistakes_are_one_line_before_anything_runs(tmp_path, changes, message):
    with pytest.raises(DocumentError, match=rf"small\.yaml: .*{message}") as error:
        load_experiment(str(written(tmp_path / "small.yaml", **changes)))
    assert len(str(error.value).splitlines()) == 1


def test_options_that_have_no_meaning_here_are_refused(tmp_path):
    line = refused("evaluate", written(tmp_path / "small.yaml"), "--condition", "fsm:rule")
    assert "--condition: expected with experiments without disturbances only" in line
