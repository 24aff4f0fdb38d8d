"""Each example runs where its framework is installed, and its model is compared by `clean-swarm evaluate`."""

import ast
import os
import signal
import subprocess
import sys
import urllib.request
from importlib import import_module
from importlib.util import find_spec

import pytest

from tests.examples.frameworks import ENVIRONMENTS, EXAMPLES
from tests.pages import blocks
from tests.paths import ROOT

pytestmark = pytest.mark.example
ALONE = {"conflicts.py", "own_task.py", "read_recording.py", "robot_policy.py", "tiring.py"}
"""Examples without a framework, which other tests try."""
OURS = ("selforg", "selector", "clean_swarm_env", "train")
FILES = sorted(path.name for path in (ROOT / "examples").glob("*.py"))


def run(directory, *arguments):
    """Run Python in a directory with one thread; return what it printed."""
    own = {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=directory, env=os.environ | own, capture_output=True, text=True, timeout=1800
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: " ".join(example.command.split()[:2]))
def test_an_example_runs_and_its_model_is_evaluated(example, tmp_path):
    for package in (example.needs, "torch"):
        if find_spec(package) is None:
            pytest.skip(f"needs {package}: make examples")
    if example.before:
        run(tmp_path, "-m", "clean_swarm_env", *example.before.split())
    file, *arguments = example.command.split()
    assert run(tmp_path, str(ROOT / "examples" / file), *arguments)
    if example.strategy:
        compared = ["--strategy", "fixed:RepulsionGradient-view0.5", "--strategy", example.strategy]
        settings = ["table1-starts", "--scenarios", "1", "--workers", "1", "--output", "out"]
        assert example.strategy in run(tmp_path, "-m", "clean_swarm_env", "evaluate", *settings, *compared)


def test_every_example_has_a_run():
    assert sorted({example.command.split()[0] for example in EXAMPLES} | ALONE) == FILES


@pytest.mark.parametrize("name", FILES)
def test_an_example_imports_what_there_is(name):
    for node in ast.walk(ast.parse((ROOT / "examples" / name).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith(OURS):
            if node.module == "clean_swarm_env.sb3":
                pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")
            module = import_module(node.module)
            for alias in node.names:
                assert hasattr(module, alias.name) or find_spec(f"{node.module}.{alias.name}"), alias.name


def test_the_head_of_an_example_installs_the_versions_that_ran():
    for name in sorted({*FILES} - ALONE):
        head = (ROOT / "examples" / name).read_text(encoding="utf-8").split('"""')[1]
        (line,) = [line for line in head.splitlines() if line.startswith("pip install -c constraints.txt ")]
        versions = {word for word in line.replace("'", "").split() if "==" in word}
        assert versions or name == "ppo_one_file.py"
        assert any(versions <= {*packages} for _, *packages in ENVIRONMENTS.values()), (name, versions)


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.filterwarnings("ignore")
def test_supersuit_trains_by_copies_in_two_processes():
    """As PettingZoo's tutorial of Stable-Baselines3 does: copies by cloudpickle, robots as environments."""
    supersuit = pytest.importorskip("supersuit", reason="needs supersuit: make examples")
    stable_baselines3 = pytest.importorskip("stable_baselines3", reason="needs stable_baselines3: make examples")
    from clean_swarm_env import clean_swarm_v0

    for settings in ({}, {"goal": "Foraging"}):
        env = supersuit.pettingzoo_env_to_vec_env_v1(clean_swarm_v0.parallel_env(**settings))
        envs = supersuit.concat_vec_envs_v1(env, 2, num_cpus=2, base_class="stable_baselines3")
        stable_baselines3.PPO("MlpPolicy", envs, n_steps=16, batch_size=80, n_epochs=1, device="cpu").learn(160)
        envs.close()


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.filterwarnings("ignore")
def test_the_notebook_runs(tmp_path):
    nbclient = pytest.importorskip("nbclient", reason="needs nbclient: make examples")
    pytest.importorskip("ipykernel", reason="needs ipykernel: make examples")
    import nbformat

    notebook = nbformat.read(ROOT / "examples" / "first_steps.ipynb", as_version=4)
    client = nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}})
    client.execute(env=os.environ | {"PYTHONPATH": str(ROOT)})
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any("image/png" in output.get("data", {}) for output in shown)
    assert not [output for output in shown if output["output_type"] == "error"]


@pytest.fixture
def with_plugin(tmp_path):
    """Python of a fresh environment in which the wheel of the plug-in is installed; nothing comes from the network."""
    pytest.importorskip("hatchling", reason="needs hatchling: make examples")
    alone = ("--no-index", "--no-deps", "--quiet")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "env"], check=True)
    (packages,) = (tmp_path / "env").glob("lib/python*/site-packages")
    beside = [path for path in sys.path if path.endswith("site-packages")]  # NumPy and the others
    (packages / "beside.pth").write_text("\n".join((str(ROOT), *beside)))
    pip = [sys.executable, "-m", "pip"]
    wheel = [*alone, "--no-build-isolation", "--wheel-dir", str(tmp_path / "wheel"), str(ROOT / "examples" / "plugin")]
    subprocess.run([*pip, "wheel", *wheel], check=True, capture_output=True)
    python = tmp_path / "env" / "bin" / "python"
    (built,) = (tmp_path / "wheel").glob("*.whl")
    subprocess.run([*pip, "--python", python, "install", *alone, built], check=True, capture_output=True)
    return python


@pytest.mark.long
@pytest.mark.extra
def test_a_plugin_works_as_a_wheel_in_a_fresh_environment(with_plugin, tmp_path):
    lines = blocks("docs/own_plugins.md", "sh")[0].commands()[1:]
    start = [with_plugin, "-m", "clean_swarm_env"]
    own = os.environ | {"OMP_NUM_THREADS": "1"}
    own.pop("PYTHONPATH", None)
    said = ["Pushed ", "KeepApart", "Second", ""]
    (tmp_path / "my" / "training").mkdir(parents=True)
    (tmp_path / "my" / "training" / "parting.yaml").write_text(blocks("docs/own_plugins.md", "yaml")[0].text)
    if find_spec("stable_baselines3"):
        lines[-1:-1] = [["clean-swarm", "train", "ppo", "--config", "parting", "--configs", "my"]]
        said[-1:-1] = ["parting"]
    for line, expected in zip(lines[:-1], said[:-1], strict=True):
        words = ["2" if word == "10" else word for word in line[1:]]
        done = subprocess.run([*start, *words], cwd=tmp_path, env=own, capture_output=True, text=True, timeout=1800)
        assert done.returncode == 0, done.stderr
        assert expected in done.stdout
    assert lines[-1] == ["clean-swarm", "play", "KeepApart"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen([*start, "play", "KeepApart", "--no-browser"], cwd=tmp_path, env=own, **pipes) as playing:
        address = playing.stdout.readline().strip()
        assert b"<html" in urllib.request.urlopen(address).read()
        playing.send_signal(signal.SIGINT)
        assert "clean-swarm play results" in playing.stdout.read()
