"""`make quick`: lint and types of what changed since the last push, and the tests of its folders."""

import subprocess
import sys
from pathlib import Path

from tests.mutants.drawing import CORE, nearest_tests
from tests.paths import ROOT


def changed() -> list[str]:
    """Return the files that differ from the branch that is pushed to, or from the last commit without one."""
    upstream = _lines("git", "rev-parse", "--verify", "--quiet", "@{upstream}") or ["HEAD"]
    listed = {
        *_lines("git", "diff", "--name-only", upstream[0]),
        *_lines("git", "ls-files", "-o", "--exclude-standard"),
    }
    return sorted(name for name in listed if (ROOT / name).is_file())


def tests_of(files: list[str]) -> list[str]:
    """Return the test files of the folders in which files changed."""
    found = {name for name in files if Path(name).name.startswith("test_") and name.endswith(".py")}
    for name in files:
        if name.endswith(".py") and name.partition("/")[0] in (*CORE, "train"):
            found |= set(nearest_tests(name))
    return sorted(found)


def main() -> int:
    """Check what changed; return 1 if anything fails."""
    files = changed()
    python = [name for name in files if name.endswith(".py")]
    tools = [["ruff", "check", *python], ["ruff", "format", "--check", *python], ["mypy"]] if python else []
    tests = tests_of(files)
    words = [*tools, *([["pytest", "-q", "-n", "2", "--dist", "loadfile", *tests]] if tests else [])]
    codes = [subprocess.run([sys.executable, "-m", *one], cwd=ROOT, check=False).returncode for one in words]
    return int(any(codes))


def _lines(*words: str) -> list[str]:
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False).stdout.split("\n")[:-1]


if __name__ == "__main__":
    sys.exit(main())
