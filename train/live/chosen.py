"""What `clean-swarm play` plays: a mission, a family, or a recording of an earlier play, by name or by path."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.recording.file import SUFFIX
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.find import files_of
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.live.session import Play, again, with_room

STRATEGY = "MaxScore"
"""The strategy unless another one is named."""


def chosen(name: str, number: int, seed: int, strategy: str | None, directories: tuple[Path, ...]) -> Play:
    """Return what is played: scenario `number`, from 1 on, of a mission or a family, or a recording of a play.

    Raises:
        ConfigurationError: there is nothing of this name, or it cannot be played.

    """
    if name.endswith(SUFFIX):
        if strategy is not None:
            raise ConfigurationError("--strategy: expected none, because the recording says who chose")
        return again(RecordedMission(Path(name)))
    scenario = _scenario(name, number, seed, directories)
    room = replace(scenario, mission=with_room(scenario.mission))
    return Play(Path(name).stem, room, strategy or STRATEGY, None, directories)


def _scenario(name: str, number: int, seed: int, directories: tuple[Path, ...]) -> Scenario:
    missions, families = files_of("missions", directories), files_of("families", directories)
    path = Path(name)
    if path.suffix in (".yaml", ".yml"):
        of_family = "mission" in read_mapping(path)
    elif name in missions or name in families:
        of_family = name not in missions
    else:
        raise ConfigurationError(f"play: {unknown('mission or family', name, sorted({*missions, *families}))}")
    if of_family:
        return load_family(name, directories).scenario(seed, number - 1, "test")
    mission = load_mission(name, directories)
    start = random_start(mission, seed, number - 1)
    return Scenario(start.id, run_seed(seed, start.id), mission, start)
