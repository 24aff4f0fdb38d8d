"""Records and experiments for the tests, small and by hand."""

import zlib
from collections.abc import Sequence

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.world.mission import MissionResult
from train.running.runs import RunRecord


def record(scenario: str = "1", condition: str = "a", duration: float = 10.0, **changes) -> RunRecord:
    figures = {
        "completed": True,
        "duration_s": duration,
        "collision_samples_per_s": (duration / 10, duration / 5),
        "collision_events_per_s": (duration / 100, duration / 50),
        "garbage_done": 10,
        "items_per_min": 3.0,
        "cost_s": 250.0,
        "unavoidable_s": 0.0,
        "robots": 5,
        "ticks": 50,
    }
    return RunRecord("x", scenario, 3, condition, MissionResult(**(figures | changes)), wall_s=0.25)


def experiment(conditions: Sequence[str] = ("a", "b"), scenarios: int = 3, **changes) -> ExperimentConfig:
    """Conditions by name; a capital letter is the name of what was measured for a condition."""
    starts = [
        StartConfiguration(id=str(k + 1), robots=((1.0, 1.0, 0.0),), items=((2.0, 2.0),)) for k in range(scenarios)
    ]
    return ExperimentConfig.model_validate(
        {
            "name": "x",
            "conditions": [{"name": name, "measured": name.upper()} for name in conditions],
            "starts": starts,
            **changes,
        }
    )


def checksums(recording):
    """Return the CRC-32 of the whole numbers (T, K) of each channel, as int32 in little-endian order."""
    return {name: zlib.crc32(recording.whole(name).astype("<i4").tobytes()) for name in recording}
