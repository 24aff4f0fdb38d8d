"""The examples of docs/recordings.md run one after the other, and its table of channels is that of the code."""

import re

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings, record_mission
from clean_swarm_env.world.mission import MissionRun
from tests.clean_swarm_env.courses import mission
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "recordings.md").read_text(encoding="utf-8")


def test_the_examples_read_what_was_recorded(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    python, moment, stream, alone = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    shared: dict = {}
    exec(python, shared)
    assert "traces of pheromone at 20 s" in capsys.readouterr().out
    exec(moment, shared)
    assert "{'AvoidCollision': " in capsys.readouterr().out
    exec(stream, shared)
    assert {line.split()[0] for line in capsys.readouterr().out.splitlines()} == {f"{k / 5}" for k in range(11)}
    assert not re.search(r"^(from|import) (?!json|struct|zlib|numpy)", alone, flags=re.MULTILINE)
    names: dict = {}
    exec(alone, names)
    recording = RecordedMission(tmp_path / "recordings" / "run.swarm")
    assert set(names["channels"]) == set(recording)
    for name, values in recording.items():
        np.testing.assert_array_equal(names["channels"][name], values, name)


def test_all_channels_are_on_the_page_as_they_are(tmp_path, monkeypatch):
    with_shepherding(monkeypatch)
    cleaning = mission(time_limit=1.0, delivery={"loss": 0.5}, consequences={"stop": 5.0})
    other = MissionConfig.model_validate({"task": "Shepherding", "time_limit": 1.0})
    channels = {}
    for each in (cleaning, other):
        run = MissionRun(each, random_start(each, 1, 0), 2, {})
        policies = {"policy:any": {"observations": ("idle",)}}
        record_mission(run, RecordSettings(tmp_path, minds=True, name=each.name, policies=policies), {})
        channels |= RecordedMission(tmp_path / f"{each.name}.swarm").channels
    rows = PAGE.split("<!-- begin: channels -->\n")[1].split("<!-- end: channels -->")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    told = {name: (unit, about) for names, _, unit, about in cells for name in re.findall(r"`([^`]+)`", names)}
    coded = {
        re.sub(r"^(held|opinion)/.*", r"\1/GOAL", re.sub(r"^(?!held|opinion).*/(\w+)$", r"NETWORK/\1", name)): (
            channel.unit, channel.about
        )
        for name, channel in channels.items()
    }  # fmt: skip
    assert told == coded
