"""`python -m tests.examples [--newest] DIRECTORY [NAME...]`: run the examples, each in an environment of its own.

The environments lie below DIRECTORY and are made where they do not exist yet. NAME is a key of `ENVIRONMENTS`; all of
them unless given. With `--newest` each environment has today's newest versions in place of those that last ran.
"""

import os
import subprocess
import sys
from pathlib import Path

from tests.examples.environment import environment
from tests.examples.frameworks import BUILT, ENVIRONMENTS
from tests.paths import ROOT

FOLDERS = ("tests/examples",)


def made(directory: Path, name: str, newest: bool = False) -> Path:
    """Return the Python of an environment, which is made if it does not exist."""
    wanted = [text.partition("==")[0] if newest else text for text in ENVIRONMENTS[name][1:]]
    python = environment(directory / name, "--upgrade", "torch", *wanted, "pytest", "hypothesis", "-e", ".")
    if name in BUILT:
        build(python, BUILT[name].partition("==")[0] if newest else BUILT[name])
    return python


def build(python: Path, package: str) -> None:
    """Install a package without its requirements, its games and CUDA (docs/environment.md#pufferlib)."""
    (packages,) = python.parents[1].glob("lib/python*/site-packages")
    (packages / "ocean.pth").write_text("import builtins; builtins.c_extension_paths = []", encoding="utf-8")
    folders = os.environ["PATH"].split(os.pathsep)
    without_cuda = os.pathsep.join(folder for folder in folders if not (Path(folder) / "nvcc").exists())
    command = (python, "-m", "pip", "install", "-q", "--upgrade", "--no-deps", "--no-build-isolation", package)
    subprocess.run(command, env=os.environ | {"NO_OCEAN": "1", "PATH": without_cuda}, check=True)


def passed(python: Path, tests: str) -> bool:
    """Return whether the examples that pytest's expression `tests` chooses have run."""
    command = (python, "-m", "pytest", "-q", "-m", "example", "-k", tests, *FOLDERS)
    return subprocess.run(command, cwd=ROOT, check=False).returncode == 0


def main(words: list[str]) -> int:
    """Return 0 if the examples of all environments have run."""
    newest = words[:1] == ["--newest"]
    place, *given = words[newest:]
    names = given or list(ENVIRONMENTS)
    directory = Path(place).absolute()
    failed = [name for name in names if not passed(made(directory, name, newest), ENVIRONMENTS[name][0])]
    print(f"{len(names) - len(failed)} of {len(names)} environments: all examples have run", *failed)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
