"""Tables of recordings, whole and stretch by stretch."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.recording.file import blocks_of
from clean_swarm_env.recording.reader import RecordedMission, RecordedParts, tables_of
from tests.clean_swarm_env.courses import run_recorded


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> RecordedMission:
    mission = load_mission("table1").model_copy(update={"time_limit": 8.0})
    return run_recorded(mission, 1, 2, tmp_path_factory.mktemp("tables"), minds=True)


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


def test_stretches_have_the_rows_of_the_whole(tmp_path):
    mission = load_mission("table1").model_copy(update={"time_limit": 160.0})
    path = run_recorded(mission, 1, 2, tmp_path, "long", minds=True).path
    parts = list(RecordedParts(blocks_of(path), "long"))
    assert [part.first for part in parts] == list(range(0, parts[-1].first + 1, 250))
    whole = tables_of(RecordedMission(path))
    for title, columns in whole.items():
        for name, values in columns.items():
            np.testing.assert_array_equal(np.concatenate([tables_of(part)[title][name] for part in parts]), values)
