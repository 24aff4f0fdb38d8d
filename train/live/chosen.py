"""What `clean-swarm play` plays: a mission, a family, a goal, or a recording of an earlier play, by name or by path."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.recording.file import SUFFIX
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.scenes import goals
from selector.documents.find import files_of
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.deciders.named import FIXED
from train.live.goals import PlayedGoal, goal_again
from train.live.missions import PlayedMission, mission_again, with_room
from train.live.session import Played

STRATEGY = "MaxScore"
"""The strategy of missions unless another one is named."""


def chosen(name: str, number: int, seed: int, strategy: str | None, directories: tuple[Path, ...]) -> Played:
    """Return what is played: scenario `number`, from 1 on, of a mission, family or goal, or a recording of a play.

    Raises:
        ConfigurationError: there is nothing of this name, or it cannot be played.

    """
    if name.endswith(SUFFIX):
        if strategy is not None:
            raise ConfigurationError("--strategy: expected none, because the recording says who chose")
        return again(RecordedMission(Path(name)))
    if name in goals():
        if strategy is not None and not strategy.startswith(f"{FIXED}:"):
            raise ConfigurationError(f"--strategy: expected {FIXED}:OPTION for a goal, got {strategy!r}")
        option = strategy and strategy.removeprefix(f"{FIXED}:")
        return PlayedGoal(name, option, seed + number - 1, directories)
    scenario = _scenario(name, number, seed, directories)
    room = replace(scenario, mission=with_room(scenario.mission))
    return PlayedMission(Path(name).stem, room, strategy or STRATEGY, None, directories)


def again(recording: RecordedMission) -> Played:
    """Return the play that a recording is of, with all that was done by hand.

    Raises:
        ConfigurationError: the recording is of something else, or files on which the course depends have changed.

    """
    told = recording.head["about"].get("play")
    if not isinstance(told, dict):
        raise ConfigurationError(f"{recording.path}: expected a recording of `clean-swarm play`, got one of a mission")
    return goal_again(recording) if "start" not in told else mission_again(recording)


def playable(directories: tuple[Path, ...]) -> list[str]:
    """Return the names of all missions, families and goals."""
    return sorted({*files_of("missions", directories), *files_of("families", directories), *goals()})


def _scenario(name: str, number: int, seed: int, directories: tuple[Path, ...]) -> Scenario:
    missions, families = files_of("missions", directories), files_of("families", directories)
    path = Path(name)
    if path.suffix in (".yaml", ".yml"):
        of_family = "mission" in read_mapping(path)
    elif name in missions or name in families:
        of_family = name not in missions
    else:
        raise ConfigurationError(f"play: {unknown('mission, family or goal', name, playable(directories))}")
    if of_family:
        return load_family(name, directories).scenario(seed, number - 1, "test")
    mission = load_mission(name, directories)
    start = random_start(mission, seed, number - 1)
    return Scenario(start.id, run_seed(seed, start.id), mission, start)
