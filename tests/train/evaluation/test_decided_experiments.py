"""An experiment's condition takes any decider: an option, a machine, a policy, as the command line names them."""

import json
from pathlib import Path

import pytest
import yaml

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import DocumentError
from tests.train.commands import changed, command, done, refused, run
from train.evaluation.comparing import Comparing
from train.request import Request

pytestmark = pytest.mark.usefixtures("undrawn")
ONE = "goal: AvoidCollision\nstart: only\nstates:\n  only: {option: RepulsionGradient-view0.5}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.yaml").write_text(ONE)
    return tmp_path


def written(folder, *conditions):
    content = {
        "name": "deciders",
        "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 60.0},
        "scenarios": 2,
        "conditions": list(conditions),
    }
    path = folder / "deciders.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


FORCED = {"name": "forced", "scores": {"AvoidCollision": {"RepulsionGradient-view0.5": 1e6}}}
MACHINE = {"name": "machine", "strategy": "fsm:one.yaml"}


def test_an_option_and_a_machine_of_one_state_have_the_bits_of_the_highest_score(folder):
    path = written(folder, FORCED, {"name": "option", "strategy": "fixed:RepulsionGradient-view0.5"}, MACHINE)
    done("evaluate", path, "--workers", 1, "--output", "done")
    rows = [json.loads(line) for line in (folder / "done" / "runs.jsonl").read_text().splitlines()]
    figures = {}
    for row in rows:
        key = row["scenario"], row["condition"]
        figures[key] = {name: row[name] for name in row if name not in ("condition", "wall_s")}
    assert len(figures) == 6
    for (scenario, _), own in figures.items():
        assert own == figures[scenario, "forced"]
    done("explain", "done", "--condition", "machine", "--robot", 1, "--time", 20)
    done("record", "done", "--condition", "machine", "--output", "run.swarm")


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ({"strategy": "fsm:two.yaml"}, "two.yaml: no such file"),
        ({"strategy": "fixed:Nothing"}, "unknown option 'Nothing'"),
        ({"strategy": "policy:exploring-ppo"}, "unknown goal 'ExplorationPatrol'"),
        ({"strategy": "MaxScor"}, "did you mean 'MaxScore'"),
        ({"strategy": "policy:theirs.zip"}, "only a file asks to load theirs.zip"),
        ({"strategy": "velocity:theirs.pt"}, "only a file asks to load theirs.pt"),
    ],
)
def test_what_does_not_fit_is_one_line(folder, condition, message):
    path = written(folder, {"name": "x", **condition})
    with pytest.raises((ConfigurationError, DocumentError)) as told:
        Comparing(Request(str(path)))
    assert message in str(told.value)
    assert "\n" not in str(told.value)


@pytest.fixture
def machine(folder):
    """Results `done` of a machine; returns the file of its experiment."""
    path = written(folder, MACHINE)
    done("evaluate", path, "--workers", 1, "--output", "done")
    return path


EXPLAIN = ("--robot", 1, "--time", 2)


def test_a_machine_that_has_changed_is_no_longer_the_same_evaluation(folder, machine):
    (folder / "one.yaml").write_text(ONE.replace("RepulsionGradient-view0.5", "Off"))
    line = refused("explain", "done", *EXPLAIN)
    assert "condition 'machine' has changed since the evaluation" in line
    assert run("evaluate", machine, "--workers", 1, "--output", "done", "--resume") == 2


def test_a_manifest_whose_deciders_are_not_those_of_its_conditions_is_refused(machine):
    for number, held in enumerate((None, [1], {}, {"machine": {"members": ["fsm:one.yaml"]}, "more": None})):
        results = Path(f"changed-{number}")
        changed(Path("done"), results, lambda manifest, held=held: manifest["identity"].update(conditions=held))
        line = refused("explain", results, *EXPLAIN)
        assert "identity: conditions" in line or "identity.conditions: expected the run 'machine'" in line, held


def test_a_condition_is_explained_though_another_one_names_code(machine):
    stranger, results = {"stranger": {"members": ["canary:Own"]}}, Path("changed")
    changed(Path("done"), results, lambda manifest: manifest["identity"]["conditions"].update(stranger))
    Path("canary.py").write_text("raise AssertionError")
    with (results / "runs.jsonl").open("r+") as file:
        file.write(file.read().replace('"machine"', '"stranger"'))
    done("explain", results, *EXPLAIN)
    line = refused("explain", results, *EXPLAIN, "--condition", "stranger")
    assert "only a file asks to import canary:Own" in line


def test_a_bandit_that_does_not_learn_is_named(folder):
    path = written(folder, {"name": "bandit", "strategy": "UCB1"}, FORCED)
    code, _, err = command("evaluate", path, "--workers", 1, "--scenarios", 1, "--output", "done")
    assert code == 0
    assert "bandit: has learned nothing and learns nothing; --learn" in err
