"""Configurations of one's own: found, checked, part of the manifest, and repeated."""

import json

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from tests.train.commands import done, refused

pytestmark = pytest.mark.usefixtures("undrawn")
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
  - {name: chance, strategy: Random}
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
def words(directory):
    """The beginning of an evaluation."""
    return "evaluate", "mine", "--configs", directory, "--workers", 1, "--output"


def test_an_evaluation_with_configurations_of_ones_own_can_be_repeated(directory, words, tmp_path):
    run = tmp_path / "run"
    done(*words, run)
    manifest = json.loads((run / "manifest.json").read_text())
    assert manifest["directories"] == [str(directory)]
    assert "mechanisms/Swerve.yaml" in manifest["identity"]["files"]
    (directory / "mechanisms" / "Unused.yaml").write_text("a: {b: [\n")  # half written, and nobody needs it
    done(*words, run, "--resume")
    explain = ("explain", run, "--robot", 0, "--time", 0.2)
    assert json.loads(done(*explain, "--json"))["options"] == {"AvoidCollision": "Swerve"}
    assert "mine " in done("list", "experiments", "--configs", directory)
    done("record", run, "--condition", "chance", "--output", tmp_path / "run.swarm")
    held = RecordedMission(tmp_path / "run.swarm")["held/AvoidCollision"]
    assert {0, 1} == set(np.unique(held))  # options are drawn anew in every decision period
    changes = np.flatnonzero((np.diff(held, axis=0) != 0).any(axis=1)) + 1
    assert len(changes) > 3
    assert (changes % 5 == changes[0] % 5).all()  # decision periods of five control periods
    (directory / "mechanisms" / "Swerve.yaml").write_text(SWERVE.replace("2.0", "1.5"))
    assert "Swerve.yaml has changed since the evaluation" in refused(*explain)


@pytest.mark.parametrize(
    ("kind", "name", "old", "new", "expected"),
    [
        ("mechanisms", "Swerve", "RepulsionGradient", "Repulsion", "Swerve.yaml: mechanisms.swerve.type: unknown mech"),
        ("mechanisms", "Swerve", "VectorLength", "VectorLenght", "Swerve.yaml: sensors.rep_len.type: "),
        ("knowledge", "mine", "reach: 1.0", "reach: far", "mechanisms.swerve.parameters: view_distance"),
        ("knowledge", "mine", "Swerve", "Swreve", "unknown configuration 'Swreve'"),
        ("experiments", "mine", "Random", "Radnom", "conditions.1.strategy: strategy 'Radnom': unknown strategy"),
    ],
)
def test_a_mistake_is_one_line_before_anything_is_written(directory, words, tmp_path, kind, name, old, new, expected):
    path = directory / kind / f"{name}.yaml"
    path.write_text(path.read_text().replace(old, new, 1))
    assert expected in refused(*words, tmp_path / "run")
    assert not (tmp_path / "run").exists()
