"""`python -m tests.versions FOLDER [PYTHON...]`: tries Pythons, and the lowest versions that pyproject.toml allows.

Each PYTHON (a version or a path; 3.11, 3.12 and 3.13 unless given) gets an environment in FOLDER, once with the newest
packages and the first one also with the lowest ones. In each the wheel is installed, a mission runs, and some tests
pass. Needs `uv` (https://docs.astral.sh/uv/). Not a part of CI: it takes minutes.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.paths import ROOT

PYTHONS = ("3.11", "3.12", "3.13")
NEWEST, LOWEST = "highest", "lowest-direct"
TESTS = ("tests/clean_swarm_env/config", "tests/train/cli/test_configs.py", "tests/selforg/test_switches.py")
TOOLS = ("pytest", "hypothesis", "types-PyYAML")
SHOWN = ("numpy", "numba", "pydantic", "typer", "pettingzoo")
"""Packages whose versions are printed."""


def tried(environment: Path, python: str, resolution: str) -> str:
    """Install the packages, run a mission and tests; return what failed, or the versions that it works with."""
    bin_folder = environment / "bin"
    steps = (
        ("uv", "venv", "-q", "--clear", "--python", python, environment),
        ("uv", "pip", "install", "-q", "--python", bin_folder / "python", "--resolution", resolution, ROOT),
        ("uv", "pip", "install", "-q", "--python", bin_folder / "python", *TOOLS),
        (bin_folder / "clean-swarm", "evaluate", "--help"),
        (bin_folder / "clean-swarm", "evaluate", "--scenarios", "1", "--workers", "1"),
        (bin_folder / "python", "-m", "pytest", "-qx", "-m", "", "--rootdir", ROOT, *(ROOT / test for test in TESTS)),
    )
    own = {**os.environ, "PYTHONPATH": str(ROOT)}
    with tempfile.TemporaryDirectory() as elsewhere:
        for step in steps:
            of_ours = step[0] == bin_folder / "python"
            done = subprocess.run(
                [*map(str, step)], cwd=elsewhere, env=own if of_ours else None, capture_output=True, text=True
            )
            if done.returncode:
                said = (done.stderr or done.stdout).strip().splitlines()
                return f"FAILED: {' '.join(map(str, step[:5]))}: {said[-1] if said else done.returncode}"
    frozen = subprocess.run(
        ["uv", "pip", "freeze", "--python", str(bin_folder / "python")], capture_output=True, text=True, check=True
    )
    return ", ".join(line for line in frozen.stdout.splitlines() if line.partition("==")[0] in SHOWN)


def main(arguments: list[str]) -> int:
    """Try all; return 1 if one failed."""
    folder, pythons = Path(arguments[0]).resolve(), tuple(arguments[1:]) or PYTHONS
    failed = 0
    for python, resolution in ((pythons[0], LOWEST), *((python, NEWEST) for python in pythons)):
        said = tried(folder / f"{python.strip(os.sep).replace(os.sep, '_')}-{resolution}", python, resolution)
        failed += said.startswith("FAILED")
        print(f"{python}, {resolution}: {said}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
