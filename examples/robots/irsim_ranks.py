"""Do ranks of strategies survive a change of the simulator? The same missions in ours and in IR-SIM.

    python -m examples.robots.irsim_ranks examples/robots/irsim_ranks.yaml 40
    python -m examples.robots.irsim_ranks examples/robots/irsim_ranks.yaml

A number is the minutes for which it does missions; their figures are kept in a file beside the plan. Without one it
only prints the tables of the missions that are done. Needs IR-SIM (`irsim_bodies.py`).
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import kendalltau

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.robots.process import RobotProcess
from examples.robots.bodies import ServedBodies, tick_together
from examples.robots.irsim_bodies import BOTH, IrsimBodies
from selector.documents.reading import read_mapping
from selforg.arrays import Floats

SIMULATORS = {"ours": ServedBodies, "IR-SIM": IrsimBodies}
RESAMPLES = 2_000


def main(plan_file: Path, minutes: float) -> None:
    """Do missions of a plan for some minutes, and print the tables of all that are done."""
    plan, file = read_mapping(plan_file), plan_file.with_suffix(".jsonl")
    done = {tuple(one["key"]): one for one in map(json.loads, file.read_text().splitlines())} if file.exists() else {}
    until = time.monotonic() + 60.0 * minutes
    with file.open("a") as lines:
        for key in keys_of(plan):
            if key in done:
                continue
            if time.monotonic() > until:
                break
            done[key] = {"key": key, **run(plan, *key)}
            lines.write(json.dumps(done[key]) + "\n")
            lines.flush()
    print_tables(plan, done)


def keys_of(plan: dict[str, Any]) -> Iterator[tuple[int, str, str, str]]:
    """Return start, mission, strategy and simulator of each mission, in their order."""
    for start in range(plan["starts"]):
        for mission in plan["missions"]:
            for strategy in plan["strategies"]:
                for simulator in SIMULATORS:
                    yield start, mission, strategy, simulator


def run(plan: dict[str, Any], number: int, name: str, strategy: str, simulator: str) -> dict[str, Any]:
    """Do one mission by processes of robots in lock step; return its figures."""
    given = dict(plan["missions"][name])
    best = given.pop("best")
    member = plan["strategies"][strategy]
    member = f"fixed:{best}" if member == "best" else member
    mission = MissionConfig.model_validate({"name": name, **given, **plan["common"]})
    start, seed = random_start(mission, plan["seed"], number), plan["seed"] + number
    began = time.process_time()
    bodies = SIMULATORS[simulator](mission, start, seed=seed)
    robots = [RobotProcess(mission, row, member, goal=BOTH, start=start, seed=seed) for row in range(mission.rows)]
    while bodies.running:
        tick_together(bodies, robots)
    result = bodies.result
    figures = {"cost": result.cost_s, "duration": result.duration_s, "completed": result.completed}
    events = int(bodies.worlds.collisions.events[0, 0])
    return {**figures, "events": events, "cpu": round(time.process_time() - began, 2)}


def print_tables(plan: dict[str, Any], done: dict[Any, dict[str, Any]]) -> None:
    """Print mean costs and ranks of strategies in both simulators, and how well the ranks agree."""
    strategies, missions = list(plan["strategies"]), list(plan["missions"])
    each = len(missions) * len(strategies) * len(SIMULATORS)
    whole = [k for k in range(plan["starts"]) if sum(key[0] == k for key in done) == each]
    print(f"{len(whole)} starts of each mission; cost in s (rank), s a mission, collision events, finished\n")
    if not whole:
        return

    def table(what: str, mission: str, simulator: str) -> Floats:
        rows = [[done[k, mission, one, simulator][what] for k in whole] for one in strategies]
        return np.array(rows, dtype=np.float64)

    for mission in missions:
        print(f"| {mission} | " + " | ".join(SIMULATORS) + " |\n|---|---:|---:|")
        means = {one: table("cost", mission, one).mean(axis=1) for one in SIMULATORS}
        ranks = {one: own.argsort().argsort() + 1 for one, own in means.items()}
        for row, strategy in enumerate(strategies):
            cells = []
            for one in SIMULATORS:
                figures = (table(what, mission, one)[row].mean() for what in ("duration", "events", "completed"))
                duration, events, finished = figures
                told = f"{means[one][row]:.0f} ({ranks[one][row]}), {duration:.0f}, {events:.1f}, {finished:.0%}"
                cells.append(told)
            print(f"| {strategy} | " + " | ".join(cells) + " |")
        print()
    rng = np.random.default_rng(0)
    costs = {(mission, one): table("cost", mission, one) for mission in missions for one in SIMULATORS}
    for group in [[mission] for mission in missions] + [missions]:
        drawn = rng.integers(len(whole), size=(RESAMPLES, len(whole)))
        taus = [agreement(costs, group, chosen) for chosen in drawn]
        low, high = np.nanquantile(taus, (0.025, 0.975))
        tau = agreement(costs, group, np.arange(len(whole)))
        print(f"Kendall's tau, {', '.join(group)}: {tau:.2f} [{low:.2f}, {high:.2f}] (starts drawn again)")


def agreement(costs: dict[tuple[str, str], Floats], missions: list[str], chosen: Any) -> float:  # noqa: ANN401
    """Return the mean over missions of Kendall's tau of the mean costs of chosen starts in both simulators."""
    taus = []
    for mission in missions:
        ours, other = (costs[mission, one][:, chosen].mean(axis=1) for one in SIMULATORS)
        taus.append(float(kendalltau(ours, other).statistic))
    return float(np.mean(taus))


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 0.0)
