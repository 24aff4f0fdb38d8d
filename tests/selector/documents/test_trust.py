"""Names of code in files are refused, unless the command line or the program names them, too, or trusts the files."""

import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest
import yaml

from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.load import load_experiment, load_family, load_mission
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.joined import batches_of
from clean_swarm_env.learning.observation.config import ObservationConfig
from selector.documents.errors import DocumentError
from selector.documents.imported import imported, source_of
from selector.documents.trust import Permission, current_permission, permission_of, permitting, reading_files
from selector.strategies.registry import spec_from_text
from train.running.processes import Processes

CANARY = "from pathlib import Path\nPath('sang').touch()\nfrom selector.strategies.unlearned import MaxScore as Own\n"
REFUSED = "only a file asks to import bird:Own; --import bird .imports= in Python. allows it, --trust"


@pytest.fixture
def canary(tmp_path, monkeypatch):
    """A module that writes a file when it is imported, in the working directory; return whether it was."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "bird", raising=False)
    Path("bird.py").write_text(CANARY)
    Path("own.yaml").write_text(
        yaml.safe_dump({"name": "own", "mission": "table1", "conditions": [{"name": "a", "strategy": "bird:Own"}]})
    )
    yield Path("sang").exists
    sys.modules.pop("bird", None)


def test_a_file_names_no_code_in_a_program(canary):
    with pytest.raises(DocumentError, match=rf"own.yaml: conditions.0.strategy: strategy 'bird:Own': name: {REFUSED}"):
        load_experiment("own.yaml")
    assert not canary()
    with reading_files(trust=True):
        assert load_experiment("own.yaml").conditions[0].strategy == "bird:Own"
    assert canary()


def test_a_program_names_code_itself(canary):
    assert spec_from_text("bird:Own").name == "bird:Own"
    assert canary()
    with pytest.raises(ValueError, match="bird defines no 'Term'"):
        ObservationConfig(terms=("bird:Term",))


def test_a_command_runs_what_its_words_name_in_all_threads(canary):
    def refused():
        with pytest.raises(DocumentError, match=REFUSED):
            imported("bird:Own", "strategy")

    with (
        permitting(permission_of(["evaluate", "--strategy", "fixed:Own"], trusted=False)),
        ThreadPoolExecutor() as pool,
    ):
        refused()
        pool.submit(refused).result()
        with pytest.raises(DocumentError, match=REFUSED):
            spec_from_text("bird:Own")
    assert not canary()
    with permitting(permission_of(["evaluate", "--strategy=mine=bird:Own:x=1"], trusted=False)):
        load_experiment("own.yaml")
    assert canary()


@pytest.mark.parametrize(
    ("words", "name", "allowed"),
    [
        (["--strategy", "a=policy:./x.zip+y.zip"], "y.zip", True),
        (["--strategy=a=policy:./x.zip+y.zip"], "x.zip", True),
        (["--strategy", "own/code.py:Best:speed=2"], "own/code.py:Best", True),
        (["--strategy", "fixed:Off"], "fixed:Off", False),  # no module of the name `fixed`
        (["--strategy", "policy:x.zip"], "policy:x", False),
        (["x.yaml"], "x.zip", False),
    ],
)
def test_the_words_of_a_command_name_code(words, name, allowed):
    names = permission_of(words, trusted=False).names
    assert names is not None
    assert (os.path.normpath(name) in names) == allowed


def test_what_runs_because_a_file_is_trusted_is_said_once_in_one_line(canary, capsys):
    with permitting(permission_of([], trusted=True)):
        for _ in range(2):
            load_experiment("own.yaml")
            imported("bird:Own", "strategy")
        assert current_permission().said == {"bird:Own"}  # workers say nothing again
    assert capsys.readouterr().err == "trusted: own.yaml asks to import bird:Own\n"
    with permitting(permission_of(["--strategy", "bird:Own"], trusted=True)):
        load_experiment("own.yaml")
    assert capsys.readouterr().err == ""


def test_an_argument_trusts_what_it_reads_and_nothing_else(canary, tmp_path, capsys):
    Path("far.yaml").write_text(yaml.safe_dump({"name": "far", "task": "bird:Own"}))
    family = {"name": "far", "description": "x", "mission": "far", "robots": [1, 1], "items": [1, 1]}
    Path("missions").mkdir()
    Path("missions/far.yaml").write_text(Path("far.yaml").read_text())
    Path("family.yaml").write_text(yaml.safe_dump(family))
    readers = (
        partial(load_mission, "far.yaml"),
        partial(load_family, "family.yaml", [tmp_path]),
        partial(load_experiment, "own.yaml"),
        partial(parallel_env, "far.yaml"),
        partial(CleanSwarmTeam, "far.yaml"),
        partial(TeamVectorEnv, 1, mission="far.yaml"),
        partial(Batch, family="family.yaml", directories=tmp_path),
        partial(batches_of, "family.yaml", 1, directories=(tmp_path,)),
    )
    for read in readers:
        with permitting(Permission()):
            with pytest.raises(DocumentError, match="only a file asks to"):
                read()
            capsys.readouterr()
            with suppress(DocumentError):  # it is no task
                read(trust=True)
            assert re.fullmatch(r"trusted: \S+\.yaml asks to [^\n]*\n", capsys.readouterr().err)
            with pytest.raises(DocumentError, match="only a file asks to"):
                read()


class Asking:
    """Work that says what its process may run."""

    keys = (("1", "a"),)

    def each(self):
        raise ValueError(str(current_permission()))


def test_workers_may_run_what_their_parent_may():
    given = permission_of(["bird:Own"], trusted=True)
    with permitting(given), Processes(2).rounds() as done, pytest.raises(ValueError, match="trusted=True"):
        list(done([Asking(), Asking()]))


def test_a_digest_is_taken_without_running_code(canary):
    assert decider_named("bird:Own").identity.startswith("bird:Own sha256:")
    assert source_of("bird.py:Own", "here") == Path("bird.py")
    with pytest.raises(DocumentError, match=r"strategy: no\.module: no such file of Python code"):
        decider_named("no.module:Own")
    assert not canary()
