"""Files of a user with the names of our packages break nothing: script, -c, -m, command line, worker processes."""

import os
import subprocess
import sys

import pytest

from tests.paths import ROOT

USERS = "raise RuntimeError('a file of the user was imported')\n"
IMPORT = "from clean_swarm_env import clean_swarm_v0\nprint(len(clean_swarm_v0.parallel_env().possible_agents))\n"
TASKS = """
import multiprocessing
from clean_swarm_env.siblings import own
own("train")
from train.running.processes import Processes
from tests.clean_swarm_env.worker_tasks import WhereTask
if __name__ == "__main__":
    with Processes(2).rounds() as done:
        print(sorted({run.scenario for run in done([WhereTask(), WhereTask()])}))
"""


@pytest.fixture
def folder(tmp_path):
    """A folder of a user with files of all our plain names, which must not be imported."""
    for name in ("selector", "train"):
        (tmp_path / f"{name}.py").write_text(USERS)
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "__init__.py").write_text(USERS)
    return tmp_path


def python(folder, *words):
    """Return what Python prints in the folder; our packages come after the folder on its path."""
    code = f"import sys; sys.path.insert(1, {str(ROOT)!r})"
    (folder / "sitecustomize.py").write_text(code)
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


WAYS = [
    ("mine.py",),
    pytest.param(("-m", "mine"), marks=pytest.mark.long),
    pytest.param(("-c", IMPORT), marks=pytest.mark.long),
    pytest.param(("train.py",), marks=pytest.mark.long),
    ("-m", "train"),
]


@pytest.mark.parametrize("words", WAYS)
def test_a_script_also_one_that_is_called_as_our_package(folder, words):
    for name in ("mine", *(["train"] if "train" in words[-1] else [])):
        (folder / f"{name}.py").write_text(IMPORT)
    assert python(folder, *words) == "5\n"


@pytest.mark.parametrize(
    "code",
    [f"import train, configs\n{IMPORT}", pytest.param(f"{IMPORT}\nimport train, configs", marks=pytest.mark.long)],
    ids=["before", "after"],
)
def test_the_users_own_modules_stay_importable(folder, code):
    (folder / "train.py").write_text("WHOSE = 'the user'\n")
    (folder / "configs" / "__init__.py").write_text("WHOSE = 'the user'\n")
    assert python(folder, "-c", f"{code}\nprint(train.WHOSE, configs.WHOSE)") == "5\nthe user the user\n"


def test_the_command_line_as_a_module_and_as_the_installed_script(folder):
    named = "import sys; sys.argv[1:] = ['list', 'experiments']"
    script = f"{named}; from clean_swarm_env.__main__ import command_line; command_line()"
    for words in (("-m", "clean_swarm_env", "list", "experiments"), ("-c", script)):
        assert "\npatrol " in python(folder, *words)


@pytest.mark.long
def test_worker_processes_of_a_script(folder):
    (folder / "mine.py").write_text(TASKS)
    expected = f"['{ROOT / 'train' / '__init__.py'}']\n"
    assert python(folder, "mine.py") == python(folder, "-m", "mine") == expected


def test_a_module_of_the_users_that_was_imported_before_is_named(folder):
    (folder / "selector.py").write_text("")
    code = "import selector\ntry:\n    import clean_swarm_env\nexcept ImportError as error:\n    print(error)"
    told = python(folder, "-c", code)
    assert told == (
        f"selector: expected the package {ROOT / 'selector'}, got {folder / 'selector.py'}; "
        "import clean_swarm_env before it\n"
    )
