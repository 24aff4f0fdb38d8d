"""The missions of a comparison: excess and end of each, kept in one small file so that tables can be judged again.

A line of the file is one strategy on all test scenarios of a family. Lines that are there are kept.
"""

import json
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from types import MappingProxyType

from clean_swarm_env.config.families import FamilyConfig, Scenario, scenario_name
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.named import FIXED, MACHINE, POLICY
from clean_swarm_env.world.task import task_class
from docs.comparison.manifest import OFF, TOLD, Manifest, Taught, Trained
from docs.comparison.running import run, written
from docs.figures.stored import ROOT
from selector.documents.find import load_file
from selector.documents.writing import write_whole
from train.learning.config import TrainingConfig
from train.running.trial_task import TrialTask

SEASON = "true_season"
"""Term that tells a team the season, which no robot can know."""


@dataclass(frozen=True)
class Judged:
    """The missions of one strategy on a family."""

    family: str
    strategy: str
    """Label of the strategy."""
    of: str
    """The strategy as `--strategy` takes it; those of the kinds of scenarios of a told team."""
    seed: int
    """Seed of the scenarios."""
    excess_s: list[float]
    """(K,) excess of each scenario, in order [s]."""
    unfinished: list[int] | None
    """Numbers of the scenarios that were not completed; None where garbage keeps coming."""
    cpu_s: float
    """CPU time of the missions [s]."""
    training_cpu_s: float = 0.0
    """CPU time of its own training, without that from which it starts [s]."""


Missions = dict[tuple[str, str], Judged]
"""Family and label -> missions."""


def read_missions(file: Path, manifest: Manifest) -> Missions:
    """Return family and label -> missions of a file; nothing if there is none.

    Raises:
        ConfigurationError: the file has missions of other seeds or numbers of scenarios than the manifest.

    """
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    found = {(one.family, one.strategy): one for one in (Judged(**json.loads(line)) for line in lines)}
    for (family, label), one in found.items():
        compared = manifest.families.get(family)
        asked = None if compared is None else (manifest.seed, compared.scenarios)
        if (one.seed, len(one.excess_s)) != asked:
            told = f"expected seed and scenarios of the manifest, {asked}, got {(one.seed, len(one.excess_s))}"
            raise ConfigurationError(f"{file}: {label} on {family}: {told}")
    return found


def do_missions(
    manifest: Manifest, file: Path, known: Mapping[tuple[str, str], Judged] = MappingProxyType({})
) -> Missions:
    """Do the missions that the file lacks and that are not `known`; return all.

    At last come those of the first training of each learner, of the second, ...
    """
    found = {**known, **read_missions(file, manifest)}
    asked = [(family, label) for family in manifest.families for label in manifest.run_on(family)]
    for family, label in sorted(asked, key=lambda each: _turn(manifest, each[1])):
        if (family, label) not in found:
            begun = 1 + sum(each in found for each in asked)
            print(f"{begun} of {len(asked)}: {label} on {family}", file=sys.stderr)
            found[family, label] = _judged(manifest, family, label)
            lines = [json.dumps(asdict(found[each])) for each in asked if each in found]
            write_whole(file, ("\n".join(lines) + "\n").encode())
    return found


def _turn(manifest: Manifest, label: str) -> int:
    """Return when the missions of a label are done: which training of its learner it is, from 1; 0 for others."""
    if label not in manifest.trainings:
        return 0
    learner, seed = manifest.trainings[label]
    return 1 + manifest.trained[learner].seeds.index(seed)


def _judged(manifest: Manifest, family: str, label: str) -> Judged:
    """Do the missions of a strategy on a family, in one process."""
    compared, own_training = manifest.families[family], manifest.trainings.get(label)
    training_s = 0.0 if own_training is None else trained(manifest, *own_training)
    given, began = family_of(family, compared), time.process_time()
    drawn = [given.scenario_named(manifest.seed, scenario_name("test", k)) for k in range(compared.scenarios)]
    members = _members(manifest, family, label, drawn)
    excesses, unfinished = [0.0] * len(drawn), list[int]()
    for member in dict.fromkeys(members):
        own = [k for k, other in enumerate(members) if other == member]
        scenarios, goal = tuple(drawn[k] for k in own), compared.goal or manifest.goal
        parts = TrialTask(given.name, manifest.seed, scenarios, label, member, goal).parts()
        for k, record in zip(own, chain(*(part.run() for part in parts)), strict=True):
            excesses[k] = round(record.result.excess_s, 4)
            unfinished += [] if record.result.completed else [k]
    ends = not items_keep_coming(drawn[0].mission)
    used = round(time.process_time() - began, 1)
    of = _identity(manifest, label, members)
    return Judged(family, label, of, manifest.seed, excesses, sorted(unfinished) if ends else None, used, training_s)


def _identity(manifest: Manifest, label: str, members: list[str]) -> str:
    """Return what was judged, without paths of this machine."""
    if label in manifest.trainings:
        learner, seed = manifest.trainings[label]
        return f"training {manifest.trained[learner].training}, seed {seed}"
    return TOLD if members[0].startswith(MACHINE) and label == TOLD else " ".join(sorted(set(members)))


def family_of(name: str, compared: Taught) -> FamilyConfig:
    """Return a family, with the season in its observations where a team is told it."""
    file = str(Path(__file__).with_name("families") / compared.file) if compared.file else name
    family = load_family(file)
    terms = (*family.mission.terms, *((SEASON,) if compared.told_by else ()))
    return family.model_copy(update={"mission": family.mission.model_copy(update={"terms": terms})})


def _members(manifest: Manifest, family: str, label: str, scenarios: list[Scenario]) -> list[str]:
    """Return what decides in each scenario."""
    compared = manifest.families[family]
    if label == TOLD and compared.told:
        return [f"{FIXED}:{compared.told[kind]}" for kind in scenario_kinds(scenarios)]
    known = {
        **manifest.strategies,
        **{run: f"{POLICY}:{output_of(manifest, *own) / 'policy'}" for run, own in manifest.trainings.items()},
        OFF: f"{FIXED}:{compared.off}",
    }
    if label == TOLD:
        known[TOLD] = f"{MACHINE}:{_told_machine(manifest, family, compared.told_by)}"
    return [known.get(label, label)] * len(scenarios)


def scenario_kinds(scenarios: Sequence[Scenario]) -> list[str]:
    """Return the kind (K,) of each scenario: its numbers of spots and of stations, and what collisions do."""
    missions = [scenario.mission for scenario in scenarios]
    return [task_class(mission).kind_of(mission) for mission in missions]


def _told_machine(manifest: Manifest, family: str, told: Mapping[str, str]) -> Path:
    """Write the machine of a team that is told; return its file."""
    ways = [{"to": case, "when": case, "above": 0.5} for case in told]
    states = {case: {"option": options, "transitions": ways} for case, options in told.items()}
    machine = {"goal": manifest.families[family].goal or manifest.goal, "start": next(iter(told)), "states": states}
    return written(ROOT / "results" / manifest.name / f"told-{family}.yaml", machine)


def output_of(manifest: Manifest, learner: str, seed: int) -> Path:
    """Return the directory of a training."""
    return ROOT / "results" / manifest.name / f"{learner}-{seed}"


def trained(manifest: Manifest, learner: str, seed: int) -> float:
    """Do a training unless it is done, and first that from which it starts; return its own CPU time [s]."""
    output, asked = output_of(manifest, learner, seed), manifest.trained[learner]
    used = output.with_suffix(".cpu_s")
    if not used.exists():
        if asked.start is not None:
            trained(manifest, asked.start, seed)
        write_whole(used, f"{_train(manifest, asked, seed, output):.1f}\n".encode())
    return float(used.read_text(encoding="utf-8"))


def _train(manifest: Manifest, asked: Trained, seed: int, output: Path) -> float:
    """Do a training, or go on with it; return its CPU time [s]."""
    config = load_file("training", asked.training, TrainingConfig)
    if asked.imitation is None and asked.start is None and asked.critic == "own":
        place = output.relative_to(ROOT)  # policies name their command
        return run("train", config.learner, "--config", asked.training, "--seed", seed, "--output", place, "--resume")
    from docs.comparison import imitation, learners  # import torch

    began = time.process_time()
    if asked.imitation is not None:
        imitation.imitate(manifest, asked.imitation, config, seed, output)
    else:
        start = output_of(manifest, asked.start, seed) / "policy" if asked.start else None
        learners.learn(asked.training, seed, output, start=start, critic=asked.critic)
    return time.process_time() - began
