"""Files of recordings: numbers come back, cut files are read as far as they go, others give one clear line."""

import struct
from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording import taking
from clean_swarm_env.recording.channels import LARGEST_WHOLE, Channel, unpacked_frames
from clean_swarm_env.recording.file import MAGIC, RecordingFile, blocks_of
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.taking import Sampled, WaitingFrames

NUMBERS = Channel("numbers", ("robot",), (3,), 1000, 1, "m", "three numbers")
HEAD = {"period": 0.2, "width": 10.0, "height": 10.0, "robots": 3, "items": 0, "minds": False}
HEAD |= {"about": {}, "options": {}, "views": {}, "mission": {}}
NUMBERS_AS_STEPS = replace(NUMBERS, scale=1)
WHOLE = Channel("whole", (), (), 1, 1, "-", "one whole number")


def waiting(whole, channels) -> WaitingFrames:
    """Frames (T, K) of whole numbers that wait in one world; channels of which each second belongs to option 1."""
    numbers, at, sampled = whole[0].astype(np.int64), 0, []
    for k, channel in enumerate(channels):
        sampled.append(Sampled(channel, numbers[at : at + channel.columns], (0, 1) if k % 2 else None))
        at += channel.columns
    frames = WaitingFrames(sampled, 1)
    frames.start(0)
    for frame in whole:
        numbers[:] = frame
        frames.record()
    return frames


def unpacked(channels, packed, rest=b"") -> tuple[np.ndarray, bytes]:
    read, content = [], memoryview(packed.content + rest)
    for channel, size in zip(channels, packed.sizes, strict=True):
        back, used = unpacked_frames(content, (packed.frames, channel.columns, *size), channel.order)
        read.append(back)
        content = content[used:]
    return np.concatenate(read, axis=1), bytes(content)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("size", [0, 1, 100, 30_000, LARGEST_WHOLE])
@pytest.mark.parametrize("count", [1, 2, 50])
@pytest.mark.parametrize("by_address", [True, False])
def test_whole_numbers_come_back(order, size, count, by_address, monkeypatch):
    monkeypatch.setattr(taking, "BY_ADDRESS", by_address and taking.BY_ADDRESS)
    rng = np.random.default_rng(count)
    whole = rng.integers(-size, size + 1, (count, 20)).astype(np.int32)
    whole[:, 3] = 7
    channels = [Channel(str(columns), ("robot",), (columns,), 1, order, "-", "") for columns in (17, 0, 3)]
    frames = waiting(whole, channels)
    assert unpacked(channels, frames.latest(0))[0].tolist() == whole[-1:].tolist()
    back, rest = unpacked(channels, frames.pack(0), b"rest")
    np.testing.assert_array_equal(back, whole)
    assert rest == b"rest"


PAIR = [Channel(name, ("robot",), (2,), 1, 1, "-", "") for name in "ab"]


def test_numbers_of_an_option_that_nobody_holds_stay():
    numbers = np.arange(4)
    sampled = [Sampled(PAIR[0], numbers[:2]), Sampled(PAIR[1], numbers[2:], (0, 1))]
    frames = WaitingFrames(sampled, 1)
    frames.start(0)
    for used in (None, [[0]], [[1]], [[0]]):
        frames.record(used)
        numbers += 10
    assert unpacked(PAIR, frames.pack(0))[0].tolist() == [
        [0, 1, 2, 3],
        [10, 11, 2, 3],
        [20, 21, 22, 23],
        [30, 31, 22, 23],
    ]


def test_worlds_begin_and_end_on_their_own():
    numbers = np.array([1, 1, 2, 2])  # two worlds
    frames = WaitingFrames([Sampled(PAIR[0], numbers)], 2)
    frames.start(0)
    frames.record()
    frames.start(1)
    numbers += 10
    frames.record()
    ended = unpacked(PAIR[:1], frames.pack(0))[0]
    numbers += 10
    frames.record()
    assert ended.tolist() == [[1, 1], [11, 11]]
    assert unpacked(PAIR[:1], frames.pack(1))[0].tolist() == [[12, 12], [22, 22]]
    frames.start(0)
    frames.record()
    assert frames.waiting(0) == 1
    assert unpacked(PAIR[:1], frames.pack(0))[0].tolist() == [[21, 21]], "of what was while it was idle nothing is left"


def test_values_are_rounded_and_held_within_the_range():
    values = np.array([[0.12349, -0.0006, np.nan], [np.inf, -np.inf, 1e12]])
    assert NUMBERS.whole(values).tolist() == [[123, -1, 0], [LARGEST_WHOLE, -LARGEST_WHOLE, LARGEST_WHOLE]]


@pytest.fixture
def path(tmp_path):
    file = RecordingFile(tmp_path / "a.swarm", HEAD, (NUMBERS, WHOLE))
    for part in range(3):
        whole = np.column_stack([np.arange(30).reshape(10, 3) + 30 * part, np.full(10, part)])
        file.add(waiting(whole, (NUMBERS_AS_STEPS, WHOLE)).pack(0), {"deposits": []})
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
