import os
import re
import subprocess
import sys

from tests.paths import ROOT


def test_the_examples_of_the_guide_run(tmp_path):
    text = (ROOT / "docs" / "selforg.md").read_text()
    guide = tmp_path / "guide.py"
    guide.write_text("\n".join(re.findall(r"```python\n(.*?)```", text, re.S)) + "\nprint(vectors.shape)\n")
    ran = subprocess.run(
        [sys.executable, guide], env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=True
    )
    assert ran.stdout == "(5, 2)\n"
