"""The manifest of a comparison holds all that its runs depend on: they are made from it as they were made first."""

import json

import pytest

from train.evaluation.comparing import Comparing
from train.evaluation.comparison import Comparison
from train.request import Request

REQUESTS = {
    "conditions": Request("table1", scenarios=2),
    "policy of three goals": Request("exploring", ("policy:one", "fixed:Off"), scenarios=2),
    "one of these goals": Request("exploring", ("policy:one",), scenarios=1, goal="AvoidCollision"),
    "disturbances": Request("disturbed-crowd", scenarios=1),
    "task": Request("ReachGoal", ("fixed",), scenarios=1, worlds=2),
}
ONE = "AvoidCollision"
DECIDED = {"policy of three goals": ["", ONE, ONE], "one of these goals": [ONE, ONE, ONE]}


@pytest.mark.parametrize("name", REQUESTS)
def test_runs_are_made_again_from_the_manifest_alone(name, tmp_path):
    evaluation = Comparing(REQUESTS[name])
    manifest = json.loads(json.dumps(evaluation.manifest))
    first = evaluation.tasks({})
    assert Comparison.read(manifest, tmp_path).tasks(evaluation.scenarios) == first
    assert sum(len(task.keys) for task in first) == len(evaluation.scenarios) * len(evaluation.comparison.bases)
    assert [task.goal for task in first][: len(DECIDED.get(name, ()))] == DECIDED.get(name, [])


def test_scores_that_change_nothing_and_files_that_hide_ours_are_said(tmp_path):
    weak = {"AvoidCollision": {"RepulsionGradient-view1.5": 0.1}}
    conditions = [{"name": "none"}, {"name": "weak", "scores": weak}]
    (tmp_path / "experiments").mkdir()
    file = tmp_path / "experiments" / "table1.yaml"
    file.write_text(json.dumps({"name": "table1", "mission": "table1", "conditions": conditions}), encoding="utf-8")
    evaluation = Comparing(Request("table1", scenarios=1, directories=(tmp_path,)))
    assert evaluation.led_by == "duration"
    assert evaluation.remarks() == [
        "table1: condition 'weak': RepulsionGradient-view1.5 has 0.1 for AvoidCollision, and robots hold "
        "RepulsionFernandez-view2.0, which has more",
        f"table1: {file}, which hides ours of the same name",
    ]
    strong = Comparing(Request("table1", scenarios=1))
    assert strong.remarks() == []
