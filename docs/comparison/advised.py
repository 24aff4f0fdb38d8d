"""Advice beside an exhaustive search, which tells whether `advise` names a pair that is as good as the best of all.

    python -m docs.comparison.advised all table1-starts random-bumpers scouts      # every pair on 100 starts
    python -m docs.comparison.advised repeat table1-starts --minutes 1 --seeds 20  # advice with other seeds
    python -m docs.comparison.advised judge scouts --starts 400             # what advice named, on 400 starts
    python -m docs.comparison.advised table  # the tables of docs/tutorials/advise.md

Pairs that cost more than twice the best after 20 starts stop there. Where pairs differ by less than 100 starts can
tell, the best and what advice named are judged on more. Results are kept in docs/comparison/advised.json.
"""

import argparse
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.named import FIXED
from docs.figures.stored import ROOT, record
from selector.documents.fields import JOINT
from selector.knowledge import Option
from train.advising.evaluation import AdviceEvaluation
from train.advising.opening import OpenedMission, document_of, open_mission, variants_of
from train.evaluation import pipeline
from train.request import Request
from train.running.trial_task import TrialTask

COMMAND = "python -m docs.comparison.advised"
RESULTS = Path(__file__).with_name("advised.json")
SEED = 424_242
"""Seed of the starts on which everything is judged; no advice has it."""
STARTS, FIRST, TIMES, NEAR = 100, 20, 2.0, 1.1


def excesses(wide: OpenedMission, arm: str, file: Path, starts: range) -> list[float]:
    """Return the excess of an arm on starts [s]."""
    family = wide.with_knowledge(file)
    drawn = tuple(family.scenario_named(SEED, scenario_name("test", k)) for k in starts)
    records = TrialTask(family.name, SEED, drawn, arm, arm, JOINT.join(wide.goals)).run()
    return [round(record.result.excess_s, 3) for record in records]


def exhaustive(mission: str) -> dict[str, Any]:
    """Return the excess of every pair on the starts, of those far behind on the first ones only."""
    wide = open_mission(load_family(mission), ())
    names = [f"{FIXED}:{first}" for first in wide.names(wide.goals[0])]
    for goal in wide.goals[1:]:
        names = [f"{name}{JOINT}{option}" for name in names for option in wide.names(goal)]
    with TemporaryDirectory() as folder:
        file = Path(folder) / "options.yaml"
        file.write_text(document_of(wide.known.table, ()), encoding="utf-8")
        found = {name: excesses(wide, name, file, range(FIRST)) for name in names}
        best = min(float(np.mean(own)) for own in found.values())
        for name, own in found.items():
            if np.mean(own) <= TIMES * best:
                own += excesses(wide, name, file, range(FIRST, STARTS))
    return {"excess_s": found, "experts": f"{FIXED}:{JOINT.join(wide.experts.values())}"}


def judged(mission: str, known: dict[str, Any], starts: int) -> dict[str, Any]:
    """Return the excess of what advice named, and of the pairs near the best, on a number of starts."""
    wide = open_mission(load_family(mission), ())
    means = {arm: float(np.mean(own)) for arm, own in known["excess_s"].items() if len(own) >= STARTS}
    near = {arm for arm, mean in means.items() if mean <= NEAR * min(means.values())}
    held = {one["arm"] for one in known["advice"]}
    own = {**known["excess_s"], **{arm: costs for arm, costs in known.get("named", {}).items() if arm in held}}
    with TemporaryDirectory() as folder:
        for arm in sorted({*near, *held, known["experts"]}):
            first = own.get(arm, [])
            alike = [costs for costs in own.values() if costs[:STARTS] == first[:STARTS] and len(costs) >= starts]
            if len(first) >= STARTS and alike:  # a robot that holds the option of a goal does the same with any
                own[arm] = alike[0][:starts] if arm in {*held, known["experts"]} else first
            elif len(first) < starts:
                options = zip(wide.goals, arm.partition(":")[2].split(JOINT), strict=True)
                table = {goal: (*wide.known.table[goal], *variant_of(wide, goal, name)) for goal, name in options}
                file = Path(folder) / "options.yaml"
                file.write_text(document_of(table, ()), encoding="utf-8")
                own[arm] = [*first, *excesses(wide, arm, file, range(len(first), starts))]
    return {
        "excess_s": {arm: own[arm] for arm in known["excess_s"]},
        "named": {arm: own[arm] for arm in held if arm not in known["excess_s"]},
    }


def variant_of(wide: OpenedMission, goal: str, name: str) -> list[Option]:
    """Return the variant of a name; none of the name of an option."""
    plain = [option for option in wide.known.table[goal] if name.startswith(f"{option.name}-")]
    tried = [variants_of({goal: option}, ())[goal] for option in plain if name not in wide.names(goal)]
    return [option for own in tried for option in own if option.name == name][-1:]


def repeated(mission: str, minutes: float, seeds: range, known: dict[str, Any]) -> list[dict[str, Any]]:
    """Return what advice said with each seed, the kept ones too."""
    found: list[dict[str, Any]] = known.get("advice", []) if known.get("minutes") == minutes else []
    for seed in seeds[sum(one.get("corrected", False) for one in found) :]:
        with TemporaryDirectory() as place:
            folder = Path(place) / "advice"
            evaluation = AdviceEvaluation(Request(mission, seed=seed, output=folder), minutes)
            with Path(place, "log").open("w", encoding="utf-8") as log:
                assert pipeline.evaluate(evaluation, Console(file=log)) == 0
            said = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            arm = f"{FIXED}:{JOINT.join(said['held'].values())}"
            told = {name: said[name] for name in ("starts", "missions", "cpu_s", "better", "worth_it", "hindsight")}
            told |= {"seed": seed, "arm": arm, "corrected": True}
        found.append(told)
        print(mission, found[-1], flush=True)
    return found


def tables(kept: dict[str, Any]) -> dict[str, str]:
    """Return the tables: advice beside the best of all pairs, and whether a selector was said to be worth it."""
    found = {
        "found": [
            "| mission | pairs | starts | best of all | experts | within 1.05 | worst | above the experts | CPU-min |"
        ],
        "worth": ["| mission | runs | worth it | not worth it | not known | starts of the last round | CPU-min |"],
    }
    for lines in found.values():
        lines.append("|---" * (lines[0].count("|") - 1) + "|")
    for mission, own in sorted(kept.items()):
        told = own.get("advice", [])
        minutes = f"{np.mean([one['cpu_s'] for one in told]) / 60.0:.1f}" if told else "-"
        if told and "excess_s" in own:
            costs_of = {**own["excess_s"], **own.get("named", {})}
            starts = len(costs_of[own["experts"]])
            means = {arm: float(np.mean(costs)) for arm, costs in costs_of.items() if len(costs) == starts}
            best, experts = min(means[arm] for arm in own["excess_s"] if arm in means), means[own["experts"]]
            costs = np.array([means[one["arm"]] for one in told])
            near, above = int((costs <= 1.05 * best).sum()), int((costs > experts).sum())
            found["found"].append(
                f"| {mission} | {len(own['excess_s'])} | {starts} | {best:.1f} s | {experts:.1f} s "
                f"| {near} of {len(told)} | {costs.max() / best:.2f} | {above} | {minutes} |"
            )
        said = [one for one in told if one.get("corrected")]  # by the rule of today
        if said:
            starts, verdicts = [one["starts"] for one in said], [one["worth_it"] for one in said]
            span = f"{min(starts)} to {max(starts)}" if min(starts) < max(starts) else f"{starts[0]}"
            counts = " | ".join(str(verdicts.count(verdict)) for verdict in (True, False, None))
            took = f"{np.mean([one['cpu_s'] for one in said]) / 60.0:.1f}"
            found["worth"].append(f"| {mission} | {len(said)} | {counts} | {span} | {took} |")
    return {name: "\n".join(lines) for name, lines in found.items()}


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=("all", "repeat", "judge", "table"))
    parser.add_argument("missions", nargs="*")
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--starts", type=int, default=STARTS)
    given = parser.parse_args()
    if given.what == "table":
        for mark, table in tables(json.loads(RESULTS.read_text(encoding="utf-8"))).items():
            record(f"tutorials/advise/{mark}", table, f"{COMMAND} table", [RESULTS.relative_to(ROOT).as_posix()])
    for mission in given.missions:
        kept = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
        own = kept.get(mission, {})
        if given.what == "all":
            new = exhaustive(mission)
        elif given.what == "judge":
            new = judged(mission, own, given.starts)
        else:
            new = {"minutes": given.minutes, "advice": repeated(mission, given.minutes, range(1, given.seeds + 1), own)}
        kept = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
        kept[mission] = {**own, **new}
        RESULTS.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
