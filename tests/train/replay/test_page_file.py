"""The page as a file: complete, of modules whose types fit, and one line of error for what cannot be shown."""

import re
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

from tests.train.commands import refused
from train.replay.page_file import MODULES, joined

FOLDER = files("train.replay") / "page"
SOURCES = {name: (FOLDER / f"{name}.js").read_text() for name in MODULES}


def test_all_modules_are_joined_each_after_those_that_it_imports():
    assert {path.name for path in FOLDER.iterdir()} == {f"{name}.js" for name in MODULES} | {"page.html", "page.css"}
    for number, name in enumerate(MODULES):
        needed = re.findall(r'^import .* from "\./(\w+)\.js";$', SOURCES[name], flags=re.MULTILINE)
        assert set(needed) <= set(MODULES[:number])


def test_no_name_is_declared_in_two_modules():
    declared = [
        found for text in SOURCES.values()
        for found in re.findall(r"^(?:export )?(?:async )?(?:function|class|const|let) (\w+)", text, flags=re.MULTILINE)
    ]  # fmt: skip
    assert sorted(declared) == sorted(set(declared))


def test_joined_modules_import_and_export_nothing():
    script = joined(list(SOURCES.values()))
    assert not re.search(r"^(import|export)\b", script, flags=re.MULTILINE)
    assert "https://" not in script
    assert "http://" not in script


@pytest.mark.skipif(shutil.which("tsc") is None, reason="needs TypeScript: npm install -g typescript")
def test_the_types_of_the_modules_fit():
    done = subprocess.run(
        ["tsc", "-p", Path(__file__).with_name("tsconfig.json")], capture_output=True, text=True, check=False
    )
    assert done.stdout == ""
    assert done.returncode == 0


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("none.swarm",), "none.swarm: cannot be read (No such file or directory)"),
        (("other.swarm",), "other.swarm: expected a recording of a mission (.swarm), got another kind of file"),
        ((".",), "has no manifest.json; expected the results of an evaluation"),
        ((".", ".", "."), "replay: expected one or two runs, and a condition for each or for all"),
    ],
)
def test_what_cannot_be_shown_is_one_line(tmp_path, monkeypatch, words, expected):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other.swarm").write_text("something else")
    assert expected in refused("replay", *words, "--html", tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()
