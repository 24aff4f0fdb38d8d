"""A training records the missions of its validations, and learns the same with and without."""

import json

from clean_swarm_env.recording.reader import RecordedMission
from tests.train.commands import done
from tests.train.learning.trainings import written


def test_missions_of_validations_are_recorded(tmp_path, monkeypatch):
    monkeypatch.setattr("train.learning.training.best_fixed", lambda *_: ("none", {"random": [1.0]}))
    config = written(tmp_path, "bandit", checkpoints=1, decisions=60, validation={"scenarios": 1})
    for name, more in (("plain", ()), ("recorded", ("--record",))):
        done("train", "bandit", "--config", config, "--seed", 1, "--output", tmp_path / name, *more)
    histories = [(tmp_path / name / "history.jsonl").read_text() for name in ("plain", "recorded")]
    assert histories[0] == histories[1]
    figures = json.loads(histories[0])
    folders = list((tmp_path / "recorded" / "recordings" / "checkpoint-1").iterdir())
    assert {folder.name for folder in folders} == {name.partition("/")[0] for name in figures if "/cost_s" in name}
    for folder in folders:
        (path,) = folder.iterdir()
        recording = RecordedMission(path)
        assert recording.head["about"]["condition"] == "checkpoint-1"
        assert recording.result["cost_s"] == figures[f"{folder.name}/cost_s"]
