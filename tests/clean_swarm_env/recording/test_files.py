"""Files of recordings: numbers come back, cut files are read as far as they go, others give one clear line."""

import struct

import numpy as np
import pytest

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.channels import LARGEST_WHOLE, Channel, packed_frames, unpacked_frames
from clean_swarm_env.recording.file import MAGIC, RecordingFile, blocks_of
from clean_swarm_env.recording.reader import RecordedMission

NUMBERS = Channel("numbers", ("robot",), (3,), 1000, 1, "m", "three numbers")
HEAD = {"period": 0.2, "width": 10.0, "height": 10.0, "robots": 3, "items": 0, "minds": False}
HEAD |= {"about": {}, "options": {}, "views": {}, "mission": {}}
WHOLE = Channel("whole", (), (), 1, 1, "-", "one whole number")


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("size", [0, 1, 100, 30_000, LARGEST_WHOLE])
@pytest.mark.parametrize("frames", [1, 2, 50])
def test_whole_numbers_come_back(order, size, frames):
    rng = np.random.default_rng(frames)
    whole = rng.integers(-size, size + 1, (frames, 20)).astype(np.int32)
    whole[:, 3] = 7
    channels = [Channel(str(count), ("robot",), (count,), 1, order, "-", "") for count in (17, 0, 3)]
    sizes, content = packed_frames(channels, whole)
    read, rest = [], memoryview(content + b"rest")
    for channel, size in zip(channels, sizes, strict=True):
        back, used = unpacked_frames(rest, (frames, channel.columns, *size), order)
        read.append(back)
        rest = rest[used:]
    np.testing.assert_array_equal(np.concatenate(read, axis=1), whole)
    assert bytes(rest) == b"rest"


def test_of_a_channel_that_stays_the_first_frame_is_kept():
    whole = np.arange(12, dtype=np.int32).reshape(3, 4)
    pair = [Channel(name, ("robot",), (2,), 1, 1, "-", "") for name in "ab"]
    sizes, content = packed_frames(pair, whole, [False, True])
    assert [changing for changing, _ in sizes] == [2, 0]
    _, used = unpacked_frames(memoryview(content), (3, 2, *sizes[0]), 1)
    kept, _ = unpacked_frames(memoryview(content)[used:], (3, 2, *sizes[1]), 1)
    assert kept.tolist() == [[2, 3]] * 3


def test_values_are_rounded_and_held_within_the_range():
    values = np.array([[0.12349, -0.0006, np.nan], [np.inf, -np.inf, 1e12]])
    assert NUMBERS.whole(values).tolist() == [[123, -1, 0], [LARGEST_WHOLE, -LARGEST_WHOLE, LARGEST_WHOLE]]


@pytest.fixture
def path(tmp_path):
    file = RecordingFile(tmp_path / "a.swarm", HEAD, (NUMBERS, WHOLE))
    for part in range(3):
        file.add(
            10 * part,
            np.column_stack([np.arange(30).reshape(10, 3) + 30 * part, np.full(10, part)]).astype(np.int32),
            {"deposits": []},
        )
    file.close({"ticks": 30})
    return tmp_path / "a.swarm"


def test_parts_are_joined(path):
    recording = RecordedMission(path)
    assert recording["numbers"].ravel() == pytest.approx(np.arange(90) / 1000)
    assert recording["whole"].tolist() == [0] * 10 + [1] * 10 + [2] * 10
    assert recording.times[-1] == pytest.approx(29 * 0.2)
    assert recording.result == {"ticks": 30}
    with pytest.raises(KeyError, match="unknown channel 'number' \\(known: numbers, whole"):
        recording["number"]


def test_a_file_cut_anywhere_is_read_as_far_as_it_goes(path):
    data, lengths = path.read_bytes(), set()
    for end in range(len(data)):
        path.write_bytes(data[:end])
        recording, error = opened(path)
        if recording is None:
            assert len(error.splitlines()) == 1
            lengths.add(0)
        else:
            assert recording["numbers"].ravel() == pytest.approx(np.arange(3 * recording.frames) / 1000)
            lengths.add(recording.frames)
    assert lengths == {0, 10, 20, 30}


def opened(path) -> tuple[RecordedMission | None, str]:
    try:
        return RecordedMission(path), ""
    except ConfigurationError as error:
        return None, str(error)


def test_a_byte_that_changed_is_found(path):
    data = path.read_bytes()
    for at in range(len(data)):
        path.write_bytes(data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :])
        recording, error = opened(path)
        if recording is None:
            assert error.startswith(f"{path}: ")
        else:  # a length that points behind the end cuts the file there
            assert recording.result is None


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "expected a recording of a mission (.swarm), got another kind of file"),
        (b"PK\x03\x04 and more of an archive", "got another kind of file"),
        (MAGIC + struct.pack("<I", 2), "expected a recording of version 1, got version 2; record the mission again"),
        (MAGIC + struct.pack("<I", 1), "expected a recording that begins with its head"),
    ],
)
def test_other_files_give_one_line(tmp_path, content, expected):
    path = tmp_path / "other.swarm"
    path.write_bytes(content)
    with pytest.raises(ConfigurationError) as error:
        RecordedMission(path)
    assert str(error.value).startswith(f"{path}: ")
    assert expected in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_and_a_directory_give_one_line(tmp_path):
    for path in (tmp_path / "none.swarm", tmp_path):
        with pytest.raises(ConfigurationError, match="cannot be read"):
            list(blocks_of(path))
