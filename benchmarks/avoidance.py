"""Costs of the ways of avoiding in missions of few and many robots, beside a rule on the observation.

    python -m benchmarks.avoidance [SCENARIOS]

Solid robots on 11 m x 11 m, 10 items, time limit 600 s, the options of `knowledge/avoidance.yaml`; the scenarios
are the same for all. The rule uses only the situation: with cargo or without, within 2 m of a station or not. The
interval is that of the paired difference to the best single option (Student's, 95 %).
"""

import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.interface import Finished
from clean_swarm_env.learning.observation.term import TERMS

SEED = 900
TEAMS = (5, 10, 20)
TIME_LIMIT = 600.0  # [s]
FREE, CARRYING_FAR, CARRYING_NEAR = (
    "RepulsionFernandez-view1.5",
    "RepulsionGradient-from0.25",
    "RepulsionFernandez-view0.5",
)
Options = NDArray[np.int64]
Choice = Callable[[NDArray[np.float32]], Options]


def mission_of(robots: int) -> MissionConfig:
    """Return the default mission with the options for learners."""
    changes = {"robots": {"count": robots}, "knowledge": "avoidance", "time_limit": TIME_LIMIT}
    return MissionConfig.model_validate(with_changes(load_mission("table1").model_dump(), changes))


def ends_of(choose: Choice, robots: int, scenarios: int) -> list[Finished]:
    """Return the ends of missions in which `choose` gives options (R,) by the situations (R, 4) of the robots."""
    batch = Batch(mission_of(robots), scenarios, begin_anew=False)
    batch.reset(list(range(SEED, SEED + scenarios)))
    columns = [batch.observer.names.index(name) for name in TERMS.find("situation").components]
    ends: list[Finished] = []
    while len(ends) < scenarios:
        batch.step(choose(batch.observations[:, columns]))
        ends += batch.finished
    return sorted(ends, key=lambda end: end.world)


def choices() -> dict[str, Choice]:
    """Return the rule and every single option."""
    options = Batch(mission_of(1)).options[AVOIDANCE]
    rule = np.array([options.index(name) for name in (FREE, FREE, CARRYING_FAR, CARRYING_NEAR)])
    singles: dict[str, Choice] = {name: lambda seen, k=k: np.full(len(seen), k) for k, name in enumerate(options)}
    return {"rule": lambda seen: rule[seen.argmax(axis=1)], **singles}


def main() -> None:
    """Print the table."""
    scenarios = int(sys.argv[1]) if len(sys.argv) > 1 else 24
    for robots in TEAMS:
        costs = {}
        print(f"{robots} robots, {scenarios} scenarios{'time s':>19}{'events':>8}{'cost s':>8}{'completed':>11}")
        for name, choose in choices().items():
            ends = ends_of(choose, robots, scenarios)
            costs[name] = np.array([end.result.cost_s for end in ends])
            time, events = (
                np.mean([end.result.duration_s for end in ends]),
                np.mean([end.collision_events for end in ends]),
            )
            completed = np.mean([end.result.completed for end in ends])
            print(f"  {name:34}{time:10.1f}{events:8.1f}{costs[name].mean():8.1f}{completed:11.0%}", flush=True)
        best = min((name for name in costs if name != "rule"), key=lambda name: costs[name].mean())
        less = costs["rule"] - costs[best]
        low, high = stats.t.interval(0.95, len(less) - 1, less.mean(), stats.sem(less))
        print(f"  rule - {best}: {less.mean():.1f} s [{low:.1f}, {high:.1f}]")


if __name__ == "__main__":
    main()
