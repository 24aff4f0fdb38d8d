"""Processes whose radio loses, delays and repeats broadcasts, beside the same losses and delay in one process.

    python -m examples.robots.bad_radio table1 MaxScore 20

The radio draws for itself: each robot misses 30 % of the broadcasts, hears others 0.4 s late, and a fifth of them once
more, 0.2 s after that. In one process the mission's `delivery` has the same loss and delay. Bodies keep lock step.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.given import mission_from
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Broadcast
from examples.robots.air import MissionAir
from examples.robots.bad_reception import BadReception, Faults
from examples.robots.bodies import ServedBodies, tick_together
from train.analysis.intervals import Estimate
from train.running.trial_task import TrialTask

FAULTS = Faults(loss=0.3, delay=0.4, twice=0.2)


class BadRadio(MissionAir):
    """Brings each broadcast as a whole to each other robot: not at all, late, or twice."""

    def __init__(self, bodies: ServedBodies, seed: int) -> None:
        super().__init__(bodies.worlds)
        rng = np.random.default_rng(seed)
        self._receptions = [BadReception(FAULTS, rng) for _ in range(bodies.worlds.rows)]

    def carry_left(self, told: Sequence[Broadcast], robots: Sequence[RobotProcess]) -> None:
        """Send what robots left in the control period before."""
        for reception in self._receptions:
            for one in told:
                reception.send(one, self._worlds.now)

    def carry_said(self, said: Sequence[Broadcast], robots: Sequence[RobotProcess]) -> None:
        """Send what robots say now, and let them hear what has come."""
        self.carry_left(said, robots)
        for robot, reception in zip(robots, self._receptions, strict=True):
            for one in reception.heard(self._worlds.now):
                if one.robot != robot.name:
                    robot.hear(one)


def by_processes(scenario: Scenario, strategy: str) -> tuple[float, int]:
    """Return the cost of a mission by processes [s], and how many broadcasts did not count."""
    mission, start, seed = scenario.mission, scenario.start, scenario.seed
    bodies = ServedBodies(mission, start, seed)
    bodies.air = BadRadio(bodies, seed)
    robots = [RobotProcess(mission, row, strategy, start=start, seed=seed) for row in range(mission.rows)]
    while bodies.running:
        tick_together(bodies, robots)
    return bodies.result.cost_s, sum(robot.ear.refused.total() for robot in robots)


def in_one_process(scenarios: Sequence[Scenario], strategy: str) -> list[float]:
    """Return the costs of missions [s]."""
    return [run.result.cost_s for run in TrialTask("radio", 0, tuple(scenarios), "", strategy).run()]


def scenarios_of(name: str, count: int, loss: float, delay: float) -> list[Scenario]:
    """Return the starts of a mission with losses and a delay."""
    changes = {"delivery": {"loss": loss, "delay": delay, "own_contents": True}}
    mission: MissionConfig = mission_from({"base": name, **changes})
    return [Scenario(f"{k}", k, mission, random_start(mission, 0, k)) for k in range(count)]


def main(name: str, strategy: str, count: int) -> None:
    """Print the mean costs of missions by processes and in one process, also without losses."""
    lossy, exact = scenarios_of(name, count, FAULTS.loss, FAULTS.delay), scenarios_of(name, count, 0.0, 0.0)
    found = [by_processes(one, strategy) for one in lossy]
    costs, refused = np.array([cost for cost, _ in found]), sum(number for _, number in found)
    alone = np.array(in_one_process(lossy, strategy))
    rows = {"by processes": costs, "in one process": alone, "differences": costs - alone}
    rows["in one process, nothing lost"] = np.array(in_one_process(exact, strategy))
    for what, values in rows.items():
        mean = Estimate.of(values[None])
        low, high = mean.ci95 or (np.nan, np.nan)
        print(f"{what}: {mean.value:.1f} s [{low:.1f}, {high:.1f}]")
    print(f"{refused} broadcasts did not count")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
