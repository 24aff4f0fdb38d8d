"""The architecture holds: who imports whom, what importing costs, and what the README says."""

import ast
import re
import subprocess
import sys
from pathlib import Path

from docs.figures.update_architecture import stages
from tests.paths import ROOT

PACKAGES = ("selforg", "selector", "clean_swarm_env", "train", "configs")
OF_NUMBA = {
    "selforg/compiler/ahead.py",
    "selforg/compiler/intrinsics.py",
    "selforg/compiler/cache.py",
    "selforg/compiler/contents.py",
    "selforg/compiler/decorators.py",
    "selforg/compiler/parts.py",
    "selforg/compiler/records.py",
    "selforg/compiler/steps.py",
    "selforg/compiler/switches.py",
    "clean_swarm_env/physics/chipmunk_calls.py",
}
"""The only files that may import Numba: the compiler's own folder, and what calls C from compiled code."""


def _modules_imported(path: Path) -> set[str]:
    """Return the top-level names that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(str(node.module).partition(".")[0])
    return found


def _importing() -> dict[str, set[str]]:
    """Return what each file of the packages imports."""
    files = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    return {path.relative_to(ROOT).as_posix(): _modules_imported(path) for path in files}


def test_numba_is_imported_behind_its_border_alone_and_selforg_needs_nothing_else_but_numpy():
    found = _importing()
    assert {file for file, names in found.items() if "numba" in names} == OF_NUMBA
    others = set().union(*(names for file, names in found.items() if file.startswith("selforg/")))
    assert others <= {"selforg", "numpy", "numba", "llvmlite"} | sys.stdlib_module_names


NAMED = re.compile(r"^(?:\| ?\w* ?\| (`\w+`) \| `([^`]+)` \||\d+\. `([^`]+)`: (.*(?:\n   .*)*))", re.MULTILINE)


def test_what_the_tick_table_and_the_walks_name_is_defined_in_the_file_beside_it():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    found = [(first or walk, table or file) for first, table, file, walk in NAMED.findall(text)]
    assert len(found) > 50
    for words, file in found:
        names = "|".join(re.findall(r"`(\w+)`", words))
        source = (ROOT / file).read_text(encoding="utf-8")
        defined = set(re.findall(rf"^ *(?:(?:def|class) ({names})\b)", source, re.MULTILINE))
        assert defined == set(names.split("|")), file


def test_the_page_says_what_each_stage_of_a_tick_is_for():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    table = text.partition("| stage | what it is for |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| ([A-Z_]+) \| \w", table, re.MULTILINE) == [*stages().values()]


def _loaded_after(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


def test_help_is_quick_because_heavy_libraries_wait():
    assert not _loaded_after("import train.cli.app") & {"matplotlib", "scipy", "pymunk", "numba", "torch"}


OF_EXTRAS = (
    *("unified_planning", "onnxruntime", "cv2", "dask"),
    *("pygame", "torch", "stable_baselines3", "rosbags"),
)
"""What `pip install .` does not bring."""
MAIN_JOBS = (
    *("evaluation.pipeline", "evaluation.comparing", "evaluation.repeat"),
    *("live.session", "replay.page_file"),
)


def test_what_runs_missions_needs_no_extra_and_draws_nothing():
    missing = dict.fromkeys((*OF_EXTRAS, "scipy", "matplotlib", "PIL"))
    code = f"import sys; sys.modules.update({missing}); from clean_swarm_env import clean_swarm_v0, siblings"
    jobs = "; ".join(f"import train.{job}" for job in MAIN_JOBS)
    assert "numba" in _loaded_after(f"{code}; siblings.own('train'); {jobs}")
