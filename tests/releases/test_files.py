"""Files that earlier releases wrote are read with today's code, and say what they said then."""

import contextlib
import json
import re
from pathlib import Path

import pytest

from clean_swarm_env import __version__, clean_swarm_v0
from clean_swarm_env.recording.file import FORMAT_VERSION, MAGIC
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.errors import DocumentError
from selector.documents.reading import read_json
from selector.store.contents import FORMAT
from selector.store.knowledge_store import SCHEMA
from selector.strategies.learned_file import VERSION
from selector.strategies.policy_file import PolicySpec
from selforg.sealing import STATE_VERSION
from tests.paths import ROOT
from tests.releases.environments import course
from tests.releases.files import READINGS, STEPS
from train.evaluation.repeat import record_run, task_of
from train.running.run_folder import RESULTS_FORMAT, fingerprints, read_manifest

HERE = Path(__file__).parent
RELEASES = sorted(path for path in HERE.iterdir() if re.fullmatch(r"\d+\.\d+\.\d+", path.name))
MOST_BYTES = 300_000
each_release = pytest.mark.parametrize("folder", RELEASES, ids=lambda folder: folder.name)


def test_the_files_of_this_release_are_there_and_small():
    assert HERE / __version__ in RELEASES, "run: python -m tests.releases.write"
    for folder in RELEASES:
        assert sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) < MOST_BYTES


@each_release
@pytest.mark.parametrize("name", READINGS)
def test_a_file_says_what_it_said(folder, name, monkeypatch):
    expected = read_json(folder / "expected.json")
    if name not in expected:
        pytest.skip(f"{folder.name} wrote none")
    monkeypatch.chdir(folder)
    assert json.loads(json.dumps(READINGS[name](Path(name)))) == expected[name]


@each_release
def test_a_run_is_repeated_as_it_was_recorded_while_its_files_are_the_same(folder, monkeypatch, tmp_path):
    monkeypatch.chdir(folder)
    changed = read_manifest(Path("results"))["identity"]["files"] != fingerprints()
    with pytest.raises(DocumentError, match="changed since") if changed else contextlib.nullcontext() as refused:
        record_run(task_of(Path("results")), tmp_path / "again.swarm", minds=True)
    if refused is not None:
        assert "\n" not in str(refused.value)
        return
    old, new = RecordedMission(Path("mission.swarm")), RecordedMission(tmp_path / "again.swarm")
    assert {name: old.whole(name).tobytes() for name in old} == {name: new.whole(name).tobytes() for name in old}
    assert new.result == old.result


@each_release
def test_a_state_goes_on_or_says_its_version_in_one_line(folder):
    state = (folder / "state.bin").read_bytes()
    env = clean_swarm_v0.parallel_env(str(folder / "mission.yaml"))
    held = int(state.split(b"\n")[0].split()[2])
    if held == STATE_VERSION:
        env.set_state(state)
        assert course(env, STEPS, reset=False) == (folder / "state.txt").read_text().strip()
    other = state.replace(b"state %d" % held, b"state %d" % (STATE_VERSION + 1), 1)
    message = rf"^state: expected b'clean-swarm state {STATE_VERSION} batch', got b'clean-swarm state \d+ batch'$"
    with pytest.raises(ValueError, match=message):
        env.set_state(other)


def test_the_page_of_versions_has_the_numbers_of_the_code():
    text = (ROOT / "docs" / "versions.md").read_text(encoding="utf-8")
    numbers = dict(re.findall(r"^\| ([^|]+?) \| (?:\*\*)?([\w.]+)(?:\*\*)? \|", text, re.MULTILINE))
    written = int.from_bytes((HERE / __version__ / "mission.swarm").read_bytes()[len(MAGIC) :][:4], "little")
    assert numbers["[environments](environment.md)"] == clean_swarm_v0.CleanSwarm.metadata["name"].rpartition("_")[2]
    assert int(numbers["[states](environment.md#copies-and-states)"]) == STATE_VERSION
    assert int(numbers["[recordings](recordings.md)"]) == FORMAT_VERSION == written
    assert int(numbers["[results](commands.md), trainings"]) == RESULTS_FORMAT
    assert int(numbers["[policies](strategies.md#trained-policies)"]) == PolicySpec.model_fields["version"].default
    assert int(numbers["learned [strategies](strategies.md)"]) == VERSION
    assert int(numbers["[stores](knowledge.md)"]) == SCHEMA
    assert int(numbers["exported stores"]) == FORMAT["version"]
