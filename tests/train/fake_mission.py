"""A mission in no time: figures drawn from the seed, with the shape of the real ones. Also a command line on it."""

import os
import signal
import time
import zlib
from pathlib import Path

import numpy as np

from clean_swarm_env.world.mission import MissionResult


def run_mission(mission, start, seed, scores, *_):
    """Draw a result from seed and scores; FAKE_SECONDS is its wall time, FAKE_LOG a file that gets a line per run."""
    time.sleep(float(os.environ.get("FAKE_SECONDS", "0")))
    if "FAKE_LOG" in os.environ:
        with Path(os.environ["FAKE_LOG"]).open("a") as log:
            log.write(f"{start.id}\n")
    options = scores.get("AvoidCollision", {})
    best = max(options, key=options.__getitem__, default="")
    rng = np.random.default_rng([seed, zlib.crc32(best.encode())])
    duration = float(rng.lognormal(6.0 if best == "RepulsionFernandez-view2.0" else 5.3, 0.4))
    completed = duration < mission.time_limit
    rates = tuple(float(d * rng.gamma(4.0, 0.5)) for d in mission.collision_distances)
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


def run_mission_but_not_2(mission, start, seed, scores, *_):
    """Fail on scenario 2."""
    if start.id == "2":
        raise ZeroDivisionError("scenario 2")
    return run_mission(mission, start, seed, scores)


def run_mission_but_die_on_2(mission, start, seed, scores, *_):
    """End the process by a signal on scenario 2."""
    if start.id == "2":
        os.kill(os.getpid(), signal.SIGKILL)
    return run_mission(mission, start, seed, scores)


if __name__ == "__main__":
    # spawned workers find the function by this module's name, not by __main__
    from tests.train import fake_mission
    from train.cli import main
    from train.evaluation import trial_task

    trial_task.run_mission = fake_mission.run_mission
    main()
