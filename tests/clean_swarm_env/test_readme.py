"""The README's example runs, and what it shows exists."""

import re
import subprocess
import sys

from tests.paths import ROOT

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_example_runs_from_any_directory(tmp_path):
    (code,) = re.findall(r"<!-- ci: example -->\n```python\n(.*?)```\n", TEXT, re.DOTALL)
    path = tmp_path / "example.py"
    path.write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, str(path)], cwd=tmp_path, capture_output=True, text=True, check=True)
    line = r"\d+ s, return -?\d+\.\d, options \{'AvoidCollision': \('RepulsionFernandez', .*\)\}\n"
    assert re.fullmatch(line, done.stdout)


def test_pictures_and_links_exist():
    targets = [target for target in re.findall(r"\]\(([^)#]+)\)", TEXT) if "://" not in target]
    assert {"docs/pictures/mission.webp", "docs/replay.html"} <= set(targets)
    assert [target for target in targets if not (ROOT / target).exists()] == []


def test_the_readme_fits_on_two_screens():
    assert len(TEXT.splitlines()) <= 120
