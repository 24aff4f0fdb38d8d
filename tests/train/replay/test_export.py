"""Tables of recordings, and what other tools read of them."""

import json
import tracemalloc

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.recording.file import blocks_of
from clean_swarm_env.recording.reader import RecordedMission, RecordedParts, tables_of
from clean_swarm_env.recording.recorder import RecordSettings, record_mission
from clean_swarm_env.world.mission import MissionRun
from tests.train.commands import run


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> RecordedMission:
    folder = tmp_path_factory.mktemp("export")
    mission = load_mission("table1").model_copy(update={"time_limit": 8.0})
    record_mission(
        MissionRun(mission, random_start(mission, 1, 0), 2, {}), RecordSettings(folder, minds=True, name="run"), {}
    )
    return RecordedMission(folder / "run.swarm")


def test_every_channel_is_a_column_with_its_place(recording):
    tables = tables_of(recording)
    assert sum(len(table) - 2 for table in tables.values()) > len(recording)
    robots, behaviours = tables["robot"], tables["robot-behaviour"]
    row = np.flatnonzero((robots["frame"] == 12) & (robots["robot"] == 3))
    assert robots["x"][row] == recording["x"][12, 3]
    assert robots["held_AvoidCollision"][row] == recording["held/AvoidCollision"][12, 3]
    assert robots["time"][row] == pytest.approx(2.4)
    row = np.flatnonzero((behaviours["frame"] == 30) & (behaviours["robot"] == 1) & (behaviours["behaviour"] == 2))
    assert behaviours["reason"][row] == recording["robot/reason"][30, 1, 2]
    for table in tables.values():
        assert len({len(column) for column in table.values()}) == 1


@pytest.mark.extra
def test_parquet_holds_the_tables(recording, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    assert run("look", "export", recording.path, "--output", tmp_path / "tables") == 0
    tables = tables_of(recording)
    assert {path.stem for path in (tmp_path / "tables").iterdir()} == set(tables)
    for title, columns in tables.items():
        table = parquet.read_table(tmp_path / "tables" / f"{title}.parquet")
        assert table.column_names == list(columns)
        for name, values in columns.items():
            np.testing.assert_array_equal(table[name].to_numpy(), values)
    assert json.loads(table.schema.metadata[b"clean_swarm"])["robots"] == 5


@pytest.mark.extra
def test_mcap_holds_the_frames(recording, tmp_path):
    reading = pytest.importorskip("mcap.reader")
    assert run("look", "export", recording.path, "--output", tmp_path / "run.mcap") == 0
    with (tmp_path / "run.mcap").open("rb") as file:
        messages = list(reading.make_reader(file).iter_messages(topics=["/robot"]))
    assert len(messages) == recording.frames
    _, _, message = messages[10]
    assert message.log_time == 2_000_000_000
    assert json.loads(message.data)["x"] == recording["x"][10].tolist()


def test_what_exists_is_not_replaced(recording, tmp_path, capsys):
    assert run("look", "export", recording.path, "--output", tmp_path) == 2
    assert "exists already; expected a new file or directory" in capsys.readouterr().err


@pytest.mark.extra
def test_a_recording_is_written_stretch_by_stretch(tmp_path):
    pytest.importorskip("pyarrow.parquet")
    mission = load_mission("table1").model_copy(update={"time_limit": 160.0})
    settings = RecordSettings(tmp_path, minds=True, name="long")
    record_mission(MissionRun(mission, random_start(mission, 1, 0), 2, {}), settings, {})
    path = tmp_path / "long.swarm"
    parts = list(RecordedParts(blocks_of(path), "long"))
    assert [part.first for part in parts] == list(range(0, parts[-1].first + 1, 250))
    whole = tables_of(RecordedMission(path))
    for title, columns in whole.items():
        for name, values in columns.items():
            np.testing.assert_array_equal(np.concatenate([tables_of(part)[title][name] for part in parts]), values)
    held = sum(values.nbytes for columns in whole.values() for values in columns.values())
    del whole, parts
    tracemalloc.start()
    assert run("look", "export", path, "--output", tmp_path / "long") == 0
    assert tracemalloc.get_traced_memory()[1] < held
    tracemalloc.stop()
