"""The cost of recordings beside the same missions without, and the sizes of their files.

    python -m benchmarks.recordings.recording

One process, CPU time, by turns, three seconds and more each. Twenty robots: one mission of an hour in which garbage
keeps coming, and thirty missions of the family `crowded` in one batch, ten minutes each, as `evaluate` runs them. A
thousand robots for two minutes. Sizes are for ten minutes.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from benchmarks.shared.measuring import by_turns, middle, ratio
from benchmarks.shared.record import record
from benchmarks.shared.scenes import SEED, mission_of
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.load import load_family, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.recording.mission_recording import record_mission
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission import MissionRun, run_mission
from selector.strategies.registry import StrategySpec
from train.evaluation.trial_task import TrialTask

OPTION = "RepulsionGradient-from0.25"
MANY = 1000
MANY_MINUTES, LONG_MINUTES = 2, 60
TOGETHER = 30
REPEATS = 7
MODES = ("without", "recorded", "with minds")


def alone(scenario: Scenario, mode: str, folder: Path) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of one mission."""
    known = scenario.mission.knowledge == "avoidance"
    strategy = StrategySpec(name="Fixed", parameters={"option": OPTION}) if known else StrategySpec(name="MaxScore")
    run = MissionRun(scenario.mission, scenario.start, scenario.seed, {}, strategy)
    settings = RecordSettings(folder, minds=mode == MODES[2], name=f"{run.mission.robots.count} {mode}")

    def spent() -> float:
        begin = process_time()
        if mode == MODES[0]:
            run_mission(run.mission, run.start, run.seed, run.scores, run.strategy)
        else:
            record_mission(run, settings, {})
        return process_time() - begin

    return spent


def together(mode: str, folder: Path) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of missions under the policy `general`."""
    places = tuple((k, 0) for k in range(TOGETHER))
    task = TrialTask(load_family("crowded"), 0, places, "policy", "policy:general", "AvoidCollision", ())
    wanted = task if mode == MODES[0] else task.recorded(RecordSettings(folder / mode, minds=mode == MODES[2]))

    def spent() -> float:
        begin = process_time()
        wanted.run()
        return process_time() - begin

    return spent


def long() -> Scenario:
    """Return a long mission of twenty robots, in which garbage keeps coming."""
    scenario = load_family("crowded").scenario(0, 0, "test")
    changes = {"time_limit": 60.0 * LONG_MINUTES, "garbage": {"respawn": 5.0}}
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
            "one mission of 20 robots": {mode: alone(long(), mode, folder) for mode in MODES},
            f"{TOGETHER} missions of 20 robots": {mode: together(mode, folder) for mode in MODES},
            f"{MANY} robots": {mode: alone(many(), mode, folder) for mode in MODES[:2]},
        }
        for title, contestants in contests.items():
            repeats = by_turns(contestants, REPEATS)
            figures[title] = {"seconds without": middle(repeats[MODES[0]])}
            for mode in list(contestants)[1:]:
                figures[title][f"more CPU, {mode}"] = ratio(repeats[mode], repeats[MODES[0]]).value - 1.0
        size = {path.stem: path.stat().st_size / 1e6 for path in folder.glob("*.swarm")}
        figures["one mission of 20 robots"]["MB with minds"] = size["20 with minds"] * 10.0 / LONG_MINUTES
        figures[f"{MANY} robots"]["MB"] = size[f"{MANY} recorded"] * 10.0 / MANY_MINUTES
    for title, values in figures.items():
        print(title, {key: round(value, 3) for key, value in values.items()})
    record("recording", figures)


if __name__ == "__main__":
    main()
