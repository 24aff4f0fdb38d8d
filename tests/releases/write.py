"""`python -m tests.releases.write`: writes the files of this release, which the tests of later releases read.

Run it once, before the release. It refuses if the release has its tag: then its files stay as they are.
"""

import contextlib
import json
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env import __version__, clean_swarm_v0
from clean_swarm_env.config.load import load_family, load_mission, with_changes
from selector.documents.find import SHIPPED, find_file
from selector.documents.reading import as_yaml
from selector.knowledge import load_knowledge
from selector.store import KnowledgeStore, RewardSums, contents
from selector.strategies.learned_file import save_strategy
from selector.strategies.policy_file import find_policy
from selector.strategies.registry import create
from selector.strategies.streams import row_keys
from tests.paths import ROOT
from tests.releases.environments import SEED, course, environments
from tests.releases.files import PROBLEM, READINGS, ROWS, STEPS
from tests.train.commands import run
from train.evaluation.repeat import record_run, task_of

HERE = Path(__file__).parent
SMALL = {"robots": {"count": 2}, "time_limit": 30.0, "task": {"garbage": {"count": 2}}}
FAMILY = {
    "name": "small",
    "description": "Three or four robots, with spots of garbage or without.",
    "mission": {
        "base": "exploring",
        "world": {"width": 8.0, "height": 8.0},
        "task": {"stations": {"recycling": [2.0, 4.0], "dump": [6.0, 4.0]}},
        "time_limit": 90.0,
    },
    "robots": [3, 4],
    "items": [2, 3],
    "spots": [0, 1],
}
STRATEGIES = ("fixed:RecentFinds", "policy:policy", "fsm:machine.yaml")
KEPT = ("manifest.json", "runs.jsonl", "runs.csv", "summary.json", "table.md")
"""Files of results; the picture is left out."""


def write(folder: Path) -> None:
    """Write the files of a release into an empty folder, the working directory."""
    whole = with_changes(load_mission("table1").model_dump(mode="json"), {**SMALL, "name": "small"})
    (folder / "mission.yaml").write_text(as_yaml(whole))
    (folder / "family.yaml").write_text(as_yaml(FAMILY))
    (folder / "family.yaml").write_text(as_yaml(load_family("family.yaml").model_dump(mode="json")))
    shutil.copy(find_file("machines", "finds-alone"), folder / "machine.yaml")
    shutil.copytree(find_policy("exploring-ppo"), folder / "policy", ignore=shutil.ignore_patterns("*.md"))
    write_strategy(folder / "strategy.safetensors")
    write_scores(folder)
    write_state(folder)
    write_results(folder)
    with tarfile.open(folder / "shipped.tar.xz", "w:xz") as archive:
        for path in sorted(SHIPPED.glob("*/*.yaml")):
            archive.add(path, path.relative_to(SHIPPED).as_posix())


def write_strategy(path: Path) -> None:
    """Write a bandit that has learned which of two options is better by the context."""
    strategy = create("LinUCB", PROBLEM, row_keys(np.random.SeedSequence(SEED), ROWS), groups=np.zeros(ROWS, np.int64))
    rng = np.random.default_rng(SEED)
    for _ in range(STEPS):
        seen = rng.normal(size=(ROWS, len(PROBLEM.features)))
        chosen = strategy.select(seen)
        strategy.update(chosen, np.where(chosen == 2, 0.0, seen[np.arange(ROWS), chosen % 2]), seen)
    save_strategy(path, strategy)


def write_scores(folder: Path) -> None:
    """Write a store with expert knowledge and rewards, and the same store exported."""
    kept = KnowledgeStore(folder / "scores.sqlite")
    knowledge = load_knowledge("cleaning")
    kept.introduce(knowledge)
    sums = RewardSums(PROBLEM.goal, [option.name for option in knowledge.options(PROBLEM.goal)])
    sums.record(np.array([0, 1, 1]), np.array([0.5, 1.0, 2.0]))
    kept.add(sums, source="run", context="crowded")
    (folder / "scores.json").write_text(contents.document_text(kept.contents(), as_json=True))


def write_state(folder: Path) -> None:
    """Write the state of a mission after some steps, and how the mission goes on."""
    env = clean_swarm_v0.parallel_env(str(folder / "mission.yaml"))
    course(env, STEPS)
    (folder / "state.bin").write_bytes(env.get_state())
    (folder / "state.txt").write_text(course(env, STEPS, reset=False) + "\n")


def write_results(folder: Path) -> None:
    """Write the results of an evaluation, and the recording of one of its runs."""
    words = [word for strategy in STRATEGIES for word in ("--strategy", strategy)]
    words += ["--goal", "ExplorationPatrol", "--scenarios", "2", "--seed", str(SEED), "--workers", "1"]
    code = run("evaluate", "family.yaml", *words, "--output", "all")
    assert code == 0
    (folder / "results").mkdir()
    for name in KEPT:
        shutil.copy(folder / "all" / name, folder / "results" / name)
    shutil.rmtree(folder / "all")
    record_run(task_of(Path("results")), folder / "mission.swarm", minds=True)


def as_text(content: Mapping[str, Any]) -> str:
    """Return plain data as JSON, a key in a line."""
    return "{\n" + ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items()) + "\n}\n"


def main() -> int:
    """Write the folder of this release anew; return 1 if it was released."""
    tag, target = f"v{__version__}", HERE / __version__
    if subprocess.run(["git", "tag", "-l", tag], cwd=ROOT, capture_output=True, text=True, check=True).stdout:
        print(f"{target}: {tag} was released, its files stay as they are", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        with contextlib.chdir(folder):
            write(folder)
            said = {file: read(Path(file)) for file, read in READINGS.items()}
        (folder / "expected.json").write_text(as_text(said))
        (folder / "environments.json").write_text(as_text(environments()))
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(folder, target)
    size = sum(path.stat().st_size for path in target.rglob("*") if path.is_file())
    print(f"{target}: {size:,} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
