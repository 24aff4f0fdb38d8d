"""Advice beside an exhaustive search, which tells whether `advise` names a pair that is as good as the best of all.

    python -m docs.comparison.advised all table1-starts random-bumpers scouts      # every pair on 100 starts
    python -m docs.comparison.advised repeat table1-starts --minutes 1 --seeds 20  # advice with other seeds on these starts
    python -m docs.comparison.advised table  # the tables of docs/tutorials/advise.md

Pairs that cost more than twice the best after 20 starts stop there. Results are kept in docs/comparison/advised.json.
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
from train.advising.evaluation import AdviceEvaluation
from train.advising.opening import OpenedMission, document_of, open_mission
from train.evaluation import pipeline
from train.evaluation.scenarios import scenario_named
from train.request import Request
from train.running.trial_task import TrialTask

COMMAND = "python -m docs.comparison.advised"
RESULTS = Path(__file__).with_name("advised.json")
SEED = 424_242
"""Seed of the starts on which everything is judged; no advice has it."""
STARTS, FIRST, TIMES = 100, 20, 2.0


def excesses(wide: OpenedMission, arm: str, file: Path, starts: range) -> list[float]:
    """Return the excess of an arm on starts [s]."""
    family = wide.with_knowledge(file)
    drawn = tuple(scenario_named(family, SEED, scenario_name("test", k)) for k in starts)
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


def repeated(mission: str, minutes: float, seeds: range, known: dict[str, Any]) -> list[dict[str, Any]]:
    """Return what advice said with each seed, the kept ones too; where all pairs are known, what it costs on them."""
    found: list[dict[str, Any]] = known.get("advice", []) if known.get("minutes") == minutes else []
    for seed in seeds[len(found) :]:
        with TemporaryDirectory() as place:
            folder = Path(place) / "advice"
            evaluation = AdviceEvaluation(Request(mission, seed=seed, output=folder), minutes)
            with Path(place, "log").open("w", encoding="utf-8") as log:
                assert pipeline.evaluate(evaluation, Console(file=log)) == 0
            said = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            arm = f"{FIXED}:{JOINT.join(said['held'].values())}"
            told = {name: said[name] for name in ("starts", "missions", "cpu_s", "better", "worth_it", "hindsight")}
            told |= {"seed": seed, "arm": arm}
            if "excess_s" in known:
                own = known["excess_s"].get(arm, [])
                if len(own) < STARTS:
                    own = excesses(evaluation.opened, arm, evaluation.file_of(arm), range(STARTS))
                told["excess_s"] = round(float(np.mean(own)), 3)
        found.append(told)
        print(mission, found[-1], flush=True)
    return found


def tables(kept: dict[str, Any]) -> dict[str, str]:
    """Return the tables: advice beside the best of all pairs, and whether a selector was said to be worth it."""
    found = {
        "found": [
            "| mission | pairs | best of all | experts | within 1.05 of it | worst | above the experts | CPU-min |"
        ],
        "worth": ["| mission | runs | worth it | not | starts of the last round | CPU-min |"],
    }
    for lines in found.values():
        lines.append("|---" * (lines[0].count("|") - 1) + "|")
    for mission, own in sorted(kept.items()):
        told = own.get("advice", [])
        minutes = f"{np.mean([one['cpu_s'] for one in told]) / 60.0:.1f}" if told else "-"
        if told and "excess_s" in own:
            means = {arm: float(np.mean(costs)) for arm, costs in own["excess_s"].items() if len(costs) == STARTS}
            best, experts = min(means.values()), float(np.mean(own["excess_s"][own["experts"]]))
            costs = np.array([one["excess_s"] for one in told])
            near, above = int((costs <= 1.05 * best).sum()), int((costs > experts).sum())
            found["found"].append(
                f"| {mission} | {len(own['excess_s'])} | {best:.1f} s | {experts:.1f} s | {near} of {len(told)} "
                f"| {costs.max() / best:.2f} | {above} | {minutes} |"
            )
        if told:
            worth, starts = sum(one["worth_it"] for one in told), [one["starts"] for one in told]
            span = f"{min(starts)} to {max(starts)}" if min(starts) < max(starts) else f"{starts[0]}"
            found["worth"].append(f"| {mission} | {len(told)} | {worth} | {len(told) - worth} | {span} | {minutes} |")
    return {name: "\n".join(lines) for name, lines in found.items()}


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=("all", "repeat", "table"))
    parser.add_argument("missions", nargs="*")
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seeds", type=int, default=20)
    given = parser.parse_args()
    if given.what == "table":
        for mark, table in tables(json.loads(RESULTS.read_text(encoding="utf-8"))).items():
            record(f"tutorials/advise/{mark}", table, f"{COMMAND} table", [RESULTS.relative_to(ROOT).as_posix()])
    for mission in given.missions:
        kept = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
        own = kept.get(mission, {})
        if given.what == "all":
            new = exhaustive(mission)
        else:
            new = {"minutes": given.minutes, "advice": repeated(mission, given.minutes, range(1, given.seeds + 1), own)}
        kept = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
        kept[mission] = {**own, **new}
        RESULTS.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
