"""Configurations of one's own: found, checked, part of the manifest, and repeated."""

import json

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from train import cli

KNOWLEDGE = """
goals:
  AvoidCollision:
    - {configuration: Swerve, score: 1.0, parameters: {reach: 1.0}}
    - {configuration: RepulsionGradient, score: 0.0}
"""
SWERVE = """
parameters: {reach: 2.0}
mechanisms: {swerve: {type: RepulsionGradient, parameters: {view_distance: $reach}}}
sensors:
  rep_bool: {type: VectorPresent, mechanism: swerve}
  rep_len: {type: VectorLength, mechanism: swerve}
behaviours:
  Swerve:
    action: {type: Move, mechanism: swerve}
    preconditions: [{sensor: rep_bool, activator: {type: Boolean}}]
    effects: [{sensor: rep_bool, change: -1.0}]
"""
EXPERIMENT = """
name: mine
mission: {base: table1, knowledge: mine, task: {garbage: {count: 1}}, time_limit: 60.0}
scenarios: 1
conditions:
  - {name: scores}
  - {name: chance, strategy: {name: Random}}
"""


@pytest.fixture
def directory(tmp_path):
    for kind, name, text in (
        ("knowledge", "mine", KNOWLEDGE),
        ("mechanisms", "Swerve", SWERVE),
        ("experiments", "mine", EXPERIMENT),
    ):
        (tmp_path / "my" / kind).mkdir(parents=True)
        (tmp_path / "my" / kind / f"{name}.yaml").write_text(text)
    return tmp_path / "my"


@pytest.fixture
def told(capsys, monkeypatch):
    def call(*words):
        monkeypatch.setattr("sys.argv", ["clean-swarm", *map(str, words)])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        return code, *capsys.readouterr()

    return call


def test_an_evaluation_with_configurations_of_ones_own_can_be_repeated(directory, tmp_path, told):
    run = tmp_path / "run"
    code, out, err = told("evaluate", "mine", "--configs", directory, "--workers", 1, "--output", run)
    assert code == 0, err
    identity = json.loads((run / "manifest.json").read_text())["identity"]
    assert identity["directories"] == [str(directory)]
    assert f"{directory}/mechanisms/Swerve.yaml" in identity["files"]
    code, out, err = told("explain", run, "--robot", 0, "--time", 0.2, "--json")
    assert (code, json.loads(out)["options"]) == (0, {"AvoidCollision": "Swerve"})
    assert "mine " in told("list", "experiments", "--configs", directory)[1]
    (directory / "mechanisms" / "Swerve.yaml").write_text(SWERVE.replace("2.0", "1.5"))
    code, _, err = told("explain", run, "--robot", 0, "--time", 0.2)
    assert code == 2
    assert "Swerve.yaml has changed since the evaluation" in err


def test_options_drawn_anew_in_every_decision_period_are_recorded(directory, tmp_path, told):
    run, tape = tmp_path / "run", tmp_path / "run.swarm"
    told("evaluate", "mine", "--configs", directory, "--workers", 1, "--output", run)
    assert told("record", run, "--condition", "chance", "--output", tape)[0] == 0
    recording = RecordedMission(tape)
    held = recording["held/AvoidCollision"]
    assert {0, 1} == set(np.unique(held))
    changes = np.flatnonzero((np.diff(held, axis=0) != 0).any(axis=1)) + 1
    assert len(changes) > 3
    assert (changes % 5 == changes[0] % 5).all()  # decision periods of five control periods


@pytest.mark.parametrize(
    ("kind", "name", "old", "new", "expected"),
    [
        ("mechanisms", "Swerve", "RepulsionGradient", "Repulsion", "Swerve.yaml: mechanisms.swerve.type: unknown mech"),
        ("mechanisms", "Swerve", "VectorLength", "VectorLenght", "Swerve.yaml: sensors.rep_len.type: "),
        ("knowledge", "mine", "reach: 1.0", "reach: far", "mechanisms.swerve.parameters: view_distance"),
        ("knowledge", "mine", "Swerve", "Swreve", "unknown configuration 'Swreve'"),
        ("experiments", "mine", "Random", "Radnom", "conditions.1.strategy: unknown strategy 'Radnom'"),
    ],
)
def test_a_mistake_is_one_line_before_anything_is_written(directory, tmp_path, told, kind, name, old, new, expected):
    path = directory / kind / f"{name}.yaml"
    path.write_text(path.read_text().replace(old, new, 1))
    code, _, err = told("evaluate", "mine", "--configs", directory, "--workers", 1, "--output", tmp_path / "run")
    assert code == 2
    assert expected in err
    assert len(err.splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_a_directory_that_does_not_exist_is_named(told, tmp_path):
    code, _, err = told("evaluate", "--configs", tmp_path / "none")
    assert (code, err.splitlines()) == (2, [f"error: {tmp_path / 'none'}: no such directory"])
