"""The races, trainings and evaluations of a comparison. What its directory holds already is kept."""

import json
import os
import re
import subprocess
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from clean_swarm_env.config.load import load_family
from docs.comparison.manifest import Ablations, Learner, Manifest, Variant
from docs.comparison.shuffled import ShuffledEvaluation
from docs.figures.update_results import CLEAN_SWARM, ROOT
from selector.documents.fields import JOINT
from selector.documents.find import find_file, load_file
from selector.documents.reading import as_yaml, read_mapping
from selector.documents.writing import write_whole
from selector.knowledge import load_knowledge
from train.deciders.named import FIXED, MACHINE, POLICY
from train.evaluation.pipeline import evaluate
from train.learning.config import TrainingConfig
from train.request import Request

CPU_TIMES = "cpu_s.json"
AT_ONCE = 2
"""Trainings that run at the same time, each in a process of its own."""
SHUFFLED = "shuffled"
TOLD = "told"
"""Label of a machine that sees what no robot can know."""
TRUE_TERMS = ("true_season", "finds", "recent_finds", "stops", "loads")
"""Terms that machines on written families see, beside the usual ones."""


@dataclass(frozen=True)
class Raced:
    """What a race found."""

    best: str
    """The best options for all scenarios."""
    told: Mapping[str, str]
    """Kind of scenario -> the best options for it."""


def make(manifest: Manifest, folder: Path) -> None:
    """Do what is missing in the directory of the results."""
    folder.mkdir(parents=True, exist_ok=True)
    for family in manifest.families:
        _race(folder, manifest, family)
    learners = {**manifest.learners, **_ablated(folder, manifest)}
    words = _trained(folder, learners)
    for family in manifest.families:
        best = raced(manifest, folder, family)
        others = [f"{FIXED}:{options}" for options in dict.fromkeys((best.best, *best.told.values()))]
        ablated = manifest.ablations.of if manifest.ablations and family in manifest.ablations.families else ()
        strategies = [f"{label}={words[label]}" for label in (*manifest.judged_on(family), *ablated)]
        if manifest.goal_on(family) == manifest.goal:
            strategies += [f"{label}={rule}" for label, rule in manifest.rules.items()]
        _judge(folder, manifest, family, family, [*others, *strategies, *_told(folder, manifest, family)])
        if manifest.families[family].headroom:
            _shuffle(folder, manifest, family, words[manifest.claimed])
    claimed = f"{manifest.claimed}={words[manifest.claimed]}"
    for label, variant in manifest.variants.items():
        best_there = f"{FIXED}:{raced(manifest, folder, variant.family).best}"
        _judge(folder, manifest, variant.family, label, [best_there, claimed])


def judged_folder(folder: Path, label: str, seed: int) -> Path:
    """Return the directory of the runs on the test scenarios of a seed, of a family or of a variant."""
    return folder / f"{label}-{seed}"


def raced(manifest: Manifest, folder: Path, family: str) -> Raced:
    """Return what was raced, or given."""
    compared = manifest.families[family]
    if compared.best is not None:
        return Raced(compared.best, {})
    notes = json.loads((_race_folder(folder, family) / "summary.json").read_text(encoding="utf-8"))["notes"]
    best = next(note for note in notes if note.startswith("best single choice: ")).partition(": ")[2]
    cases = next(note for note in notes if note.startswith("best choices: ")).partition(": ")[2]
    told = dict(re.fullmatch(r"(.*) (\S+)", case).groups() for case in cases.split(", "))  # type: ignore[union-attr]
    return Raced(best, told if compared.headroom and not compared.told else {})


def run(*words: object) -> float:
    """Run `clean-swarm` with `words`; return its CPU time [s]."""
    command = [*CLEAN_SWARM, *map(str, words)]
    process = subprocess.Popen(command, cwd=ROOT)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return used.ru_utime + used.ru_stime


def _race_folder(folder: Path, family: str) -> Path:
    return folder / f"race-of-{family}"


def _race(folder: Path, manifest: Manifest, family: str) -> None:
    """Race the options of the goals on training scenarios."""
    output, race = _race_folder(folder, family), manifest.race
    if manifest.families[family].best is None and not (output / "summary.json").exists():
        sizes = (
            "--searched",
            manifest.families[family].searched or race.searched,
            "--finalists",
            race.finalists,
            "--judged",
            2,
            "--seed",
            race.seed,
        )
        goal = ("--goal", manifest.goal_on(family))
        run("study", "headroom", family, "--kinds", *goal, *sizes, "--output", output, "--resume")


def _trained(folder: Path, learners: Mapping[str, Learner]) -> dict[str, str]:
    """Do the trainings; return label -> strategy with all of its trainings as members."""
    kinds = {label: load_file("training", one.training, TrainingConfig).learner for label, one in learners.items()}
    made = {label: "machine.yaml" if kind == "design" else "policy" for label, kind in kinds.items()}
    outputs = {label: [folder / f"{label}-{seed}" for seed in one.seeds] for label, one in learners.items()}
    times = folder / CPU_TIMES

    def train(label: str, seed: int, output: Path) -> tuple[str, float]:
        words = ("--config", learners[label].training, "--seed", seed, "--output", output, "--resume")
        return output.name, run("train", kinds[label], *words)

    with ThreadPoolExecutor(AT_ONCE) as pool:
        tasks = [
            pool.submit(train, label, seed, output)
            for label, one in learners.items()
            for seed, output in zip(one.seeds, outputs[label], strict=True)
            if not (output / made[label]).exists()
        ]
        try:
            for task in as_completed(tasks):
                name, took = task.result()
                known = json.loads(times.read_text(encoding="utf-8")) if times.exists() else {}
                write_whole(times, json.dumps({**known, name: took}, indent=2).encode())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    prefixes = {label: MACHINE if kind == "design" else POLICY for label, kind in kinds.items()}
    return {
        label: f"{prefixes[label]}:{'+'.join(str(output / made[label]) for output in own)}"
        for label, own in outputs.items()
    }


def _ablated(folder: Path, manifest: Manifest) -> dict[str, Learner]:
    """Write the trainings and the knowledge of what is left out or other; return label -> trainings."""
    learners, ablations = {}, manifest.ablations
    for label, ablation in () if ablations is None else ablations.of.items():
        assert ablations is not None
        whole = load_file("training", manifest.learners[manifest.claimed].training, TrainingConfig)
        training = whole.model_dump(mode="json")
        ppo = {**training["ppo"], **ablation.changes.get("ppo", {})}
        training |= {**ablation.changes, "ppo": ppo}
        if ablation.without:
            given = _lacking(folder, label, ablations, ablation.without)
            training["tasks"] = [
                {**task, "knowledge": given} if knows(task["family"], ablations.knowledge) else task
                for task in training["tasks"]
            ]
        content = {name: value for name, value in training.items() if value is not None}
        file = _written(folder / f"{label}.yaml", content)
        learners[label] = Learner(training=str(file), seeds=ablations.seeds, families=ablations.families)
    return learners


def knows(family: str, knowledge: str) -> bool:
    """Return whether the missions of a family have the options of this knowledge."""
    return load_family(family).mission.knowledge == knowledge


def _lacking(folder: Path, label: str, ablations: Ablations, without: tuple[str, ...]) -> str:
    """Write knowledge that lacks options; return its path."""
    known = load_knowledge(ablations.knowledge)
    options = {
        goal: [one.model_dump(mode="json") for one in known.options(goal) if one.name not in without]
        for goal in known.goals
    }
    return str(_written(folder / f"{label}.knowledge.yaml", {"goals": options}))


def _told(folder: Path, manifest: Manifest, family: str) -> list[str]:
    """Write the machine of a team that is told; return it as a strategy, none if the race tells."""
    told = manifest.families[family].told
    if not told:
        return []
    ways = [{"to": case, "when": case, "above": 0.5} for case in told]
    states = {case: {"option": options, "transitions": ways} for case, options in told.items()}
    machine = {"goal": manifest.goal_on(family), "start": next(iter(told)), "states": states}
    return [f"{TOLD}={MACHINE}:{_written(folder / f'{TOLD}-{family}.yaml', machine)}"]


def _judge(folder: Path, manifest: Manifest, family: str, label: str, strategies: list[str]) -> None:
    """Evaluate strategies on the test scenarios of all seeds of a family, or of its variant `label`."""
    file = _family_file(folder, family, label, manifest.variants.get(label))
    words = [word for strategy in strategies for word in ("--strategy", strategy)]
    goal, count = ("--goal", manifest.goal_on(family)), ("--scenarios", manifest.families[family].scenarios)
    for seed in manifest.seeds:
        output = judged_folder(folder, label, seed)
        run("evaluate", "--family", file, *goal, *words, *count, "--seed", seed, "--output", output, "--resume")


def _family_file(folder: Path, family: str, label: str, variant: Variant | None) -> Path:
    """Write the family, or its variant, with terms that machines may need; return the file."""
    content = read_mapping(find_file("families", family))
    mission = {**content["mission"], "terms": [*TRUE_TERMS]}
    if variant is not None and variant.loss:
        mission["delivery"] = {"loss": variant.loss}
    robots = {} if variant is None or variant.robots is None else {"robots": list(variant.robots)}
    return _written(folder / f"{label}.family.yaml", {**content, **robots, "mission": mission})


def _shuffle(folder: Path, manifest: Manifest, family: str, policy: str) -> None:
    """Judge the claimed learner where each robot gets the observation of another one."""
    file = _family_file(folder, family, family, None)
    for seed in manifest.seeds:
        output = judged_folder(folder, f"{family}-{SHUFFLED}", seed)
        request = Request(
            str(file),
            strategies=(f"{manifest.claimed}={policy}",),
            seed=seed,
            scenarios=manifest.families[family].scenarios,
            goal=manifest.goal_on(family),
            output=output,
            resume=True,
        )
        evaluate(ShuffledEvaluation(request), Console(quiet=True))


def _written(file: Path, content: Mapping[str, Any]) -> Path:
    """Write a YAML file; return it."""
    write_whole(file, as_yaml(content).encode())
    return file


def trained_first(manifest: Manifest, folder: Path) -> str:
    """Return the first training of the claimed learner as a strategy."""
    return f"{POLICY}:{folder / f'{manifest.claimed}-{manifest.learners[manifest.claimed].seeds[0]}' / 'policy'}"


def cpu_minutes(folder: Path, names: list[str]) -> float:
    """Return the mean CPU time of trainings [min]."""
    times = json.loads((folder / CPU_TIMES).read_text(encoding="utf-8"))
    return sum(times[name] for name in names) / len(names) / 60.0


def shown_options(options: str) -> str:
    """Return joined options for people."""
    return options.replace(JOINT, ", ")
