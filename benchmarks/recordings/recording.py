"""The cost of recordings beside the same missions without, and the sizes of their files.

    python -m benchmarks.recordings.recording

One process, CPU time, some seconds each. Twenty robots: one mission of an hour in which garbage keeps coming, and ten
missions of the family `crowded` in one batch, ten minutes each, as `evaluate` runs them. A thousand robots for two
minutes. Single missions take turns after each block of control periods, so that a busy machine slows all alike. Sizes
are for ten minutes.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from benchmarks.shared.measuring import by_turns
from benchmarks.shared.record import record
from benchmarks.shared.scenes import SEED, mission_holding, mission_of
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.load import load_family, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import mission_begun
from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from train.running.trial_task import TrialTask

OPTION = "RepulsionGradient-from0.25"
MANY = 1000
MANY_MINUTES, LONG_MINUTES = 2, 60
TOGETHER = 10
BLOCK = 100
"""Control periods from turn to turn."""
REPEATS = 7
MODES = ("without", "recorded", "with minds")


class Going:
    """A mission that goes on block by block, recorded or not."""

    def __init__(self, scenario: Scenario, mode: str, folder: Path) -> None:
        known = scenario.mission.knowledge == "avoidance"
        minds, name = mode == MODES[2], f"{scenario.mission.robots.count} {mode}"
        begin = partial(mission_holding, OPTION) if known else mission_begun
        self.batch = begin(scenario.mission, scenario.start, scenario.seed, explained=minds)
        self.recorder = None
        if mode != MODES[0]:
            settings = RecordSettings(folder, minds=minds, name=name, thinking=True)
            self.recorder = MissionRecorder(self.batch.worlds, settings)
            self.recorder.open(0, {"scenario": name})

    def block(self) -> float:
        """Run a block of control periods; return the CPU seconds."""
        begin = process_time()
        for _ in range(BLOCK):
            self.batch.tick()
            if self.recorder is not None:
                self.recorder.record()
        return process_time() - begin


def by_blocks(scenario: Scenario, modes: Sequence[str], folder: Path) -> dict[str, list[float]]:
    """Return the CPU seconds of each block of a mission in some modes, which take turns; the first one is left out."""
    going = {mode: Going(scenario, mode, folder) for mode in modes}
    blocks = round(scenario.mission.time_limit * scenario.mission.world.control_rate) // BLOCK
    return by_turns({mode: one.block for mode, one in going.items()}, blocks - 1)


def together(mode: str, folder: Path) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of missions under the policy `exploring-ppo`."""
    family, member = load_family("crowded-exploring"), "policy:exploring-ppo"
    scenarios = tuple(family.scenario(0, k, "test") for k in range(TOGETHER))
    task = TrialTask(family.name, 0, scenarios, "policy", member, "ExplorationPatrol")
    wanted = task if mode == MODES[0] else replace(task, record=RecordSettings(folder / mode, minds=mode == MODES[2]))

    def spent() -> float:
        begin = process_time()
        wanted.run()
        return process_time() - begin

    return spent


def long() -> Scenario:
    """Return a long mission of twenty robots, in which garbage keeps coming."""
    scenario = load_family("crowded").scenario(0, 0, "test")
    changes = {"time_limit": 60.0 * LONG_MINUTES, "task": {"garbage": {"respawn": 5.0}}}
    mission = MissionConfig.model_validate(with_changes(scenario.mission.model_dump(), changes))
    return replace(scenario, mission=mission)


def many() -> Scenario:
    """Return a mission of a thousand robots."""
    mission = mission_of(MANY).model_copy(update={"time_limit": 60.0 * MANY_MINUTES})
    return Scenario("many", SEED, mission, random_start(mission, SEED, 0))


def main() -> None:
    """Measure, print and keep the figures."""
    figures: dict[str, dict[str, float]] = {}
    with TemporaryDirectory() as name:
        folder = Path(name)
        contests = {
            "one mission of 20 robots": by_blocks(long(), MODES, folder),
            f"{TOGETHER} missions of 20 robots": by_turns({mode: together(mode, folder) for mode in MODES}, REPEATS),
            f"{MANY} robots": by_blocks(many(), MODES[:2], folder),
        }
        for title, spent in contests.items():
            plain = sum(spent[MODES[0]])
            figures[title] = {"seconds without": plain}
            for mode in list(spent)[1:]:
                figures[title][f"more CPU, {mode}"] = sum(spent[mode]) / plain - 1.0
        size = {path.stem: path.stat().st_size / 1e6 for path in folder.glob("*.swarm")}
        figures["one mission of 20 robots"]["MB with minds"] = size["20 with minds"] * 10.0 / LONG_MINUTES
        figures[f"{MANY} robots"]["MB"] = size[f"{MANY} recorded"] * 10.0 / MANY_MINUTES
    for title, values in figures.items():
        print(title, {key: round(value, 3) for key, value in values.items()})
    record("recording", figures)


if __name__ == "__main__":
    main()
