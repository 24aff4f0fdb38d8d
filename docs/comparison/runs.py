"""The races, trainings and evaluations of a comparison. What its directory holds already is kept."""

import json
import re
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console

from clean_swarm_env.config.load import load_family
from docs.comparison import headroom
from docs.comparison.claims import family_runs
from docs.comparison.manifest import Ablations, Learner, Manifest, Variant
from docs.comparison.raced_numbers import Won, knowledge_with, race_numbers
from docs.comparison.running import run, written
from docs.comparison.shuffled import ShuffledEvaluation
from docs.figures.stored import ROOT
from selector.documents.fields import JOINT
from selector.documents.find import find_file, load_file
from selector.documents.reading import read_mapping
from selector.documents.writing import write_whole
from selector.knowledge import load_knowledge
from train.analysis.family_report import excesses_of
from train.analysis.intervals import Ratio
from train.deciders.named import FIXED, MACHINE, POLICY
from train.evaluation.family import AloneEvaluation
from train.evaluation.pipeline import evaluate
from train.learning.config import TrainingConfig
from train.learning.training import HISTORY_FILE
from train.request import Request

CPU_TIMES = "cpu_s.json"
AT_ONCE = 2
"""Trainings that run at the same time, each in a process of its own."""
SHUFFLED, SCREENING, NUMBERS = "shuffled", "screening", "numbers"
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
    learners = {**manifest.learners, **_ablated(folder, manifest)}
    members = _trained(folder, learners)
    raced_numbers(manifest, folder)
    for family in manifest.families:
        _race(folder, manifest, family)
    best = {label: [preferred(own)] if manifest.screening else own for label, own in members.items()}
    for family, compared in manifest.families.items():
        best_there, rules = raced(manifest, folder, family), {}
        numbers = configured(manifest, folder, family)
        outside = bool(numbers) and not ships(manifest, family, numbers)
        given = dict.fromkeys((best_there.best, *([numbers] if numbers and not outside else [])))
        held = [f"{FIXED}:{options}" for options in given]
        told = [f"{FIXED}:{options}" for options in dict.fromkeys(best_there.told.values()) if options not in given]
        told += _told(folder, manifest, family)
        if manifest.goal_on(family) == manifest.goal:
            rules = {label: f"{label}={rule}" for label, rule in manifest.rules.items()}
        ablated = manifest.ablations.of if manifest.ablations and family in manifest.ablations.families else ()
        judged = manifest.judged_on(family)
        every = {label: _strategy(label, members[label]) for label in (*judged, *ablated)} | rules
        first, left = manifest.screening, list(every)
        if first is not None:
            screened = f"{family}-{SCREENING}"
            _judge(folder, manifest, family, screened, [*held, *every.values()], (first.seed,), first.scenarios)
            worse = clearly_worse(judged_folder(folder, screened, first.seed), manifest.claimed)
            left = [label for label in every if label not in worse and label not in ablated]
        chosen = [rules[label] if label in rules else _strategy(label, best[label]) for label in left]
        _judge(folder, manifest, family, family, [*held, *chosen, *told], manifest.seeds, compared.scenarios)
        if outside:
            file = knowledge_with(manifest.numbers, folder, family, manifest.goal_on(family), numbers)
            label, member = f"{family}-{NUMBERS}", f"{FIXED}:{numbers}"
            _judge(folder, manifest, family, label, [member], manifest.seeds, compared.scenarios, str(file))
        if compared.headroom:
            _shuffle(folder, manifest, family, _strategy(manifest.claimed, best[manifest.claimed]))
    claimed = _strategy(manifest.claimed, best[manifest.claimed])
    for label, variant in manifest.variants.items():
        best_there = f"{FIXED}:{raced(manifest, folder, variant.family).best}"
        count = variant.scenarios or manifest.families[variant.family].scenarios
        _judge(folder, manifest, variant.family, label, [best_there, claimed], manifest.seeds, count)


def raced_numbers(manifest: Manifest, folder: Path) -> dict[str, dict[str, Won]]:
    """Race the numbers of options where this is not done; return family -> goal -> what was found."""
    numbers = manifest.numbers
    return (
        {}
        if numbers is None
        else {family: race_numbers(numbers, folder, family, manifest.goal_on(family)) for family in numbers.families}
    )


def configured(manifest: Manifest, folder: Path, family: str) -> str:
    """Return the options of the best numbers that races found, joined; empty if there was no race."""
    numbers = manifest.numbers
    if numbers is None or family not in numbers.families:
        return ""
    found = race_numbers(numbers, folder, family, manifest.goal_on(family))
    return JOINT.join(won.option for won in found.values())


def ships(manifest: Manifest, family: str, options: str) -> bool:
    """Return whether the library has all of the joined options."""
    known, goals = load_knowledge(load_family(family).mission.knowledge), manifest.goal_on(family).split(JOINT)
    pairs = zip(goals, options.split(JOINT), strict=True)
    return all(name in {one.name for one in known.options(goal)} for goal, name in pairs)


def clearly_worse(folder: Path, claimed: str) -> set[str]:
    """Return the labels whose ratio to the claimed learner has a lower bound above 1."""
    means = {label: own.mean(axis=2) for label, own in excesses_of(family_runs(folder)).items()}
    ratios = {label: Ratio.of(own, means[claimed].mean(axis=0)) for label, own in means.items() if label != claimed}
    return {label for label, ratio in ratios.items() if ratio.ci95 is not None and ratio.ci95[0] > 1.0}


def preferred(trainings: Sequence[Path]) -> Path:
    """Return what the training made whose validation is the best."""
    return min(trainings, key=lambda made: best_checkpoint(made.parent)["score"])


def best_checkpoint(training: Path) -> dict[str, float]:
    """Return the figures of the checkpoint with the lowest mean logarithm of the excess on validation scenarios."""
    return min(_measured(training), key=lambda entry: entry["score"])


def first_checkpoint(training: Path) -> dict[str, float]:
    """Return the figures of the first checkpoint that was measured."""
    return _measured(training)[0]


def _measured(training: Path) -> list[dict[str, float]]:
    lines = (training / HISTORY_FILE).read_text(encoding="utf-8").splitlines()
    return [entry for entry in map(json.loads, lines) if entry["score"] is not None]


def judged_folder(folder: Path, label: str, seed: int) -> Path:
    """Return the directory of the runs on the test scenarios of a seed, of a family or of a variant."""
    return folder / f"{label}-{seed}"


def raced(manifest: Manifest, folder: Path, family: str) -> Raced:
    """Return what was raced, or given."""
    compared = manifest.families[family]
    if compared.best is not None:
        return Raced(compared.best, compared.kinds)
    notes = json.loads((_race_folder(folder, family) / "summary.json").read_text(encoding="utf-8"))["notes"]
    best = next(note for note in notes if note.startswith("best single choice: ")).partition(": ")[2]
    cases = next(note for note in notes if note.startswith("best choices: ")).partition(": ")[2]
    told = dict(re.fullmatch(r"(.*) (\S+)", case).groups() for case in cases.split(", "))  # type: ignore[union-attr]
    return Raced(best, told if compared.headroom and not compared.told else {})


def _race_folder(folder: Path, family: str) -> Path:
    return folder / f"race-of-{family}"


def _race(folder: Path, manifest: Manifest, family: str) -> None:
    """Race the options of the goals on training scenarios."""
    output, race = _race_folder(folder, family), manifest.race
    if manifest.families[family].best is None and not (output / "summary.json").exists():
        searched = manifest.families[family].searched or race.searched
        sizes = {"searched": searched, "finalists": race.finalists, "judged": 2, "seed": race.seed}
        headroom.race(family, manifest.goal_on(family), output, **sizes)


def _trained(folder: Path, learners: Mapping[str, Learner]) -> dict[str, list[Path]]:
    """Do the trainings; return label -> what each made."""
    kinds = {label: load_file("training", one.training, TrainingConfig).learner for label, one in learners.items()}
    made = {label: "machine.yaml" if kind == "design" else "policy" for label, kind in kinds.items()}
    outputs = {label: [folder / f"{label}-{seed}" for seed in one.seeds] for label, one in learners.items()}
    times = folder / CPU_TIMES

    def train(label: str, seed: int, output: Path) -> tuple[str, float]:
        place = output.relative_to(ROOT) if output.is_relative_to(ROOT) else output  # policies name their command
        words = ("--config", learners[label].training, "--seed", seed, "--output", place, "--resume")
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
    return {label: [output / made[label] for output in own] for label, own in outputs.items()}


def _strategy(label: str, trainings: Sequence[Path]) -> str:
    """Return trainings as one strategy."""
    prefix = MACHINE if trainings[0].suffix else POLICY
    return f"{label}={prefix}:{'+'.join(map(str, trainings))}"


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
        file = written(folder / f"{label}.yaml", content)
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
    return str(written(folder / f"{label}.knowledge.yaml", {"goals": options}))


def _told(folder: Path, manifest: Manifest, family: str) -> list[str]:
    """Write the machine of a team that is told; return it as a strategy, none if the race tells."""
    told = manifest.families[family].told
    if not told:
        return []
    ways = [{"to": case, "when": case, "above": 0.5} for case in told]
    states = {case: {"option": options, "transitions": ways} for case, options in told.items()}
    machine = {"goal": manifest.goal_on(family), "start": next(iter(told)), "states": states}
    return [f"{TOLD}={MACHINE}:{written(folder / f'{TOLD}-{family}.yaml', machine)}"]


def _judge(
    folder: Path,
    manifest: Manifest,
    family: str,
    label: str,
    strategies: Sequence[str],
    seeds: Sequence[int],
    scenarios: int,
    knowledge: str = "",
) -> None:
    """Evaluate strategies on the test scenarios of some seeds of a family, or of its variant `label`.

    With `knowledge` teams have its options in place of those of the library.
    """
    file = _family_file(folder, family, label, manifest.variants.get(label), knowledge)
    words = [word for strategy in strategies for word in ("--strategy", strategy)]
    for seed in seeds:
        output = judged_folder(folder, label, seed)
        if manifest.screening is None or seed == manifest.screening.seed:
            asked = ("--goal", manifest.goal_on(family), "--scenarios", scenarios, "--seed", seed)
            run("evaluate", "--family", file, *asked, *words, "--output", output, "--resume")
        else:
            asked = _request(file, manifest.goal_on(family), strategies, seed, scenarios, output)
            evaluate(AloneEvaluation(asked), Console(quiet=True))


def _request(file: Path, goal: str, strategies: Sequence[str], seed: int, scenarios: int, output: Path) -> Request:
    asked = Request(str(file), strategies=tuple(strategies), seed=seed, scenarios=scenarios, goal=goal)
    return replace(asked, output=output, resume=True)


def _family_file(folder: Path, family: str, label: str, variant: Variant | None, knowledge: str = "") -> Path:
    """Write the family, or its variant, with terms that machines may need; return the file."""
    content = read_mapping(find_file("families", family))
    mission = {**content["mission"], "terms": [*TRUE_TERMS], **({"knowledge": knowledge} if knowledge else {})}
    if variant is not None and variant.loss:
        mission["delivery"] = {"loss": variant.loss}
    robots = {} if variant is None or variant.robots is None else {"robots": list(variant.robots)}
    return written(folder / f"{label}.family.yaml", {**content, **robots, "mission": mission})


def _shuffle(folder: Path, manifest: Manifest, family: str, strategy: str) -> None:
    """Judge the claimed learner where each robot gets the observation of another one; in the screening, if any."""
    file, goal, first = _family_file(folder, family, family, None), manifest.goal_on(family), manifest.screening
    count = manifest.families[family].scenarios if first is None else first.scenarios
    for seed in manifest.seeds if first is None else (first.seed,):
        output = judged_folder(folder, f"{family}-{SHUFFLED}", seed)
        evaluate(ShuffledEvaluation(_request(file, goal, (strategy,), seed, count, output)), Console(quiet=True))


def claimed_training(manifest: Manifest, folder: Path) -> Path:
    """Return the training of the claimed learner that stands for it."""
    seeds = manifest.learners[manifest.claimed].seeds
    trainings = [folder / f"{manifest.claimed}-{seed}" / "policy" for seed in seeds]
    return preferred(trainings) if manifest.screening else trainings[0]


def cpu_minutes(folder: Path, names: list[str]) -> float:
    """Return the mean CPU time of trainings [min]."""
    times = json.loads((folder / CPU_TIMES).read_text(encoding="utf-8"))
    return sum(times[name] for name in names) / len(names) / 60.0


def shown_options(options: str) -> str:
    """Return joined options for people."""
    return options.replace(JOINT, ", ")
