"""Fuzz targets: for each kind of document and each saved file, contents drawn at random, and how they are read.

Whatever the content is, it is read, or refused in one line that names the file. `python -m tests.attacks.soak` draws
many more contents than the tests.
"""

import json
import shutil
import struct
import tempfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.drawing.canvases import CHANNELS, RecordedCourse
from clean_swarm_env.drawing.picture import pixels_of
from clean_swarm_env.learning.batch import mission_begun, run_out
from clean_swarm_env.recording.fields import traces_at
from clean_swarm_env.recording.file import BLOCK, MAGIC, blocks_of
from clean_swarm_env.recording.reader import RecordedMission, tables_of
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.arrays import load_arrays, save_arrays
from selector.documents.errors import DocumentError, shown
from selector.documents.reading import read_value
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.policy_file import load_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import spec_from_text
from selector.strategies.streams import row_keys
from tests.attacks import hostile
from tests.attacks.readers import KINDS, READERS, refused_in_one_line
from tests.paths import TRAINED
from tests.train.records import record
from train.evaluation.repeat import changed_versions, task_of
from train.replay.page_file import page_of
from train.running.finished_runs import JOURNAL, Results
from train.running.run_folder import MANIFEST, RunFolder, read_manifest

FINDINGS = Path(__file__).parent / "findings"
"""Folders by target with contents that once failed; the tests read them again."""
RULES = TRAINED / "strategies" / "rules.safetensors"
POLICY = TRAINED / "policies" / "general"
STARTS = {
    "torus_m": [11, 11],
    "recycling": [2, 1],
    "dump": [1, 1],
    "cases": [{"id": "1", "robots": [[1, 1, 0], [3, 3, 0]], "items": [[2, 2]], "measured": {"a": {"duration_s": 1.5}}}],
}
STORE = {
    "format": "clean-swarm knowledge store",
    "version": 1,
    "expert": {
        "G": [
            {"configuration": "C", "score": 1.0, "name": "a", "parameters": {"view": 2.0}, "position": 0}
            | {"source": "expert", "updated": "2026-11-21T00:00:00.000000+00:00"}
        ]
    },
    "learned": [
        {"goal": "G", "option": "a", "context": "", "source": "run", "updated": "2026-11-21T00:00:00.000000+00:00"}
        | {"count": 1, "total": "5", "squares": "25"}
    ],
}
LINES = "".join(json.dumps(record(name, "a").as_mapping()) + "\n" for name in ("1", "2", "3")).encode()
MANIFEST_CONTENT = {
    "identity": {"experiment": "x", "seed": 1, "configuration": {"name": "x"}, "files": {}, "directories": []},
    "versions": {"numba": "1"},
    "learned": {"G": {"a": {"count": 3, "mean": 0.5, "variance": 0.0}}},
}


class Target(NamedTuple):
    """Contents of one kind."""

    drawn: st.SearchStrategy[bytes]
    read: Callable[[bytes], object]
    """Reads a content, or refuses it in one line; any error is a fault."""


def attack(target: Target, examples: int, number: int | None = None) -> None:
    """Read random contents, those of a `number` if it is given; the smallest one that fails raises its error."""
    checks = [HealthCheck.too_slow, HealthCheck.function_scoped_fixture, HealthCheck.data_too_large]
    limits = settings(max_examples=examples, deadline=None, database=None, suppress_health_check=checks)

    @limits
    @given(target.drawn)
    def read(content):
        target.read(content)

    (read if number is None else seed(number)(read))()


def encoded(text: str) -> bytes:
    return text.encode("utf-8", errors="surrogatepass")


def damaged(content: bytes):
    """Bytes of a file of which a part was changed, lost or doubled."""
    places = st.integers(0, len(content) - 1)
    return (
        st.builds(lambda k, byte: content[:k] + bytes([byte]) + content[k + 1 :], places, st.integers(0, 255))
        | places.map(lambda k: content[:k])
        | st.builds(lambda a, b: content[: min(a, b)] + content[max(a, b) :], places, places)
        | st.builds(lambda k, more: content[:k] + more + content[k:], places, st.binary(min_size=1, max_size=20))
    )


def read_or_refused(read, path, named=None):
    """Return what `read` returns; None if it refuses a path in one line with its name, or with `named`."""
    message = ""
    try:
        return read(path)
    except DocumentError as error:
        message = str(error)
    assert (named or shown(path)) in message
    assert len(message.splitlines()) == 1
    return None


def put(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


# Documents


def document(kind: str, name: str, drawn, folder: Path) -> Target:
    return Target(drawn.map(encoded), lambda content: refused_in_one_line(READERS[kind], put(folder / name, content)))


def command_line(folder: Path) -> Target:
    def read(content: bytes) -> None:
        text = content.decode("utf-8", errors="surrogatepass")
        for one in (read_value, lambda value: spec_from_text(f"UCB1:prior={value}"), spec_from_text):
            with suppress(DocumentError):
                one(text)

    return Target((st.text() | hostile.texts | hostile.plain_values.map(str)).map(encoded), read)


# What trainings and evaluations save


def read_strategy(path):
    described = description_of(path)
    try:
        problem = Problem(described.goal, described.options, np.zeros(len(described.options)), described.features)
        strategy = described.spec.build(problem, row_keys(np.random.SeedSequence(0), 1), np.zeros(1, dtype=np.int64))
    except ValueError as error:  # as a comparison says it, which has a problem of its own
        raise DocumentError(f"{shown(path)}: {error}") from error
    load_strategy(path, strategy)
    assert all(np.isfinite(array).all() for array in strategy.learned().values())
    return strategy


def strategy_file(folder: Path) -> Target:
    path = folder / "damaged.safetensors"
    return Target(damaged(RULES.read_bytes()), lambda content: read_or_refused(read_strategy, put(path, content)))


def strategy_description(folder: Path) -> Target:
    arrays, description = load_arrays(RULES)

    def read(content: bytes) -> None:
        try:
            odd = json.loads(content.decode("utf-8", errors="surrogatepass"))
        except (ValueError, RecursionError):
            return
        save_arrays(folder / "odd.safetensors", arrays, odd)
        read_or_refused(read_strategy, folder / "odd.safetensors")

    return Target(hostile.json_documents(description).map(encoded), read)


def policy(name: str, drawn, folder: Path) -> Target:
    own = folder / "policy"
    shutil.copytree(POLICY, own)
    return Target(
        drawn,
        lambda content: read_or_refused(lambda path: load_policy(path.parent), put(own / name, content), own.name),
    )


def asked(kept):
    return kept.mistake("x", 3, MissionConfig())


def journal(drawn, folder: Path) -> Target:
    """Journals as `--resume` of the evaluation "x" of seed 3 reads them."""

    def read(content: bytes) -> None:
        shutil.rmtree(folder / "r", ignore_errors=True)
        run_folder = RunFolder(folder / "r", {"identity": {"experiment": "x"}}, resume=True)
        path = put(folder / "r" / JOURNAL, content)
        for kept in read_or_refused(lambda _: Results(run_folder, asked).records, path) or ():
            assert (kept.experiment, kept.seed) == ("x", 3)
            assert 0.0 <= kept.result.duration_s <= 3000.0
            assert np.isfinite(kept.result.cost_s)

    return Target(drawn, read)


def manifest(folder: Path) -> Target:
    def read(content: bytes) -> None:
        path = put(folder / MANIFEST, content)
        for one in (lambda path: read_manifest(path.parent), lambda path: changed_versions(path.parent)):
            read_or_refused(one, path)
        read_or_refused(lambda path: task_of(path.parent), path)

    return Target(hostile.json_documents(MANIFEST_CONTENT).map(encoded), read)


# Recordings


@cache
def recorded() -> bytes:
    """Return a recording of six seconds."""
    mission = load_mission("table1").model_copy(update={"time_limit": 6.0})
    with tempfile.TemporaryDirectory() as folder:
        settings = RecordSettings(Path(folder), minds=True, name="run")
        run_out(mission_begun(mission, random_start(mission, 1, 0), 2, record=settings))
        return (Path(folder) / "run.swarm").read_bytes()


def used(path):
    """Read a recording and use it as the page and the tables do."""
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


def recording_file(folder: Path) -> Target:
    path = folder / "damaged.swarm"
    return Target(damaged(recorded()), lambda content: read_or_refused(used, put(path, content), str(path)))


def recording_block(which: int, contents, folder: Path) -> Target:
    """Recordings with right checksums, one of whose blocks is another: `contents` draws it, given the whole one."""
    blocks = list(blocks_of(put(folder / "whole.swarm", recorded())))

    def read(content: bytes) -> None:
        path = written(folder / "odd.swarm", [*blocks[:which], (blocks[which][0], content), *blocks[which + 1 :]])
        read_or_refused(used, path, str(path))

    return Target(contents(blocks[which][1]), read)


def odd_heads(head: bytes):
    small = {name: value for name, value in json.loads(head).items() if name not in ("networks", "mission")}
    return hostile.json_documents(small).map(lambda text: encoded(text).rstrip(b"}") + b', "mission": {}}')


def odd_directories(part: bytes):
    end = 4 + struct.unpack_from("<I", part)[0]
    contents = hostile.json_documents(json.loads(part[4:end])).map(encoded)
    return contents.map(lambda content: struct.pack("<I", len(content)) + content + part[end:])


POLICY_TEXT = json.loads((POLICY / "policy.json").read_text(encoding="utf-8"))
TARGETS: dict[str, Callable[[Path], Target]] = {
    **{kind: partial(document, kind, "attack.yaml", hostile.documents(kind)) for kind in KINDS},
    "given starts": partial(document, "given starts", "attack.json", hostile.json_documents(STARTS)),
    "exported store": partial(document, "exported store", "attack.json", hostile.json_documents(STORE)),
    "command line": command_line,
    "strategy, damaged": strategy_file,
    "strategy, odd": strategy_description,
    "policy, damaged": partial(policy, "policy.json", damaged((POLICY / "policy.json").read_bytes())),
    "policy, odd": partial(policy, "policy.json", hostile.json_documents(POLICY_TEXT).map(encoded)),
    "weights, damaged": partial(policy, "policy.safetensors", damaged((POLICY / "policy.safetensors").read_bytes())),
    "journal, damaged": partial(journal, damaged(LINES)),
    "journal, odd": partial(
        journal, hostile.json_documents(record("1", "a").as_mapping()).map(lambda text: encoded(text) + b"\n")
    ),
    "manifest, odd": manifest,
    "recording, damaged": recording_file,
    "recording, damaged head": partial(recording_block, 0, damaged),
    "recording, damaged frames": partial(recording_block, 1, damaged),
    "recording, odd head": partial(recording_block, 0, odd_heads),
    "recording, odd directory": partial(recording_block, 1, odd_directories),
}
"""Name -> the target, which writes into a folder of its own."""
