"""Plug-ins: installed packages, and modules that a command line names, in commands, files and worker processes.

Each command runs in a fork of this process.
"""

import shutil
import subprocess
import sys
from contextlib import chdir
from functools import partial

import pytest

from clean_swarm_env import Batch
from selforg import plugins
from tests.paths import ROOT
from tests.train import commands
from tests.train.commands import apart

pytestmark = pytest.mark.usefixtures("undrawn")
TEMPLATE = ROOT / "examples" / "plugin"
READ = "return np.hypot(*self.source.vectors[rows].T) > self.speed"
"""What the sensor of the template does."""
FORMULA = "class KeepDistance(FormulaMechanism):"
TASK = "    fewest = 2\n"
ONE = ("--strategy", "MaxScore", "--scenarios", "1", "--workers", "1", "--output", "r")
"""A mission under one strategy, in this process."""
"""A line of the template's task, after which tests add methods."""
PLAIN = (
    "class KeepDistance(__import__('selforg.mechanisms').mechanisms.MovementMechanism):\n"
    "    def move_into(self, now, rows, vectors, active):\n        vectors[rows] = 0.0\n"
)
"""The head of the template's mechanism, and a mechanism in its place that takes no seconds to compile."""


@pytest.fixture
def site(tmp_path):
    """A folder of packages with the template, which is not installed yet."""
    shutil.copytree(TEMPLATE / "my_swarm", tmp_path / "site" / "my_swarm")
    return tmp_path / "site"


@pytest.fixture
def installed(site):
    """A folder of packages with the template as pip installs it."""
    described(site, "my-swarm", "0.1.0", "my_swarm = my_swarm")
    return site


def described(site, name, version, entries):
    """Write what an installer writes beside a package: its name, its version, its entry points."""
    folder = site / f"{name.replace('-', '_')}-{version}.dist-info"
    folder.mkdir(exist_ok=True)
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (folder / "entry_points.txt").write_text(f"[clean_swarm]\n{entries}\n")


def rewrite(site, *changes):
    """Change the code of the template: pairs of old and new text."""
    path = site / "my_swarm" / "__init__.py"
    code = path.read_text()
    for old, new in changes:
        assert old in code
        code = code.replace(old, new)
    path.write_text(code)


def run(work, site, *words):
    """Return what a function of `tests.train.commands` returns for words, beside a folder of packages."""
    with chdir(site.parent):
        return apart(lambda: work(*words), site)


done, refused = partial(run, commands.done), partial(run, commands.refused)


def test_the_template_names_its_entry_point():
    project = (TEMPLATE / "pyproject.toml").read_text()
    assert '[project.entry-points.clean_swarm]\nmy_swarm = "my_swarm"\n' in project


@pytest.mark.extra
@pytest.mark.long
def test_a_wheel_of_the_template_has_its_entry_point_and_its_files(tmp_path):
    pytest.importorskip("hatchling")
    shutil.copytree(TEMPLATE, tmp_path / "plugin")
    options = ["--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--target", str(tmp_path / "site")]
    install = [sys.executable, "-m", "pip", "install", *options, str(tmp_path / "plugin")]
    subprocess.run(install, check=True, capture_output=True)
    assert "(from my-swarm 0.1.0)" in done(tmp_path / "site", "list", "families")
    assert "nearest" in done(tmp_path / "site", "evaluate", "KeepApart", *ONE)


@pytest.mark.parametrize(
    ("mechanism", "workers"), [(PLAIN, "1"), pytest.param(FORMULA, "2", marks=pytest.mark.long)], ids=["1", "2"]
)
def test_an_installed_plugin_is_known_to_commands_and_their_workers(installed, mechanism, workers):
    rewrite(installed, (FORMULA, mechanism))
    words = ("--strategy", "fixed:KeepDistance", "--strategy", "Second", "--scenarios", "2", "--workers", workers)
    done(installed, "evaluate", "parting", *words, "--output", "r")
    table = (installed.parent / "r" / "table.md").read_text()
    assert "Second" in table
    assert "KeepDistance" in table


def test_names_say_where_they_come_from(installed):
    names = {"KeepDistance": "classes", "parting": "families", "KeepApart": "tasks", "Pushed": "classes"}
    for name, kind in (names | {"Second": "strategies"}).items():
        (line,) = [line for line in done(installed, "list", kind).splitlines() if line.startswith(f"{name} ")]
        assert line.endswith("(from my-swarm 0.1.0)")


def test_a_plugin_that_is_only_named_is_known_as_well_and_not_without(site):
    """By the command line; a file may name it only if the command line does."""
    rewrite(site, (FORMULA, PLAIN))
    assert "experiment or task 'KeepApart'" in refused(site, "evaluate", "KeepApart")
    family = ("evaluate", "my_swarm:KeepApart", "--strategy")
    assert "unknown strategy 'Nothing'" in refused(site, *family, "Nothing")
    words = (*family, "my_swarm:Second", "--scenarios", "1", "--workers", "1", "--output", "r")
    done(site, *words)
    assert "my_swarm:Second" in (site.parent / "r" / "table.md").read_text()
    mission = "{task: 'my_swarm:KeepApart', time_limit: 10.0}"
    (site.parent / "own.yaml").write_text(
        f"name: own\ndescription: Few.\nmission: {mission}\nrobots: [3, 3]\nitems: [0, 0]\n"
    )
    words = ("evaluate", "own.yaml", "--strategy", "fixed", "--scenarios", "1", "--workers", "1")
    line = refused(site, *words)
    assert "own.yaml: mission: task: " in line
    assert "only a file asks to import my_swarm:KeepApart; --import my_swarm (imports= in Python) allows it" in line
    done(site, *words, "--import", "my_swarm")


KINDS = """
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from clean_swarm_env import TERMS, Term
from clean_swarm_env.learning.reward import REWARD_TERMS
from selforg.components import ACTIONS, Action
from selforg.network.model.activators import ACTIVATORS, THRESHOLD_RULE, Activator

@ACTIONS.register
class North(Action):
    "Command 1 m/s to the north."
    def act(self, now, rows, started, commands):
        commands.vectors[rows], commands.commanded[rows] = (0.0, 1.0), True

@ACTIVATORS.register
@dataclass(frozen=True)
class Low(Activator):
    "Fulfilled at or below a limit."
    limit: float = 1.0
    kind = THRESHOLD_RULE
    @property
    def parameters(self):
        return self.limit, 0.0, -1.0

@TERMS.register
class East(Term):
    "How far east the robot is."
    name, components = "east", ("east",)
    def write(self, rows, out):
        around = self.observed.around.record
        out[0, rows] = around.positions[rows, 0] / around.extent[0]

@REWARD_TERMS.register
def northward(batch):
    "What each robot is paid for where it is."
    return batch.worlds.physics.positions[:, 1] / batch.worlds.extent[1]
"""
HOP = """
mechanisms: {shy: {type: RepulsionGradient}}
sensors: {push: {type: VectorLength, mechanism: shy}}
behaviours:
  Hop: {action: {type: North}, preconditions: [{sensor: push, activator: {type: Low}}]}
"""


@pytest.fixture
def kinds(tmp_path):
    """A file with an action, an activator, an observation term and a reward term, and YAML files that name them."""
    folder = tmp_path
    (folder / "kinds.py").write_text(KINDS)
    for name in ("mechanisms/Hop", "knowledge/kinds", "families/kinds", "training/kinds"):
        (folder / name).parent.mkdir()
    (folder / "mechanisms" / "Hop.yaml").write_text(HOP)
    (folder / "knowledge" / "kinds.yaml").write_text(
        "goals: {CollectiveExploration: [{configuration: Hop, score: 1.0}]}"
    )
    mission = "{task: CollectiveExploration, time_limit: 20.0, knowledge: kinds}"
    (folder / "families" / "kinds.yaml").write_text(
        f"{{name: kinds, description: Few., mission: {mission}, robots: [3, 3], items: [0, 0]}}"
    )
    (folder / "training" / "kinds.yaml").write_text(
        "{name: kinds, description: Few., tasks: [{family: parting, worlds: 2}], goal: KeepApart, checkpoints: 1, "
        "decisions: 200, observation: {terms: [east, command]}, reward: {northward: 0.5}, validation: {scenarios: 2}, "
        "ppo: {minibatch: 64}}"
    )
    return folder


def test_every_kind_comes_from_a_file_that_a_command_names(site, kinds):
    words = ("evaluate", "kinds", "--configs", ".", "--strategy", "fixed", "--strategy", "MaxScore")
    words = (*words, "--scenarios", "2", "--workers", "1")
    assert "unknown activator 'Low' (known: Boolean, " in refused(site, *words)
    done(site, *words, "--import", "kinds.py")
    for name, kind in {"North": "classes", "Low": "classes", "east": "terms"}.items():
        lines = done(site, "list", kind, "--import", "kinds.py").splitlines()
        (line,) = [line for line in lines if line.startswith(f"{name} ")]
        assert line.endswith(f"(from {kinds / 'kinds.py'})")


@pytest.mark.parametrize("name", ["northward", "kinds.py:northward"])
def test_a_term_and_a_reward_of_a_file_are_those_of_a_batch(kinds, monkeypatch, name):
    def rewards():
        terms = {"terms": ["cargo", "east"]}
        batch = Batch(observation=terms, reward={"cost": 0.0, name: 2.0}, imports=["kinds.py"])
        batch.reset([1])
        step = batch.step([0] * batch.rows)
        return batch.observer.names, step.rewards * 5.5, batch.worlds.physics.positions[:, 1]

    monkeypatch.chdir(kinds)
    names, paid, north = apart(rewards)
    assert names[-1] == "east"
    assert paid == pytest.approx(north, abs=1e-6)


@pytest.mark.extra
@pytest.mark.long
def test_ppo_learns_on_the_family_and_with_the_terms_of_plugins(installed, kinds):
    pytest.importorskip("stable_baselines3")
    words = ("train", "ppo", "--config", "kinds", "--configs", ".", "--output", "r")
    assert "northward: unknown key 'northward'" in refused(installed, *words)
    done(installed, *words, "--import", "kinds.py")
    assert (installed.parent / "r" / "policy" / "policy.json").is_file()


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ("a = no_such_swarm", "no_such_swarm: No module named 'no_such_swarm'"),
        ("a = my_swarm:Nothing", "my_swarm: AttributeError: module 'my_swarm' has no attribute 'Nothing'"),
        ("a = my_swarm\nb = my_swarm:KeepApart", ""),
    ],
)
def test_entry_points_that_lead_nowhere_are_one_line_and_two_to_one_module_are_one_plugin(installed, entries, said):
    described(installed, "my-swarm", "0.1.0", entries)
    if said:
        assert said in refused(installed, "evaluate", "KeepApart", *ONE)
    else:
        assert "parting" in done(installed, "list", "families")


def test_a_package_that_brings_names_of_another_is_one_line(installed):
    described(installed, "other-swarm", "1", "other = other_swarm")
    shutil.copytree(installed / "my_swarm", installed / "other_swarm", ignore=shutil.ignore_patterns("*.yaml"))
    line = refused(installed, "evaluate", "KeepApart", *ONE)
    assert "other_swarm/__init__.py:" in line
    assert "mechanism 'KeepDistance' is registered already, by my_swarm" in line


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("import no_such_module", "__init__.py:1: No module named 'no_such_module'"),
        ("def broken(:", "__init__.py:1: SyntaxError: "),
        (
            "from selforg.mechanisms import MECHANISMS, FormulaMechanism\n\n"
            "@MECHANISMS.register\nclass ORCA(FormulaMechanism):\n    formula = staticmethod(lambda pair: 0.0)\n",
            "__init__.py:3: ValueError: mechanism 'ORCA' is registered already, by selforg.mechanisms.steering.orca",
        ),
        (
            "from clean_swarm_env.config.tasks import TASKS, TaskKind\n\n"
            "@TASKS.register\nclass Mine(TaskKind):\n    name = 'Foraging'\n",
            "__init__.py:3: ValueError: task 'Foraging' is registered already, by clean_swarm_env.tasks.foraging",
        ),
        (
            "from selforg.mechanisms import MECHANISMS\n\nMECHANISMS.register(7)",
            "__init__.py:3: TypeError: a mechanism: expected a class below Mechanism, got 7",
        ),
        (
            "from selforg.components import SENSORS, Action\n\n@SENSORS.register\nclass Mine(Action): ...\n",
            "TypeError: a sensor: expected a class below SensorComponent, got <class 'my_swarm.Mine'>",
        ),
        ("raise SystemExit(3)", "__init__.py:1: SystemExit: 3"),
        ("raise type('Own', (BaseException,), {})(7)", "__init__.py:1: Own: 7"),
    ],
)
def test_a_plugin_that_cannot_be_imported_is_one_line_once_it_is_needed(installed, code, said):
    (installed / "my_swarm" / "__init__.py").write_text(code)
    done(installed, "--help")
    assert said in refused(installed, "evaluate", "KeepApart", *ONE)
    assert said in refused(installed, "evaluate", "Foraging", *ONE, "--import", "my_swarm")


def test_a_file_of_a_plugin_has_a_name_of_its_own(installed):
    (installed / "my_swarm" / "families" / "crowded.yaml").write_text("name: crowded\n")
    line = refused(installed, "evaluate", "parting", "--strategy", "fixed")
    assert "my-swarm 0.1.0: " in line
    assert "families/crowded.yaml: the family 'crowded' exists already: " in line


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            READ,
            "return np.full(len(rows), np.nan)",
            "my-swarm 0.1.0: Pushed.read: expected finite numbers, one of each row, got float64 (24,) with NaN",
        ),
        (
            READ,
            "return np.zeros(3)",
            "my-swarm 0.1.0: Pushed.read: expected finite numbers, one of each row, got float64 (3,)",
        ),
        (
            READ,
            "rows[:] = 0; return np.zeros(len(rows))",
            "my-swarm 0.1.0: Pushed.read: expected to change no array that it reads, got a change",
        ),
        (
            "return {NEAREST: nearest_neighbours(self.world.positions, self.world.ground).mean(axis=1)}",
            "return {NEAREST: np.full(self.world.worlds, np.nan)}",
            "those of the measures, got distance to the nearest neighbour: float64 (4,) with NaN or infinity",
        ),
        (
            "vectors[rows] = 0.0",
            "vectors[rows] = np.nan",
            "my-swarm 0.1.0: KeepDistance.move_into: expected finite vectors",
        ),
        (
            TASK,
            "def bend(self, commands): commands.vectors[:] = np.nan",
            "KeepApart.bend: expected finite commands",
        ),
        (
            TASK,
            "def done(self): return np.zeros(4)",
            "KeepApart.done: expected an array of bool (4,), got float64",
        ),
        (TASK, "def after_moving(self): raise KeyError('lost')", "my_swarm/__init__.py:71: KeyError: 'lost'"),
        (TASK, "def done(self): __import__('sys').exit(0)", "my_swarm/__init__.py:71: SystemExit: 0"),
        (TASK, "def place(self, start): raise type('Own', (BaseException,), {})(7)", "__init__.py:71: Own: 7"),
        (
            "return {NEAREST: ",
            "return {'other': np.ones(4), NEAREST: ",
            "measures, got other: float64 (4,), distance",
        ),
    ],
)
def test_a_plugin_that_breaks_its_contract_is_one_line(installed, old, new, said):
    rewrite(installed, (FORMULA, PLAIN), (old, f"{TASK}    {new}\n" if old == TASK else new))
    code, _, err = run(commands.command, installed, "evaluate", "KeepApart", *ONE, "--scenarios", "4")
    assert (code, "Traceback" in err) == (2, False)
    assert said in err.splitlines()[-1]


@pytest.mark.parametrize(
    ("new", "said", "workers"),
    [
        ("return first + 99", "Second._select: expected options 0..", 1),
        ("raise SystemExit(0)", "__init__.py:54: SystemExit: 0", 2),
        (
            "decisions.context[:] = 0.0\n        return first",
            "__init__.py:54: ValueError: assignment destination is read",
            2,
        ),
    ],
)
def test_a_strategy_that_breaks_its_contract_is_one_line_from_a_worker_too(installed, new, said, workers):
    rewrite(installed, ("        others =", f"        {new}\n        others ="))
    words = ("--strategy", "Second", "--scenarios", "2", "--workers", workers)
    code, _, err = run(commands.command, installed, "evaluate", "table1", *words)
    assert code == 2
    assert said in err.splitlines()[-1]
    assert "Traceback" not in err


def test_a_plugin_that_only_a_worker_cannot_import_is_one_line(installed):
    head = "if __import__('multiprocessing').current_process().name.startswith('Spawn'):\n    raise SystemExit(0)\n"
    rewrite(installed, (FORMULA, PLAIN), ("\nNEAREST = ", f"\n{head}\nNEAREST = "))
    words = ("--strategy", "fixed", "--strategy", "Second", "--scenarios", "2", "--workers", "2")
    code, _, err = run(commands.command, installed, "evaluate", "parting", *words)
    assert (code, "Traceback" in err) == (2, False)
    assert "__init__.py:20: SystemExit: 0" in err.splitlines()[-1]


@pytest.mark.parametrize("name", ["a:b.py", ".", "..a", ""])
def test_what_can_be_no_plugin_is_one_line(name, tmp_path, monkeypatch):
    (tmp_path / "a:b.py").write_text("")
    monkeypatch.chdir(tmp_path)
    assert "expected a" in commands.refused("list", "families", "--import", name)


def test_a_working_directory_that_is_gone_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert "the working directory is gone" in commands.refused("list", "families")
    monkeypatch.chdir(tmp_path)


def test_a_plugin_that_broke_half_way_is_the_same_line_at_every_lookup(tmp_path, monkeypatch):
    def lines():
        said = []
        for _ in range(2):
            with pytest.raises(plugins.PluginError) as error:
                plugins.load()
            said.append(str(error.value))
        return said

    (tmp_path / "broken.py").write_text(KINDS + "\nraise RuntimeError('half way')\n")
    monkeypatch.setenv(plugins.NAMED, str(tmp_path / "broken.py"))
    first, second = apart(lines)
    assert first == second
    assert first.endswith("RuntimeError: half way")
