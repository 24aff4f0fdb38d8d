"""Recordings of strategies on a family: those of an evaluation, and the same ones from its manifest, run again."""

import json

import numpy as np
import pytest
import yaml

from clean_swarm_env.recording.reader import RecordedMission
from tests.paths import TRAINED
from tests.train.commands import changed, done, refused
from tests.train.records import checksums

FAMILY = {
    "name": "small",
    "description": "Four robots and three items.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 30.0},
    "robots": [3, 4],
    "items": [3, 3],
}
STRATEGIES = ("fsm:rule", "policy:general", "Random", "fixed:RepulsionGradient-view0.5")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    directory = tmp_path_factory.mktemp("family")
    (directory / "small.yaml").write_text(yaml.safe_dump(FAMILY))
    words = [word for name in STRATEGIES for word in ("--strategy", name)]
    words += ["--scenarios", 2, "--workers", 1, "--minds", "--configs", TRAINED, "--output", directory / "run"]
    done("evaluate", directory / "small.yaml", *words)
    return directory / "run"


def test_every_run_has_a_recording_with_its_result(results):
    held = [json.loads(line) for line in (results / "runs.jsonl").open()]
    recordings = [RecordedMission(path) for path in (results / "recordings").iterdir()]
    assert len(recordings) == len(held) == 2 * (len(STRATEGIES) + 1)  # never to avoid comes beside
    by_run = {(r.head["about"]["scenario"], r.head["about"]["condition"]): r for r in recordings}
    for record in held:
        recording = by_run[record["scenario"], record["condition"]]
        assert recording.result == {name: record[name] for name in recording.result}
        assert recording.frames == record["ticks"]


@pytest.mark.parametrize("condition", STRATEGIES)
def test_a_run_that_is_repeated_has_the_same_recording(results, tmp_path, condition):
    first = RecordedMission(results / "recordings" / f"test-2-{condition.replace(':', '_')}.swarm")
    words = ("--scenario", "test-2", "--condition", condition, "--output", tmp_path / "again.swarm")
    done("record", results, *words)
    again = RecordedMission(tmp_path / "again.swarm")
    assert checksums(again) == checksums(first)
    assert again.head["about"] == first.head["about"]
    frame, robot = first.frames // 2, 1
    words = ("--scenario", "test-2", "--condition", condition, "--robot", robot, "--time", frame * first.period)
    step = json.loads(done("explain", results, *words, "--json"))
    options = first.head["options"]["AvoidCollision"]
    assert step["options"]["AvoidCollision"] == options[first["held/AvoidCollision"][frame, robot]]
    readings = dict(zip(first.head["networks"]["robot"]["sensors"], first["robot/readings"][frame, robot], strict=True))
    assert readings == pytest.approx(step["readings"], abs=0.00051)


def test_what_each_strategy_thinks_of_the_options_is_recorded(results):
    opinions = {
        name: RecordedMission(results / "recordings" / f"test-1-{name.replace(':', '_')}.swarm")[
            "opinion/AvoidCollision"
        ]
        for name in STRATEGIES
    }
    held = RecordedMission(results / "recordings" / "test-1-policy_general.swarm")["held/AvoidCollision"]
    assert (opinions["policy:general"].argmax(axis=2) == held).mean() > 0.99
    assert np.ptp(opinions["policy:general"]) > 0.1
    for name in ("policy:general", "Random"):
        assert opinions[name].sum(axis=2) == pytest.approx(1.0, abs=0.01)
    for name in ("fsm:rule", "fixed:RepulsionGradient-view0.5"):
        assert set(np.unique(opinions[name])) == {0.0, 1.0}


def test_runs_that_do_not_exist_or_have_changed_give_one_line(results, tmp_path):
    words = ("--robot", 0, "--time", 1)
    line = refused("explain", results, *words, "--scenario", "test-3")
    assert "unknown scenario 'test-3' (known: test-1, test-2; 2 in all)" in line
    trained_again = {"policy:general": {"members": ["policy:general sha256:0"]}}
    changed(results, tmp_path / "run", lambda manifest: manifest["identity"]["conditions"].update(trained_again))
    line = refused("explain", tmp_path / "run", *words, "--condition", "policy:general")
    assert "condition 'policy:general' has changed since the evaluation; its runs cannot be repeated" in line
