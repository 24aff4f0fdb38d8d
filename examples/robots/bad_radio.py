"""Processes whose radio loses, delays and repeats broadcasts, beside the same losses and delay in one process.

    python -m examples.robots.bad_radio table1 MaxScore 20

The radio draws for itself: each robot misses 30 % of the broadcasts, hears others 0.4 s late, and a fifth of them once
more, 0.2 s after that, unless told otherwise. In one process the mission's `delivery` has the same loss and delay.
Bodies keep lock step. After Ctrl-C the means are of what is done.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

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
from examples.robots.command_words import number, words_of
from selector.documents.errors import DocumentError
from selforg.arrays import Floats
from train.analysis.intervals import Estimate
from train.running.trial_task import TrialTask


class BadRadio(MissionAir):
    """Brings each broadcast as a whole to each other robot: not at all, late, or twice."""

    def __init__(self, bodies: ServedBodies, faults: Faults, seed: int) -> None:
        super().__init__(bodies.worlds)
        rng = np.random.default_rng(seed)
        self._receptions = [BadReception(faults, rng) for _ in range(bodies.worlds.rows)]

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


def by_processes(scenario: Scenario, strategy: str, faults: Faults) -> tuple[float, int]:
    """Return the cost of a mission by processes [s], and how many broadcasts did not count."""
    mission, start, seed = scenario.mission, scenario.start, scenario.seed
    bodies = ServedBodies(mission, start, seed)
    bodies.air = BadRadio(bodies, faults, seed)
    robots = [RobotProcess(mission, row, strategy, start=start, seed=seed) for row in range(mission.rows)]
    while bodies.running:
        tick_together(bodies, robots)
    return bodies.result.cost_s, sum(robot.ear.refused.total() for robot in robots)


def in_one_process(scenario: Scenario, strategy: str) -> float:
    """Return the cost of a mission [s]."""
    (run,) = TrialTask("radio", 0, (scenario,), "", strategy).run()
    return run.result.cost_s


def starts_of(name: str, loss: float, delay: float) -> Callable[[int], Scenario]:
    """Return the starts of a mission with losses and a delay, by their numbers."""
    changes = {"delivery": {"loss": loss, "delay": delay, "own_contents": True}}
    mission: MissionConfig = mission_from({"base": name, **changes})
    return lambda number: Scenario(f"{number}", number, mission, random_start(mission, 0, number))


def compare(given: argparse.Namespace) -> None:
    """Print the mean costs of missions by processes and in one process, also without losses."""
    faults = Faults(given.loss, given.delay, given.twice)
    lossy, exact = starts_of(given.mission, given.loss, given.delay), starts_of(given.mission, 0.0, 0.0)
    found = []
    try:
        for k in range(given.starts):
            costs = by_processes(lossy(k), given.strategy, faults)
            found.append((*costs, in_one_process(lossy(k), given.strategy), in_one_process(exact(k), given.strategy)))
            print(f"{k + 1} of {given.starts} starts", file=sys.stderr)
    except KeyboardInterrupt:
        print(f"stopped after {len(found)} of {given.starts} starts", file=sys.stderr)
    if found:
        show(np.array(found))


def show(found: Floats) -> None:
    """Print the means of (K, 4): by processes [s], broadcasts, in one process [s], and there with nothing lost [s]."""
    costs, refused, alone, exact = found.T
    rows = {"by processes": costs, "in one process": alone, "differences": costs - alone}
    for what, values in {**rows, "in one process, nothing lost": exact}.items():
        mean = Estimate.of(values[None])
        interval = " [{:.1f}, {:.1f}]".format(*mean.ci95) if mean.ci95 else ""
        print(f"{what}: {mean.value:.1f} s{interval}")
    print(f"{refused.sum():.0f} broadcasts did not count")


def main() -> int:
    """Read the command and run it."""
    words = words_of("python -m examples.robots.bad_radio", "Missions over a bad radio, by processes and in one.")
    words.add_argument("mission", help="a mission's name or file")
    words.add_argument("strategy", help="what chooses options, as in evaluate")
    words.add_argument("starts", type=number(1, 10_000, int), help="how many")
    words.add_argument("--loss", type=number(0.0, 0.99), default=0.3, help="share of broadcasts that a robot misses")
    words.add_argument("--delay", type=number(0.0, 60.0), default=0.4, help="until it hears the others [s]")
    words.add_argument("--twice", type=number(0.0, 1.0), default=0.2, help="share of these that it hears once more")
    try:
        compare(words.parse_args())
        sys.stdout.flush()
    except (DocumentError, OSError) as wrong:
        print(f"bad_radio: {wrong}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
