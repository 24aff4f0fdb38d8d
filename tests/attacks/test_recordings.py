"""Whatever happened to a recording, it is read, or refused in one line that names it, by all that read recordings."""

import json
import struct

import pytest

from clean_swarm_env.recording.file import HEAD, PART, blocks_of
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.errors import DocumentError
from tests.attacks import targets
from tests.attacks.targets import put, used, written
from tests.train.commands import run


@pytest.fixture
def recorded(tmp_path_factory):
    return put(tmp_path_factory.mktemp("recorded") / "run.swarm", targets.recorded())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"period": None}, "head: period: expected"),
        ({"about": 1}, "head: about: expected"),
        ({"channels": []}, "head: channels: expected"),
        ({"robots": 2**28}, "head: robots: expected the length of all axes robot, [5], got 268435456"),
        ({"items": 2**28}, "head: items: expected the length of all axes item, [10], got 268435456"),
    ],
)
def test_a_foreign_recording_is_one_line_of_each_command(recorded, tmp_path, capsys, change, message):
    (_, head), *rest = blocks_of(recorded)
    path = written(tmp_path / "foreign.swarm", [(HEAD, json.dumps(json.loads(head) | change).encode()), *rest])
    commands = (
        ("replay", path, "--html", tmp_path / "a.html"),
        ("look", "picture", path, tmp_path / "a.svg", "--time", 1),
        ("video", path, tmp_path / "a.webp"),
    )
    for words in commands:
        assert run(*words) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"error: {path}: {message}")
        assert error.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["foreign.swarm"]


def test_a_part_that_is_missing_or_unpacks_without_end_is_refused(recorded, tmp_path):
    (_, head), (_, part), *_ = blocks_of(recorded)
    path = written(tmp_path / "twice.swarm", [(HEAD, head), (PART, part), (PART, part)])
    with pytest.raises(ValueError, match=r"twice\.swarm: frames from 30 on: damaged: a part of other channels or fram"):
        RecordedMission(path)
    path = written(tmp_path / "cut.swarm", [(HEAD, head), (PART, part[:-1])])
    with pytest.raises(ValueError, match=r"cut\.swarm: frames from 0 on: damaged: the sizes of channels do not fit"):
        RecordedMission(path)


def test_a_deposit_that_is_gone_at_once_is_read(recorded, tmp_path):
    (_, head), (_, part), *_ = blocks_of(recorded)
    end = 4 + struct.unpack_from("<I", part)[0]
    kind = {"diffusion": 1.0, "evaporation_factor": 0.5, "evaporation_period": 0.0, "min_diffusion": 0.1}
    directory = json.dumps(json.loads(part[4:end]) | {"deposits": [kind]}).encode()
    content = struct.pack("<I", len(directory)) + directory + part[end:]
    assert used(written(tmp_path / "static.swarm", [(HEAD, head), (PART, content)])).notes["deposits"] == [kind]


def test_marks_of_other_columns_than_the_directory_says_are_refused(recorded, tmp_path):
    (_, head), (_, part), *_ = blocks_of(recorded)
    end, columns = 4 + struct.unpack_from("<I", part)[0], json.loads(head)["channels"][0]["shape"][0]
    odd = bytearray(part)
    odd[end + 4 * columns] ^= 1  # the marks follow the first frame of the first channel
    path = written(tmp_path / "marks.swarm", [(HEAD, head), (PART, bytes(odd))])
    with pytest.raises(DocumentError, match=r"marks\.swarm: frames from 0 on: damaged: channel .*columns that change"):
        RecordedMission(path)
