"""Every file of bad input that once made the program hang, eat memory or end in a traceback is refused in one line."""

import resource
import time
from pathlib import Path

import pytest

import train.reports.machine_picture  # both with Matplotlib, so that what their imports take is not measured
import train.reports.network_picture  # noqa: F401
from tests.attacks.readers import MOST_BYTES, MOST_SECONDS
from tests.train.commands import command, run

ATTACKS = Path(__file__).with_name("data")
CONFIGS = ("--configs", ATTACKS / "configs")
RUN = {"pile.yaml"}
"""Files that are no bad input; see `test_pile.py`."""
KNOWLEDGE = ("k1.yaml", "k2.yaml", "inf.yaml", "nan.json", "dup.json")


def words_for(path):
    if path.name in KNOWLEDGE:
        return ("knowledge", "import", path, "--store", "store.sqlite")
    if path.name == "starts.json":
        return ("evaluate", "--starts", path)
    return ("evaluate", path, *CONFIGS)


FILES = sorted(path for pattern in ("*.yaml", "*.json") for path in ATTACKS.glob(pattern) if path.name not in RUN)
COMMANDS = {path.name: words_for(path) for path in FILES}
COMMANDS |= {
    f"draw {path.stem}": ("look", "draw", path.stem, *CONFIGS)
    for path in sorted((ATTACKS / "configs" / "robots").glob("*"))
}
COMMANDS |= {f"draw {name}": ("look", "draw", ATTACKS / name) for name in ("e2.yaml", "k1.yaml", "m1.yaml", "e5.yaml")}
COMMANDS |= {
    f"run {name}": ("evaluate", "MaxValue", "--knowledge", name, *CONFIGS)
    for name in ("bomb", "selfref", "../x", "none")
}
COMMANDS |= {
    "scenarios": ("evaluate", "--scenarios", 10**8),
    "workers": ("evaluate", "--workers", 10**9),
    "seed": ("evaluate", "--seed", 10**30),
}


@pytest.fixture(scope="module")
def imported():
    """What these commands import takes memory and time, which are not measured."""
    for words in (("list",), ("evaluate", "--condition", "nothing"), ("evaluate", "MaxValue", "--scenarios", 0)):
        run(*words)


@pytest.mark.parametrize("name", COMMANDS)
def test_bad_input_is_refused_in_one_line_at_once_and_writes_nothing(name, imported, tmp_path, monkeypatch):
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(3):  # the first one imports more, and on a busy machine half a second of CPU time becomes one
        began = time.process_time()
        code, out, err = command(*COMMANDS[name])
        took = time.process_time() - began
        if took < MOST_SECONDS:
            break
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert err.endswith("\n")
    assert err[:-1].isprintable()
    assert len(err) < 1500
    if name.endswith((".yaml", ".json")):
        assert name.removeprefix("draw ") in err or "/configs/" in err
    assert took < MOST_SECONDS
    assert grown < MOST_BYTES
    assert [*tmp_path.iterdir()] == [here]
    assert not [path for path in here.rglob("*") if path.is_file()]
