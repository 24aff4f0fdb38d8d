"""Whatever happened to a recording, it is read, or refused in one line that names it, by all that read recordings."""

import json
import struct
import zlib

import pytest
from hypothesis import given

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.drawing.pixels import pixels_of
from clean_swarm_env.drawing.recorded_picture import CHANNELS, RecordedCourse
from clean_swarm_env.recording.fields import traces_at
from clean_swarm_env.recording.file import BLOCK, HEAD, MAGIC, PART, blocks_of
from clean_swarm_env.recording.mission_recording import record_mission
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.recording.tables import tables_of
from clean_swarm_env.world.mission import MissionRun
from selector.documents.errors import DocumentError
from tests.attacks import hostile
from tests.attacks.test_saved import damaged, often, read_or_refused
from tests.train.commands import run
from train.replay.page_file import page_of


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded")
    mission = load_mission("table1").model_copy(update={"time_limit": 6.0})
    settings = RecordSettings(folder, minds=True, name="run")
    record_mission(MissionRun(mission, random_start(mission, 1, 0), 2, {}), settings, {})
    return folder / "run.swarm"


def used(path):
    """Read a recording and use it as the page and the export do."""
    recording = RecordedMission(path)
    assert page_of([recording])
    assert tables_of(recording)
    if "deposit" in recording and {"x", "y"} <= set(recording):
        traces_at(recording, recording.frames - 1)
    if CHANNELS.keys() <= set(recording):
        assert pixels_of(RecordedCourse(recording).at(0.0), 200).shape[2] == 3
    return recording


def written(path, blocks):
    """Write blocks as a recording whose checksums are right."""
    data = MAGIC + struct.pack("<I", 1)
    for kind, content in blocks:
        small = zlib.compress(content)
        data += BLOCK.pack(kind, len(small), zlib.crc32(small)) + small
    path.write_bytes(data)
    return path


def test_random_damage_of_the_file(recorded, tmp_path):
    whole = recorded.read_bytes()
    assert used(recorded).frames == 30

    @often
    @given(damaged(whole))
    def attack(content):
        (tmp_path / "damaged.swarm").write_bytes(content)
        read_or_refused(used, tmp_path / "damaged.swarm", str(tmp_path / "damaged.swarm"))

    attack()


@pytest.mark.parametrize("which", [0, 1])
def test_random_damage_inside_blocks_whose_checksums_are_right(recorded, tmp_path, which):
    blocks = list(blocks_of(recorded))
    assert [kind for kind, _ in blocks[:2]] == [HEAD, PART]

    @often
    @given(damaged(blocks[which][1]))
    def attack(content):
        path = written(tmp_path / "odd.swarm", [*blocks[:which], (blocks[which][0], content), *blocks[which + 1 :]])
        read_or_refused(used, path, str(path))

    attack()


def test_hostile_values_in_the_head_and_in_the_directory_of_a_part(recorded, tmp_path):
    (_, head), (_, part), *rest = blocks_of(recorded)
    end = 4 + struct.unpack_from("<I", part)[0]
    small = {name: value for name, value in json.loads(head).items() if name not in ("networks", "mission")}

    @often
    @given(hostile.json_documents(small))
    def attack_the_head(text):
        content = text.encode(errors="surrogatepass").rstrip(b"}") + b', "mission": {}}'
        path = written(tmp_path / "odd.swarm", [(HEAD, content), (PART, part), *rest])
        read_or_refused(used, path, str(path))

    @often
    @given(hostile.json_documents(json.loads(part[4:end])))
    def attack_the_directory(text):
        directory = text.encode(errors="surrogatepass")
        content = struct.pack("<I", len(directory)) + directory + part[end:]
        path = written(tmp_path / "odd.swarm", [(HEAD, head), (PART, content), *rest])
        read_or_refused(used, path, str(path))

    attack_the_head()
    attack_the_directory()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"period": None}, "head: period: expected"),
        ({"about": 1}, "head: about: expected"),
        ({"channels": []}, "head: channels: expected"),
    ],
)
def test_a_foreign_recording_is_one_line_of_each_command(recorded, tmp_path, capsys, change, message):
    (_, head), *rest = blocks_of(recorded)
    path = written(tmp_path / "foreign.swarm", [(HEAD, json.dumps(json.loads(head) | change).encode()), *rest])
    commands = (
        ("replay", path, "--html", tmp_path / "a.html"),
        ("export", path, "--output", tmp_path / "tables"),
        ("picture", path, tmp_path / "a.svg", "--time", 1),
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
