"""The trainings and evaluations of a comparison. What its directory holds already is kept."""

import json
import resource
import subprocess
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs.comparison.manifest import Ablations, Compared, Configured, Learner, Manifest, Pairs
from docs.figures.update_results import CLEAN_SWARM, ROOT
from selector.documents.find import load_file
from selector.documents.reading import as_yaml, read_mapping
from selector.documents.writing import write_whole
from selector.knowledge import load_knowledge
from train.deciders.named import FIXED, MACHINE, POLICY
from train.evaluation.look_ahead import LOOKING
from train.learning.config import TrainingConfig
from train.running.finished_runs import JOURNAL, natural_order, runs_of

OWN_NAME = "Configured"
"""Name of the option that is configured."""
CONFIGURED = f"{FIXED}:{OWN_NAME}"
CPU_TIMES = "cpu_s.json"
COPIES, HOLD, HORIZON = 3, 15.0, 180.0
"""How teams look ahead: copies for each option, seconds to hold one, and seconds to look at."""


def make(manifest: Manifest, folder: Path) -> None:
    """Do what is missing in the directory of the results."""
    folder.mkdir(parents=True, exist_ok=True)
    strategies = ["fixed", *manifest.unlearned]
    for label, learner in manifest.learners.items():
        strategies.append(f"{label}={_trained(folder, label, learner)}")
    if manifest.ablations is not None:
        for label, learner in _ablated(folder, manifest, manifest.ablations).items():
            strategies.append(f"{label}={_trained(folder, label, learner)}")
    words = [word for strategy in strategies for word in ("--strategy", strategy)]
    if manifest.configured is not None:
        words += ["--knowledge", _with_configured(folder, manifest, manifest.configured)]
    for family, compared in manifest.families.items():
        asked = ("--goal", manifest.goal, *words, "--scenarios", compared.scenarios, "--seed", 1)
        run("evaluate", "--family", family, *asked, "--output", folder / family, "--resume")
        if compared.looked_ahead:
            _look_ahead(folder, manifest, family, compared)
    if manifest.pairs is not None:
        _pair(folder, manifest, manifest.pairs)


def looked_ahead_file(folder: Path, family: str) -> Path:
    """Return the file with what looking ahead cost on a family."""
    return folder / f"look-ahead-{family}.json"


def pair_folder(folder: Path, family: str, option: str, seed: int) -> Path:
    """Return the directory of the runs in which an option of the other goal serves."""
    return folder / f"{family}-{option}-{seed}"


def _pair(folder: Path, manifest: Manifest, pairs: Pairs) -> None:
    """Evaluate the strategies, and the best pair, with the options of the other goal."""
    for family, paired in pairs.families.items():
        for option, strategies in pairs.beside(family).items():
            known = _options(manifest)
            known[pairs.goal] = [one for one in known[pairs.goal] if one["name"] == option]
            knowledge = _written(folder / f"{option}.knowledge.yaml", {"goals": known})
            words = [word for strategy in strategies for word in ("--strategy", strategy)]
            asked = ("--family", family, "--goal", manifest.goal, "--knowledge", knowledge, *words)
            for seed in pairs.seeds:
                output = pair_folder(folder, family, option, seed)
                run("evaluate", *asked, "--scenarios", paired.scenarios, "--seed", seed, "--output", output, "--resume")


def _trained(folder: Path, label: str, learner: Learner) -> str:
    """Do the trainings; return the strategy with all of them as members."""
    kind = load_file("training", learner.training, TrainingConfig).learner
    prefix, made = (MACHINE, "machine.yaml") if kind == "design" else (POLICY, "policy")
    times = folder / CPU_TIMES
    members = []
    for seed in learner.seeds:
        output = folder / f"{label}-{seed}"
        new = not output.exists()
        took = run("train", kind, "--config", learner.training, "--seed", seed, "--output", output, "--resume")
        if new:
            known = json.loads(times.read_text(encoding="utf-8")) if times.exists() else {}
            write_whole(times, json.dumps({**known, output.name: took}, indent=2).encode())
        members.append(str(output / made))
    return f"{prefix}:{'+'.join(members)}"


def _ablated(folder: Path, manifest: Manifest, ablations: Ablations) -> dict[str, Learner]:
    """Write the trainings and the knowledge of what is left out or other; return label -> trainings."""
    learners = {}
    for label, ablation in ablations.of.items():
        whole = manifest.learners[ablation.learner or manifest.claimed].training
        training = {**load_file("training", whole, TrainingConfig).model_dump(mode="json"), **ablation.changes}
        if ablation.without is not None or ablation.only is not None:
            options = _options(manifest)
            options[manifest.goal] = [
                one
                for one in options[manifest.goal]
                if one["name"] != ablation.without and ablation.only in (None, one["name"])
            ]
            knowledge = _written(folder / f"{label}.knowledge.yaml", {"goals": options})
            training["tasks"] = [{**task, "knowledge": str(knowledge)} for task in training["tasks"]]
        given = {name: value for name, value in training.items() if value is not None}
        learners[label] = Learner(training=str(_written(folder / f"{label}.yaml", given)), seeds=ablations.seeds)
    return learners


def _options(manifest: Manifest) -> dict[str, list[dict[str, Any]]]:
    """Return goal -> options of the knowledge."""
    known = load_knowledge(manifest.knowledge)
    return {name: [one.model_dump(mode="json") for one in known.options(name)] for name in known.goals}


def _written(file: Path, content: Mapping[str, Any]) -> Path:
    """Write a YAML file; return it."""
    write_whole(file, as_yaml(content).encode())
    return file


def _with_configured(folder: Path, manifest: Manifest, configured: Configured) -> Path:
    """Configure the option; return knowledge in which it stands beside all others."""
    output = folder / "configured"
    asked = ("--family", configured.family, "--knowledge", manifest.knowledge, "--trials", configured.trials)
    run("study", "configure", configured.option, *asked, "--seed", 1, "--output", output, "--resume")
    (found,) = (output / "knowledge").glob("*.yaml")
    option = read_mapping(found)["goals"][manifest.goal][0]
    options = _options(manifest)
    options[manifest.goal].append({**option, "name": OWN_NAME})
    return _written(folder / "knowledge.yaml", {"goals": options})


def _look_ahead(folder: Path, manifest: Manifest, family: str, compared: Compared) -> None:
    """Let teams look ahead from what the first training of the claimed learner does, unless they did."""
    file = looked_ahead_file(folder, family)
    if file.exists():
        return
    claimed, first = manifest.claimed, manifest.learners[manifest.claimed].seeds[0]
    base = f"{POLICY}:{folder / f'{claimed}-{first}' / 'policy'}"
    asked = ("--goal", manifest.goal, "--scenarios", compared.looked_ahead, "--seed", 1)
    ahead = ("--copies", COPIES, "--hold", HOLD, "--horizon", HORIZON)
    output = folder / f"look-ahead-of-{family}"
    run("study", "look-ahead", family, "--base", base, *asked, *ahead, "--output", output, "--resume")
    looked = sorted(
        (run for run in runs_of(output / JOURNAL) if run.condition == LOOKING),
        key=lambda run: natural_order(run.scenario),
    )
    counted = sum((Counter(run.counts) for run in looked), Counter())
    taken = {claimed if name == base else name: number for name, number in counted.items()}
    content = {"excess_s": [run.result.excess_s for run in looked], "taken": taken}
    write_whole(file, json.dumps(content).encode())


def run(*words: object) -> float:
    """Run `clean-swarm` with `words`; return its CPU time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*CLEAN_SWARM, *map(str, words)], cwd=ROOT, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
