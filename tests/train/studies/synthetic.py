"""Missions in no time: costs with the noise of real ones around a planted optimum."""

import math
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.world.mission import MissionResult
from train.running.runs import RunRecord, under
from train.studies.missions import STAGES, stage_seeds

NOISE = 0.2
"""Standard deviation of the logarithm of the cost of one option, as on `random` (docs/tuning.md)."""
OPTIMUM = {"view_distance": 0.9, "presence_threshold": 0.03, "full_length": 2.0}
SPANS = {"view_distance": 2.4, "presence_threshold": math.log(1000.0), "full_length": 4.8}


def regret(option) -> float:
    """Return how much more the option of a candidate costs than the optimum, as a share."""
    given = {**OPTIMUM, **option["parameters"]}
    distances = {
        name: (math.log(given[name] / best) if name == "presence_threshold" else given[name] - best) / SPANS[name]
        for name, best in OPTIMUM.items()
    }
    return 4.0 * sum(distance**2 for distance in distances.values())


@dataclass(frozen=True)
class SyntheticTask:
    """Some scenarios of one candidate, which are noted in the file `log`."""

    stage: str
    name: str
    excess: float
    numbers: tuple[int, ...]
    log: str = ""
    rate: float = 0.1

    def each(self):
        for number in self.numbers:
            if self.log:
                with Path(self.log).open("a") as file:
                    file.write(f"{self.stage} {self.name} {number}\n")
            words = [STAGES.index(self.stage), zlib.crc32(f"{self.name} {self.excess}".encode()), number]
            cost = 20.0 * (1.0 + self.excess) * float(np.exp(np.random.default_rng(words).normal(0.0, NOISE)))
            events, avoiding = (self.rate * cost / 20.0,) * 2, min(round(self.excess * 2500.0), 10_000)
            result = MissionResult(True, min(0.8 * cost, 200.0), (0.0, 0.0), events, 10, 2, 500, 1.0, cost, 0.0)
            yield RunRecord(
                "small",
                scenario_name("train", number),
                stage_seeds(3)[self.stage],
                under(self.stage, self.name),
                result,
                0.0,
                counts={"decisions": 10_000, "avoiding": avoiding},
            )


def synthetic(stage, candidate, numbers, log="") -> SyntheticTask:
    """Return the task of a candidate of the goal AvoidCollision."""
    return SyntheticTask(stage, candidate.name, regret(candidate.goals["AvoidCollision"][0]), numbers, log)
