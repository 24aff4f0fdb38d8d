"""Hostile files, one of each kind: they ask for code that writes a file `sang`."""

import base64
import hashlib
import json
import pickle
import zipfile
from pathlib import Path

import yaml

from clean_swarm_env.config.experiment import GivenStarts
from clean_swarm_env.config.load import load_experiment, load_family, load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import mission_begun, run_out
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.arrays import load_arrays, save_arrays
from tests.paths import TRAINED
from tests.train.records import record
from train.running.run_folder import fingerprints, versions

CANARY = """
from pathlib import Path
Path(__file__).with_name("sang").touch()
from selector.strategies.unlearned import MaxScore as Own
"""
OWN = {"name": "canary:Own"}
SHORT = {"base": "table1", "time_limit": 20.0}
"""A mission that takes no time if its code runs after all."""


class Song:
    """What a pickle does when it is loaded."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


def hostile_files(folder: Path) -> list[Path]:
    """Write them into a folder, which is also a directory of configurations; return those to open."""
    (folder / "canary.py").write_text(CANARY)
    _models(folder)
    documents = {
        "experiments/own.yaml": {"mission": SHORT, "conditions": [{"name": "a", "strategy": OWN["name"]}]},
        "experiments/many.yaml": {
            "mission": "table1",
            "strategies": ["canary:Own", "policy:evil.zip"],
            "scenarios": 1,
            "disturbances": [{"kind": "lost", "level": "1", "mission": {"delivery": {"loss": 1.0}}}],
        },
        "training/own.yaml": {
            "tasks": [{"family": "table1-starts"}],
            "observation": {"terms": [{"name": "canary:Term"}]},
            "checkpoints": 1,
            "decisions": 10,
            "bandit": {"strategy": OWN},
        },
    }
    for name, content in documents.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(yaml.safe_dump({"name": path.stem, "description": "strange", **content}))
    arrays, description = load_arrays(TRAINED / "strategies" / "rules.safetensors")
    save_arrays(folder / "own.safetensors", arrays, description | {"strategy": "canary:Own"})
    found = [folder / name for name in documents]
    return [*found, folder / "own.safetensors", _play(folder), *_results(folder)]


def _models(folder: Path) -> None:
    song = pickle.dumps(Song(folder / "sang"))
    serialized = {":serialized:": base64.b64encode(song).decode()}
    keys = ("observation_space", "action_space", "policy_class", "policy_kwargs")
    for name in ("evil.zip", "evil.pt"):
        with zipfile.ZipFile(folder / name, "w") as archive:
            archive.writestr("data", json.dumps(dict.fromkeys(keys, serialized)))
            archive.writestr("archive/data.pkl", song)
            archive.writestr("policy.pth", song)
    (folder / "evil.pkl").write_bytes(song)


def _digest(*paths: Path) -> str:
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def _play(folder: Path) -> Path:
    mission = load_mission("table1").model_copy(update={"time_limit": 2.0})
    start = random_start(mission, 1, 0)
    told = {"name": "x", "start": start.model_dump(mode="json"), "seed": 1, "goal": "", "directories": ()}
    about = {"play": told | {"strategy": "canary:Own", "files": fingerprints()}}
    record = RecordSettings(folder, True, about, name="own.swarm")
    run_out(mission_begun(mission, start, 1, record=record))
    return folder / "own.swarm"


def _results(folder: Path) -> list[Path]:
    beside = {"versions": versions(), "command": ["clean-swarm", "evaluate"]}
    experiment = load_experiment("table1").model_dump(mode="json", include=set(GivenStarts.model_fields))
    members = ("canary:Own", "policy:evil.zip", "velocity:evil.pt")
    family = load_family("table1-starts").model_dump(mode="json")
    family["mission"] |= {"time_limit": SHORT["time_limit"]}
    digests = [_digest(folder / "canary.py"), _digest(folder / "evil.zip", folder / "evil.pkl")]
    digests += [_digest(folder / "evil.pt", folder / "evil.pkl")]
    held = {one: {"members": [f"{one} sha256:{digest}"]} for one, digest in zip(members, digests, strict=True)}
    own = {"a": {"members": held["canary:Own"]["members"]}}
    identities = {
        "own": {"document": experiment, "goal": "AvoidCollision", "conditions": own},
        "model": {"document": family, "goal": "AvoidCollision", "conditions": held},
    }
    found = []
    for name, identity in identities.items():
        path = folder / f"results-{name}"
        path.mkdir()
        whole = {"seed": 3, "files": fingerprints(), **identity}
        (path / "manifest.json").write_text(json.dumps({"identity": whole, **beside}))
        scenario, conditions = ("test-1", members) if name == "model" else ("1", ("a",))
        lines = [json.dumps(record(scenario, one).as_mapping()) + "\n" for one in conditions]
        (path / "runs.jsonl").write_text("".join(lines))
        found.append(path)
    return found
