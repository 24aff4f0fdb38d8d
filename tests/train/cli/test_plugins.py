"""Plug-ins: installed packages, and modules that a command line names, in commands, files and worker processes."""

import json
import os
import shutil
import subprocess
import sys
import zipfile

import pytest

from selforg.plugins import NAMED
from tests.paths import ROOT

TEMPLATE = ROOT / "examples" / "plugin"


@pytest.fixture
def site(tmp_path):
    """A folder of packages with the template, which is not installed yet."""
    shutil.copytree(TEMPLATE / "my_swarm", tmp_path / "site" / "my_swarm")
    return tmp_path / "site"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    pytest.importorskip("hatchling")
    source, built = tmp_path_factory.mktemp("source") / "plugin", tmp_path_factory.mktemp("wheel")
    shutil.copytree(TEMPLATE, source)
    options = ["--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--wheel-dir", str(built)]
    subprocess.run([sys.executable, "-m", "pip", "wheel", *options, str(source)], check=True, capture_output=True)
    return next(built.glob("*.whl"))


@pytest.fixture
def installed(tmp_path, wheel):
    """A folder of packages with the wheel of the template."""
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    return tmp_path / "site"


def run(site, *words, start=("-m", "clean_swarm_env")):
    environment = {name: value for name, value in os.environ.items() if name != "CLEAN_SWARM_IMPORT"}
    environment["PYTHONPATH"] = os.pathsep.join((str(ROOT), str(site)))
    command = [sys.executable, *start, *words]
    return subprocess.run(command, cwd=site.parent, capture_output=True, text=True, check=False, env=environment)


def refused(done):
    """Return the one line of a command that was refused."""
    assert done.returncode == 2, done.stdout + done.stderr
    (line,) = done.stderr.strip().splitlines()
    return line


def test_an_installed_plugin_is_known_to_commands_and_their_workers(installed):
    done = run(installed, "run", "KeepApart", "--runs", "3", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["option"] == "KeepDistance"
    compared = ("--strategy", "fixed:KeepDistance", "--strategy", "Second", "--scenarios", "2", "--workers", "2")
    done = run(installed, "evaluate", "--family", "parting", *compared, "--output", "r")
    assert done.returncode == 0, done.stderr
    table = (installed.parent / "r" / "table.md").read_text()
    assert "Second" in table
    assert "KeepDistance" in table


def test_the_list_says_where_names_come_from(installed):
    names = {
        "mechanism-classes": "KeepDistance", "families": "parting", "tasks": "KeepApart", "sensor-classes": "Pushed",
        "strategy-classes": "Second",
    }  # fmt: skip
    for kind, name in names.items():
        (line,) = [line for line in run(installed, "list", kind).stdout.splitlines() if line.startswith(f"{name} ")]
        assert line.endswith("(from my-swarm 0.1.0)")


def test_ppo_learns_on_the_family_of_an_installed_plugin(installed):
    pytest.importorskip("stable_baselines3")
    (installed.parent / "training").mkdir()
    (installed.parent / "training" / "mine.yaml").write_text(
        "{name: mine, description: Few., tasks: [{family: parting, worlds: 2}], goal: KeepApart, checkpoints: 1, "
        "decisions: 200, validation: {scenarios: 2}, ppo: {minibatch: 64}}"
    )
    done = run(installed, "train", "ppo", "--config", "mine", "--configs", ".", "--output", "r")
    assert done.returncode == 0, done.stderr
    assert (installed.parent / "r" / "policy" / "policy.json").is_file()


def test_a_plugin_that_is_only_named_is_known_as_well_and_not_without(site):
    assert "unknown task 'KeepApart'" in refused(run(site, "run", "KeepApart"))
    words = ("--strategy", "my_swarm:Second", "--strategy", "fixed", "--scenarios", "2", "--workers", "2")
    done = run(site, "evaluate", "--family", "my_swarm:KeepApart", *words, "--output", "r")
    assert done.returncode == 0, done.stderr
    assert "my_swarm:Second" in (site.parent / "r" / "table.md").read_text()


def test_a_file_names_a_class_only_of_a_module_that_the_command_names(site):
    mission = "{task: 'my_swarm:KeepApart', time_limit: 10.0}"
    (site.parent / "own.yaml").write_text(
        f"name: own\ndescription: Few.\nmission: {mission}\nrobots: [3, 3]\nitems: [0, 0]\n"
    )
    words = ("evaluate", "--family", "own.yaml", "--strategy", "fixed", "--scenarios", "1", "--output", "r")
    line = refused(run(site, *words))
    assert "own.yaml: mission: task: " in line
    assert "only a file asks to import my_swarm:KeepApart; --import my_swarm (imports= in Python) allows it" in line
    done = run(site, *words, "--import", "my_swarm")
    assert done.returncode == 0, done.stderr


def test_names_have_their_origin(installed):
    code = "import json; from selector.documents.find import plugin_names; print(json.dumps(plugin_names()))"
    origin = "my-swarm 0.1.0"
    assert json.loads(run(installed, start=("-c", code)).stdout) == {
        "mechanism": {"KeepDistance": origin},
        "sensor": {"Pushed": origin},
        "strategy": {"Second": origin},
        "task": {"KeepApart": origin},
        "mechanisms": {"KeepDistance": origin},
        "knowledge": {"my_swarm": origin},
        "families": {"parting": origin},
    }


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
    words = ("evaluate", "--family", "kinds", "--configs", ".", "--strategy", "fixed", "--strategy", "MaxScore")
    words = (*words, "--scenarios", "2", "--workers", "2", "--output", "r")
    assert "unknown activator 'Low' (known: Boolean, " in refused(run(site, *words))
    done = run(site, *words, "--import", "kinds.py")
    assert done.returncode == 0, done.stderr
    for kind, name in {"action-classes": "North", "activator-classes": "Low", "terms": "east"}.items():
        (line,) = [line for line in run(site, "list", kind, "--import", "kinds.py").stdout.splitlines() if name in line]
        assert line.endswith(f"(from {kinds / 'kinds.py'})")
    code = """
from clean_swarm_env import Batch
batch = Batch(observation={"terms": ["cargo", "east"]}, reward={"cost": 0.0, NAME: 2.0}, imports=["kinds.py"])
batch.reset([1])
step = batch.step([0] * batch.rows)
north = batch.worlds.physics.positions[:, 1]
print(batch.observer.names, (step.rewards * 5.5).round(6).tolist() == north.round(6).tolist())
"""
    for name in ('"northward"', '"kinds.py:northward"'):
        done = run(site, start=("-c", code.replace("NAME", name)))
        assert done.stdout.split(") ")[-1].strip() == "True", done.stderr


def test_ppo_learns_with_terms_of_a_plugin(installed, kinds):
    pytest.importorskip("stable_baselines3")
    words = ("train", "ppo", "--config", "kinds", "--configs", ".", "--output", "r")
    assert "northward: unknown key 'northward'" in refused(run(installed, *words))
    done = run(installed, *words, "--import", "kinds.py")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ("a = no_such_swarm", "no_such_swarm: No module named 'no_such_swarm'"),
        ("a = my_swarm:Nothing", "my_swarm: AttributeError: module 'my_swarm' has no attribute 'Nothing'"),
        ("a = my_swarm\nb = my_swarm:KeepApart", ""),
    ],
)
def test_entry_points_that_lead_nowhere_are_one_line_and_two_to_one_module_are_one_plugin(installed, entries, said):
    (path,) = installed.glob("*.dist-info/entry_points.txt")
    path.write_text(f"[clean_swarm]\n{entries}\n")
    done = run(installed, "run", "KeepApart", "--runs", "2")
    assert said in refused(done) if said else done.returncode == 0


def test_a_package_that_brings_names_of_another_is_one_line(installed):
    other = installed / "other_swarm-1.dist-info"
    other.mkdir()
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: other-swarm\nVersion: 1\n")
    (other / "entry_points.txt").write_text("[clean_swarm]\nother = other_swarm\n")
    shutil.copytree(installed / "my_swarm", installed / "other_swarm")
    line = refused(run(installed, "run", "KeepApart"))
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
    ],
)
def test_a_plugin_that_cannot_be_imported_is_one_line_once_it_is_needed(installed, code, said):
    (installed / "my_swarm" / "__init__.py").write_text(code)
    assert run(installed, "--help").returncode == 0
    assert said in refused(run(installed, "run", "KeepApart"))
    assert said in refused(run(installed, "run", "Foraging", "--import", "my_swarm"))


def test_a_file_of_a_plugin_has_a_name_of_its_own(installed):
    (installed / "my_swarm" / "families" / "crowded.yaml").write_text("name: crowded\n")
    line = refused(run(installed, "evaluate", "--family", "parting", "--strategy", "fixed"))
    assert "my-swarm 0.1.0: " in line
    assert "families/crowded.yaml: the family 'crowded' exists already: " in line


def test_words_that_are_no_plugin_are_one_line(site):
    assert "no_swarm: No module named 'no_swarm'" in refused(run(site, "list", "--import=no_swarm"))
    assert "--import: expected a module, or a file of Python code" in refused(run(site, "list", "--import"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "return np.hypot(*self.source.vectors[rows].T) > self.speed",
            "return np.full(len(rows), np.nan)",
            "my-swarm 0.1.0: Pushed.read: expected finite numbers (24,), got float64 (24,) with NaN or infinity",
        ),
        (
            "return np.hypot(*self.source.vectors[rows].T) > self.speed",
            "return np.zeros(3)",
            "my-swarm 0.1.0: Pushed.read: expected finite numbers (24,), got float64 (3,)",
        ),
        (
            "return np.hypot(*self.source.vectors[rows].T) > self.speed",
            "rows[:] = 0; return np.zeros(len(rows))",
            "my-swarm 0.1.0: Pushed.read: expected to change no array that it reads, got a change",
        ),
        (
            "return {NEAREST: nearest_neighbours(self.world.positions, self.world.ground).mean(axis=1)}",
            "return {NEAREST: np.full(self.world.worlds, np.nan)}",
            "task KeepApart: result: distance to the nearest neighbour: expected",
        ),
        (
            "class KeepDistance(FormulaMechanism):",
            "class KeepDistance(__import__('selforg.mechanisms').mechanisms.MovementMechanism):\n"
            "    def move_into(self, now, rows, vectors, active):\n        vectors[rows] = np.nan\n",
            "my-swarm 0.1.0: KeepDistance.move_into: expected finite numbers (24, 2), got float64 (24, 2) with NaN",
        ),
    ],
)
def test_a_plugin_that_breaks_its_contract_is_one_line(installed, old, new, said):
    code = (installed / "my_swarm" / "__init__.py").read_text()
    assert old in code
    (installed / "my_swarm" / "__init__.py").write_text(code.replace(old, new))
    assert said in refused(run(installed, "run", "KeepApart", "--runs", "4"))


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ("return first + 9", "Second._select: expected options 0..1, got 9..9"),
        (
            "decisions.context[:] = 0.0\n        return first",
            "__init__.py:54: ValueError: assignment destination is read",
        ),
    ],
)
def test_a_strategy_that_breaks_its_contract_is_one_line_from_a_worker_too(installed, new, said):
    path = installed / "my_swarm" / "__init__.py"
    head, _, rest = path.read_text().partition("        others = decisions.allowed")
    path.write_text(f"{head}        {new}\n\n\n@TASKS.register{rest.partition('@TASKS.register')[2]}")
    words = ("--strategy", "Second", "--scenarios", "2", "--workers", "2", "--output", "r")
    done = run(installed, "evaluate", "--family", "parting", *words)
    assert done.returncode == 2
    assert said in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr


def test_a_plugin_that_broke_half_way_is_the_same_line_at_every_lookup(tmp_path):
    broken = tmp_path / "broken.py"
    broken.write_text(KINDS + "\nraise RuntimeError('half way')\n")
    code = """
from selforg import plugins
for _ in range(2):
    try:
        plugins.load()
    except plugins.PluginError as error:
        print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, NAMED: str(broken)}, capture_output=True, text=True
    )
    first, second = done.stdout.splitlines()
    assert first == second
    assert first.endswith("RuntimeError: half way")
