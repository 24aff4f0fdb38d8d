"""A mission in no time: figures drawn from the seed, with the shape of the real ones. Also a command line on it."""

import os
import signal
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clean_swarm_env.world.mission import MissionResult
from train.running.trial_task import TrialTask


def trials(scenarios, *_):
    """Do fake missions."""
    for place, scenario in enumerate(scenarios):
        yield place, result_of(scenario)


def result_of(scenario):
    """Draw a result from seed and scores; FAKE_SECONDS is its wall time, FAKE_LOG a file that gets a line per run."""
    mission, start = scenario.mission, scenario.start
    time.sleep(float(os.environ.get("FAKE_SECONDS", "0")))
    if "FAKE_LOG" in os.environ:
        with Path(os.environ["FAKE_LOG"]).open("a") as log:
            log.write(f"{start.id}\n")
    options = mission.scores.get("AvoidCollision", {})
    best = max(options, key=options.__getitem__, default="")
    rng = np.random.default_rng([scenario.seed, zlib.crc32(best.encode())])
    duration = float(rng.lognormal(6.0 if best == "RepulsionFernandez-view2.0" else 5.3, 0.4))
    completed = duration < mission.time_limit
    rates = tuple(float(d * rng.gamma(4.0, 0.5)) for d in mission.counted_distances)
    return MissionResult(
        completed,
        min(duration, mission.time_limit),
        rates,
        tuple(rate / 20 for rate in rates),
        len(start.items) if completed else 0,
        len(start.robots),
        int(duration * mission.world.control_rate),
        60.0 * len(start.items) / duration,
        2.0 * duration,
        0.0,
    )


def trials_but_not_2(scenarios, *_):
    """Fail on scenario 2."""
    for place, scenario in enumerate(scenarios):
        if scenario.id == "2":
            raise ZeroDivisionError("scenario 2")
        yield place, result_of(scenario)


def trials_but_die_on_2(scenarios, *_):
    """End the process by a signal on scenario 2."""
    for place, scenario in enumerate(scenarios):
        if scenario.id == "2":
            os.kill(os.getpid(), signal.SIGKILL)
        yield place, result_of(scenario)


@dataclass(frozen=True)
class FakeTask(TrialTask):
    """Missions that a function does, in workers, too."""

    trials: Callable[..., Iterator[tuple[int, MissionResult]]] = field(default=trials, kw_only=True)

    def each(self):
        """Yield the missions as soon as they are done."""
        for place, result in self.trials(self.scenarios):
            yield self.finished(self.scenarios[place], result, 0.0)


if __name__ == "__main__":
    # spawned workers find the class by this module's name, not by __main__
    from tests.train import fake_mission
    from train.cli import main
    from train.evaluation import comparison

    comparison.TrialTask = fake_mission.FakeTask
    main()
