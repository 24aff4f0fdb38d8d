"""The code of every tutorial runs word for word, in order, in an empty directory with the examples.

Files that a tutorial names are written as it shows them. What takes a minute runs with small numbers.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec

import pytest

from tests.paths import ROOT

PAGES = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
BLOCK = re.compile(r"(?:`([\w./]+)`:\n\n)?```(sh|python|yaml)\n(.*?)```\n", re.DOTALL)
SHORT = {"--steps 200000": "--steps 2560", "worlds=24": "worlds=2", "1_000_000": "2_000", "--to 20": "--to 2"}
"""What takes long -> what the test has in its place."""
LEARNS = {"learn", "selector"}
"""Tutorials that need the extra `train`."""
PLAYED = "clean-swarm play"
"""What runs until Ctrl-C; tests/docs/test_readme_commands.py runs it."""


def blocks(page):
    """Return file, language and text of each block of code; the file is empty for code that runs."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


def run(words, folder):
    """Run a command in a folder with the packages of this checkout, and return what it printed."""
    own = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(words, cwd=folder, env=own, capture_output=True, text=True)
    assert done.returncode == 0, f"{shlex.join(words)}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_there_are_six_with_pictures_and_something_to_run():
    assert {page.stem for page in PAGES} == {"see", "learn", "selector", "mechanism", "task", "mind"}
    for page in PAGES:
        assert "![" in page.read_text(encoding="utf-8"), page.name
        assert any(not file and language in ("sh", "python") for file, language, _ in blocks(page)), page.name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_runs(page, tmp_path):
    if page.stem in LEARNS and find_spec("torch") is None:
        pytest.skip("needs the extra 'train'")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    ran = 0
    for file, language, text in blocks(page):
        for long, short in SHORT.items():
            text = text.replace(long, short)
        if file:
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file).write_text(text, encoding="utf-8")
        elif language == "python":
            run([sys.executable, "-c", text], tmp_path)
            ran += 1
        else:
            for line in re.sub(r" \\\n *", " ", text).splitlines():
                program, *words = shlex.split(line)
                module = ["-m", "clean_swarm_env"] if program == "clean-swarm" else []
                assert program in ("clean-swarm", "python"), line
                if not line.startswith(PLAYED):
                    assert run([sys.executable, *module, *words], tmp_path) != ""
                    ran += 1
    assert ran > 0
