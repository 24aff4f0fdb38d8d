"""Every line of the commands in README.md and docs/commands.md runs word for word, in order, in an empty directory.

The directory has the examples that lines name. What takes long runs with the smallest numbers here, and says its
minutes if that is more than one. `make long` runs all of it whole.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import threading
from importlib.util import find_spec

import pytest
import yaml

from selector.documents.find import SHIPPED
from tests.paths import ROOT
from train.cli.app import app
from train.live.server import LiveServer

LONG = os.environ.get("CLEAN_SWARM_LONG") == "1"
README = (ROOT / "README.md").read_text(encoding="utf-8")
SETUP = r"<!-- ci: (?:run|test|train) -->\n```sh.*?```\n"
TEXT = re.sub(SETUP, "", README, flags=re.DOTALL) + (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
LINES = [
    line
    for block in re.findall(r"\n```sh\n(.*?)```\n", TEXT, re.DOTALL)
    for line in re.sub(r" \\\n *", " ", block).strip().splitlines()
]
SHORT = {
    "evaluate --scenarios 100": ("--scenarios", "1"),
    "evaluate robustness": ("--scenarios", "1", "--configs", "small"),
    "evaluate --family clustered": ("--scenarios", "1", "--configs", "small"),
    "train ppo": ("--configs", "small"),
    "tune keep-apart": ("--configs", "small"),
    "study score crowded": ("--scenarios", "1", "--configs", "small"),
    "run --all": ("--runs", "2"),
    "examples/sb3_ppo.py": ("--steps", "5120"),
}
"""Beginning of a line that takes long -> words behind it that make it short."""
MINUTES = ("train ppo", "tune keep-apart")
"""Beginnings of the lines that take more than a minute on two CPUs."""
SMALL = {
    "families/clustered": {"mission": {"base": "exploring", "time_limit": 5.0}},
    "families/crowded": {"mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 5.0}},
    "families/table1": {"mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 5.0}},
    "experiments/robustness": {"mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 31.0}},
    "studies/keep-apart": {
        "method": "random",
        "trials": 2,
        "batch": 2,
        "race": {"block": 2, "blocks": 1},
        "last": {"scenarios": 2},
    },
    "training/exploring-ppo": {
        "tasks": [{"family": "clustered", "worlds": 1}],
        "checkpoints": 1,
        "decisions": 500,
        "validation": {"scenarios": 1},
        "ppo": {"steps": 16},
    },
}
"""Shipped document -> what is smaller in the short version."""


@pytest.fixture(scope="module")
def empty(tmp_path_factory):
    """A directory with the examples only, in which the commands run; beside LONG, small documents of the same names."""
    folder = tmp_path_factory.mktemp("empty")
    shutil.copytree(ROOT / "examples", folder / "examples")
    for place, changes in () if LONG else SMALL.items():
        content = yaml.safe_load((SHIPPED / f"{place}.yaml").read_text(encoding="utf-8"))
        path = folder / "small" / f"{place}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(yaml.safe_dump(content | changes, sort_keys=False))
    return folder


def parts(line):
    """Return the words of a line after `clean-swarm` or `python`, and its remark."""
    command, _, remark = line.partition("#")
    program, *words = shlex.split(command)
    assert program == ("python" if words[0].startswith("examples/") else "clean-swarm"), line
    return words, remark.strip()


def shortened(words):
    return [word for start, more in SHORT.items() if " ".join(words).startswith(start) for word in more]


@pytest.mark.parametrize("line", LINES, ids=lambda line: " ".join(parts(line)[0][:3]))
def test_a_command_runs(line, empty, monkeypatch):
    words, _ = parts(line)
    trains = words[:2] == ["train", "ppo"] or words[0] == "examples/sb3_ppo.py"
    if trains and find_spec("torch") is None:
        pytest.skip("needs the extra 'train'")
    if words[0] == "tune" and find_spec("optuna") is None:
        pytest.skip("needs the extra 'tune'")
    trained = {"policy:results/mine/policy": "results/mine/policy", "velocity:sb3_ppo.zip": "sb3_ppo.zip"}
    if any(word in words and not (empty / file).exists() for word, file in trained.items()):
        pytest.skip("needs the extra 'train'")
    monkeypatch.chdir(empty)
    if words[0] != "play" and (LONG or any(word.startswith("examples/") for word in words)):
        program = () if words[0].startswith("examples/") else ("-m", "clean_swarm_env")
        own, small = os.environ | {"PYTHONPATH": str(ROOT)}, () if LONG else shortened(words)
        assert subprocess.run([sys.executable, *program, *words, *small], env=own).returncode == 0
        return
    if words[0] == "play":  # until Ctrl-C, here once its page is served
        monkeypatch.setattr(LiveServer, "start", lambda *_: threading.Timer(0.0, lambda: None).start() or interrupt())
    alone = ["--workers", "1"] if {"--scenarios", "--strategy"} & set(words) else []
    with pytest.raises(SystemExit) as end:
        app([*words, *shortened(words), *([] if words[0] in ("run", "explain") else alone)])
    assert end.value.code == (130 if words[0] == "play" else 0)


def interrupt():
    raise KeyboardInterrupt


def test_the_ten_lines_train_a_selector(empty, monkeypatch):
    pytest.importorskip("stable_baselines3")
    (lines,) = re.findall(r"<!-- ci: learn -->\n```python\n(.*?)```\n", README, re.DOTALL)
    assert len([line for line in lines.splitlines() if line]) <= 10
    monkeypatch.chdir(empty)
    exec(lines if LONG else lines.replace("worlds=24", "worlds=2").replace("1_000_000", "2_000"), {})
    assert (empty / "mine.zip").exists()


def test_what_takes_more_than_a_minute_says_how_long_and_nothing_has_to_be_filled_in():
    assert len(LINES) > 20
    for line in LINES:
        words, remark = parts(line)
        assert (re.search(r"\b\d+ min\b", remark) is not None) == " ".join(words).startswith(MINUTES), line
        assert not re.search(r"\b[A-Z]{4,}\b|\bmy-", line.partition("#")[0].replace("ORCA", "")), line
