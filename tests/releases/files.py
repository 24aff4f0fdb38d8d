"""What the files of a release say as today's code reads them; every later release has to read the same."""

import tarfile
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.find import find_file
from selector.documents.reading import read_mapping
from selector.documents.writing import write_whole
from selector.store import KnowledgeStore, StoredKnowledge, contents
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.machine_file import load_machine
from selector.strategies.policy_file import Network, load_policy
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from tests.attacks.readers import READERS
from tests.releases.environments import SEED, course, digest
from train.learning.config import TrainingConfig
from train.reports.results import results_in

ROWS, STEPS = 12, 10
PROBLEM = Problem(
    "AvoidCollision", ("Off", "ORCA", "RepulsionGradient-view0.5"), np.array([1.0, 2.0, 1.5]), ("near", "far")
)
"""What the strategy in the folder of a release decides."""


def mission(path: Path) -> str:
    """Return how the mission in a file begins."""
    return course(clean_swarm_v0.parallel_env(str(path)), STEPS)


def family(path: Path) -> list[str]:
    """Return the starts of scenarios of each split of a family."""
    held = load_family(str(path))
    drawn = [held.scenario(SEED, index, split) for split in ("train", "test") for index in range(3)]
    return [f"{one.seed} {digest(repr((one.start.robots, one.start.items)))}" for one in drawn]


def machine(path: Path) -> dict[str, Any]:
    """Return the states of a machine: option, and where its ways lead."""
    held = load_machine(str(path))
    states = {name: [one.option, *(way.to for way in one.transitions)] for name, one in held.states.items()}
    return {"goal": held.goal, "terms": list(held.terms), "start": held.start, "states": states}


def policy(path: Path) -> dict[str, Any]:
    """Return which options a policy takes for observations that are drawn at random."""
    held = load_policy(path)
    seen = np.random.default_rng(SEED).uniform(-1.0, 1.0, (ROWS, len(held.spec.observations)))
    scores = Network(held).heads(seen)["options"]
    parts = np.split(scores, np.cumsum([len(options) for options in held.spec.goals.values()])[:-1], axis=1)
    chosen = zip(held.spec.goals.items(), parts, strict=True)
    return {goal: [options[best] for best in part.argmax(axis=1)] for (goal, options), part in chosen}


def strategy(path: Path) -> list[int]:
    """Return which options a learned strategy takes."""
    keys, together = row_keys(np.random.SeedSequence(SEED), ROWS), np.zeros(ROWS, dtype=np.int64)
    held = description_of(path).spec.build(PROBLEM, keys, together)
    load_strategy(path, held)
    return held.select(np.random.default_rng(SEED).normal(size=(ROWS, len(PROBLEM.features)))).tolist()


def scores(path: Path) -> list[str]:
    """Return the rewards in an exported store."""
    return _rewards(contents.read(path))


def store(path: Path) -> list[str]:
    """Return the rewards in a store, of which a copy is opened."""
    with tempfile.TemporaryDirectory() as folder:
        write_whole(Path(folder) / path.name, path.read_bytes())
        kept = KnowledgeStore(Path(folder) / path.name, create=False)
        return _rewards(kept.contents())


def recording(path: Path) -> dict[str, Any]:
    """Return the figures of a recorded mission, and the digest of each channel."""
    held = RecordedMission(path)
    result = held.result or {}
    figures = {key: result[key] for key in ("duration_s", "completed", "cost_s", "garbage_done")}
    return figures | {name: digest(held.whole(name).tobytes()) for name in held.channels}


def results(path: Path) -> dict[str, list[Any]]:
    """Return the figures of the runs in a folder of results."""
    return {
        f"{one.scenario}, {one.condition}": [one.result.duration_s, one.result.completed, one.result.cost_s]
        for one in results_in(path).records
    }


def shipped(path: Path) -> dict[str, int]:
    """Read all documents that shipped with a release; return how many there are of each kind."""
    found: dict[str, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(path) as archive:
            archive.extractall(folder, filter="data")
        for file in sorted(Path(folder).glob("*/*.yaml")):
            kind = file.parent.name
            SHIPPED_READERS[kind](find_file(kind, str(file)))
            found[kind] = found.get(kind, 0) + 1
    return found


def _rewards(held: StoredKnowledge) -> list[str]:
    told = [f"{goal}, {name}: {one.score}" for (goal, name), one in held.expert.items()]
    return sorted(told + [f"{'/'.join(key)}: {one.moments}" for key, one in held.learned.items()])


SHIPPED_READERS = READERS | {
    "starts": lambda path: [StartConfiguration.model_validate(one) for one in read_mapping(path)["starts"]],
    "training": lambda path: TrainingConfig.model_validate(read_mapping(path)),
}
READINGS: dict[str, Callable[[Path], Any]] = {
    "mission.yaml": mission,
    "family.yaml": family,
    "machine.yaml": machine,
    "policy": policy,
    "strategy.safetensors": strategy,
    "scores.json": scores,
    "scores.sqlite": store,
    "mission.swarm": recording,
    "results": results,
    "shipped.tar.xz": shipped,
}
"""Name in the folder of a release -> what it says, as plain data."""
