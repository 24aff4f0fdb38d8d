import ast
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


def test_selforg_imports_nothing_but_numpy_numba_and_the_standard_library():
    allowed = {"numpy", "numba", "selforg", *sys.stdlib_module_names}
    for path in (ROOT / "selforg").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert all(name.split(".")[0] in allowed for name in names), f"{path} imports {names}"
