"""Damaged models, and full disks: what is wrong is said in one line, and nothing is half done."""

import os
import resource
import shutil
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st

from clean_swarm_env.config.load import load_experiment
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.deciders.models import ModelDecider
from clean_swarm_env.drawing.canvases import RecordedCourse
from clean_swarm_env.drawing.picture import FORMATS, write_picture
from clean_swarm_env.drawing.video import WRITERS, write_video
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.errors import DocumentError
from selector.strategies.problem import Problem
from tests.attacks.targets import Target, attack, damaged, put, read_or_refused, recorded
from tests.train.live.sessions import SMALL, play_of
from train.evaluation.comparing import Comparing
from train.evaluation.repeat import record_run
from train.live.session import Session
from train.request import Request


def field(number: int, *values: int | str | bytes) -> bytes:
    """Return a field of a message of Protocol Buffers: a small number, a text, or messages."""
    if isinstance(values[0], int):
        return bytes([number << 3, values[0]])
    data = b"".join(value.encode() if isinstance(value, str) else value for value in values)
    return bytes([number << 3 | 2, len(data) & 127 | 128, len(data) >> 7]) + data


def onnx_model() -> bytes:
    """Return a model that gives its two numbers, as the fields of `onnx.proto`."""
    shape = field(2, field(1, field(2, "R")), field(1, field(1, 2)))
    seen, given = (field(1, name) + field(2, field(1, field(1, 1), shape)) for name in ("x", "y"))
    tensor = [field(1, 2), field(1, 2), field(2, 1), field(8, "w"), field(9, np.eye(2, dtype=np.float32).tobytes())]
    node = field(1, field(1, "x"), field(1, "w"), field(2, "y"), field(4, "MatMul"))
    graph = field(7, node, field(2, "g"), field(5, *tensor), field(11, seen), field(12, given))
    return field(1, 10) + graph + field(8, field(1, ""), field(2, 17))


def write_torch(path: Path) -> None:
    torch = pytest.importorskip("torch")
    torch.jit.script(torch.nn.Linear(2, 2)).save(path)


def write_onnx(path: Path) -> None:
    pytest.importorskip("onnxruntime")
    path.write_bytes(onnx_model())


def write_stable_baselines(path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    from gymnasium import spaces
    from stable_baselines3.common.policies import ActorCriticPolicy
    from stable_baselines3.common.save_util import save_to_zip_file

    seen, actions = spaces.Box(-1.0, 1.0, (2,)), spaces.Discrete(2)
    policy = ActorCriticPolicy(seen, actions, lambda _: 0.0, net_arch=[2])
    data = {"observation_space": seen, "action_space": actions, "policy_kwargs": {"net_arch": [2]}}
    save_to_zip_file(path, data | {"policy_class": ActorCriticPolicy}, {"policy": policy.state_dict()}, {})


@pytest.mark.extra
@pytest.mark.parametrize(
    ("ending", "write"), [(".pt", write_torch), (".onnx", write_onnx), (".zip", write_stable_baselines)]
)
def test_a_damaged_model_decides_or_is_refused_in_one_line(ending, write, tmp_path):
    path, problem = tmp_path / f"m{ending}", Problem("G", ("a", "b"), np.ones(2), ("near", "far"))
    write(path)
    content = path.read_bytes()

    def decide(path):
        return ModelDecider(path, "option", problem, np.zeros(3)).decide(np.zeros((3, 2), dtype=np.float32))

    assert decide(path)
    target = Target(damaged(content) | st.binary(max_size=200), lambda odd: read_or_refused(decide, put(path, odd)))
    attack(target, int(os.environ.get("DAMAGES", "30")))


@pytest.mark.extra
def test_a_model_whose_numbers_are_not_finite_is_one_line(tmp_path):
    path = tmp_path / "m.onnx"
    write_onnx(path)
    decider = ModelDecider(path, "option", Problem("G", ("a", "b"), np.ones(2), ("near", "far")), np.zeros(3))
    seen = np.zeros((3, 2), dtype=np.float32)
    seen[1] = np.nan
    with pytest.raises(
        DocumentError, match=r"m\.onnx: expected a model that gives 2 options, got: 2 numbers, of which 0 "
    ):
        decider.decide(seen)


@contextmanager
def full_disk(most: int):
    """Limit files to `most` bytes, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_disk_names_the_file_and_leaves_nothing_that_the_next_try_refuses(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("run.swarm").write_bytes(recorded())
    experiment = load_experiment("table1")
    mission = experiment.mission.model_copy(update={"time_limit": 6.0})
    small = experiment.model_copy(update={"mission": mission, "starts": (random_start(mission, 1, 0),)})
    task = Comparing(Request("table1"), small).tasks({})[0]
    writers = [(Path("new.swarm"), partial(record_run, task))]
    noise = np.random.default_rng(0).integers(256, size=(20, 64, 64, 3), dtype=np.uint8)
    writers += [(Path(f"new{end}"), lambda path: write_video(path, iter(noise))) for end in WRITERS]
    course = RecordedCourse(RecordedMission(Path("run.swarm")))
    writers += [(Path(f"moment{end}"), lambda path: write_picture(course.at(1.0), path, 700)) for end in FORMATS]
    for path, write in writers:
        write(path)  # what it compiles and imports is kept on a disk that has room
        path.unlink() if path.is_file() else shutil.rmtree(path)
        with full_disk(3000), pytest.raises((OSError, DocumentError)) as told_of:
            write(path)
        assert str(path) in str(told_of.value)
        assert not path.exists()
        write(path)
        assert path.exists()


def test_a_recording_of_a_play_is_whole_after_a_full_disk_and_goes_on_when_there_is_room(tmp_path):
    """Nothing stays of a block that could not be written, and no file whose head could not be."""
    path = tmp_path / "run.swarm"
    with full_disk(100), pytest.raises(OSError, match=r"run\.swarm"):
        Session(play_of(SMALL), path)
    assert not path.exists()
    session = Session(play_of(SMALL), path)
    for _ in range(3):
        session.tick()
    with full_disk(path.stat().st_size + 100), pytest.raises(OSError, match=r"run\.swarm"):
        session.close()
    assert path.read_bytes() == session.beginning
    session.close()
    assert RecordedMission(path).frames == 3
