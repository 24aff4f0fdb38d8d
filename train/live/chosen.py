"""What `clean-swarm play` plays: a mission, a family, a task, or a recording of an earlier play, by name or by path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Any

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.config.known import knowing, knowledge_of
from clean_swarm_env.config.load import load_named
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.config.task_names import KIND_WORDS, task_names
from clean_swarm_env.config.tasks import item_rows, with_changes, with_items
from clean_swarm_env.config.types import AVOIDANCE, ConfigurationError
from clean_swarm_env.deciders.named import FIXED, POLICY, decider_named, without_digest
from clean_swarm_env.deciders.unseen import decided_and_held, remarks_of, undecided, unseen
from clean_swarm_env.recording.file import SUFFIX
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.world.by_hand import Change
from clean_swarm_env.world.task import coordinators_of, task_class
from selector.configurations.library import library_of
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import validated
from selector.documents.fields import Closed
from selector.documents.find import files_of
from train.running.run_folder import fingerprints, held_files

STRATEGY, AVOIDING, TRAINED, NEVER = "MaxScore", f"{FIXED}:ORCA", f"{POLICY}:one", f"{FIXED}:Off"
"""By the expert's scores; the cheapest where robots only choose how to avoid, or more than that; never to avoid."""
MANY = 10
"""Robots from which a mission jams under the wrong strategy."""
SPARE_ROBOTS, SPARE_ITEMS = 20, 40
"""Robots and items that can be added by hand."""
MOST_HEARING = 200
"""Robots up to which each stores its own messages, so that some can get lost: it takes their square."""


@dataclass(frozen=True)
class PlayedMission:
    """A play: one scenario, the decider of its options, and the changes by hand of an earlier play."""

    name: str
    scenario: Scenario
    strategy: str
    """As `decider_named` takes it."""
    goal: str | None = None
    """Goal that the strategy chooses options for; see `DecidedGoal`."""
    directories: tuple[Path, ...] = ()
    by_hand: Sequence[Change] = ()

    @property
    def member(self) -> str:
        """The strategy without the digest of its file."""
        return without_digest(self.strategy)

    def described(self) -> dict[str, Any]:
        """Return what the head of the recording says, from which `again` makes the play."""
        return _MissionPlay(
            name=self.name,
            start=self.scenario.start,
            seed=self.scenario.seed,
            goal=self.goal or "",
            strategy=decider_named(self.member, self.directories).identity,
            directories=tuple(str(path) for path in self.directories),
            files=fingerprints(self.directories),
        ).model_dump(mode="json")


class _MissionPlay(Closed):
    """What the head of a recording says about the play, beside mission, scenario and seed."""

    name: str
    start: StartConfiguration
    seed: int
    goal: str
    strategy: str
    directories: tuple[str, ...]
    files: dict[str, str]


def again(recording: RecordedMission) -> PlayedMission:
    """Return the play that a recording is of, with all that was done by hand.

    Raises:
        ConfigurationError: the recording is of something else or damaged, or files on which the course depends have
            changed.

    """
    where = f"{recording.path}: head"
    if not isinstance(recording.head["about"].get("play"), dict):
        raise ConfigurationError(f"{recording.path}: expected a recording of `clean-swarm play`, got one of a mission")
    told = validated(_MissionPlay, recording.head["about"]["play"], f"{where}: about.play")
    mission = validated(MissionConfig, recording.head["mission"], f"{where}: mission")
    directories = tuple(Path(name) for name in told.directories)
    if held_files(told.files, fingerprints(directories)) != told.files:
        raise ConfigurationError(f"{recording.path}: mechanisms, knowledge or robots have changed since it was played")
    scenario = Scenario(told.start.id, told.seed, mission, told.start)
    return PlayedMission(told.name, scenario, told.strategy, told.goal or None, directories, recording.by_hand)


def with_room(mission: MissionConfig) -> MissionConfig:
    """Return the mission with messages that can get lost in small teams, and with room for what may be added by hand.

    Nobody can be added where the measures of the task are of all rows of a world.
    """
    hearing = mission.own_contents or mission.rows <= MOST_HEARING
    changes: dict[str, Any] = {"delivery": {"own_contents": hearing}}
    kind = task_class(mission)
    if kind.changes:
        changes["robots"] = {"capacity": mission.rows + SPARE_ROBOTS}
        changes["task"] = with_items(mission.task, capacity=item_rows(mission) + SPARE_ITEMS).model_dump()
    room = with_changes(mission.model_dump(), changes)
    return validated(MissionConfig, room, "the mission with room for more", own=True)


def chosen(
    name: str,
    number: int,
    seed: int,
    strategy: str | None,
    directories: tuple[Path, ...],
    knowledge: str | None = None,
) -> PlayedMission:
    """Return the play of scenario `number`, from 1 on, of a mission, family or task, or a recording of a play.

    `knowledge` is the name of expert knowledge in place of the mission's.

    Raises:
        ConfigurationError: there is nothing of this name, or it cannot be played.

    """
    if name.endswith(SUFFIX):
        if (strategy, knowledge) != (None, None):
            raise ConfigurationError("--strategy, --knowledge: expected none, because the recording has its own")
        return again(RecordedMission(Path(name)))
    found = load_named(name, directories)
    if isinstance(found, FamilyConfig):
        scenario = found.scenario(seed, number - 1, "test")
    else:
        start = random_start(found, seed, number - 1)
        scenario = Scenario(start.id, run_seed(seed, start.id), found, start)
    room = replace(scenario, mission=with_room(knowing(scenario.mission, knowledge, directories)))
    return PlayedMission(Path(name).stem, room, strategy or usual(room.mission, directories)[0], None, directories)


def usual(mission: MissionConfig, directories: tuple[Path, ...]) -> tuple[str, str]:
    """Return the strategy that a mission is played with unless another one is named, and one with which it jams.

    The latter is empty where none is known. `clean-swarm evaluate` tells what both cost.
    """
    if knowledge_of(mission, directories).learned:  # as advice has it
        return STRATEGY, ""
    options = {model.goal: model.options for model in _models(mission, directories)}
    trained = decider_named(TRAINED)
    cleans, jams = item_rows(mission) > 0, mission.robots.count >= MANY
    if not cleans or not {AVOIDING, NEVER} <= {f"{FIXED}:{option}" for option in options.get(AVOIDANCE, ())}:
        return STRATEGY, ""
    if set(options) & set(trained.goals) > {AVOIDANCE} and not unseen(trained.training, [mission]):
        return TRAINED, NEVER if jams else ""
    return AVOIDING, STRATEGY if jams else ""


def remarks(play: PlayedMission) -> list[str]:
    """Return what the policy of a play never saw, and goals that it leaves alone."""
    mission, named = play.scenario.mission, decider_named(play.member, play.directories)
    told, models = remarks_of(play.member, named, [mission], play.directories), _models(mission, play.directories)
    if why := undecided(named, mission, play.directories, by_goal=False):
        told.append(f"{play.member}: {why}")
    decided = [model.goal for model in models if model.goal in named.goals]
    return told + decided_and_held(play.member, named, decided, models)


def _models(mission: MissionConfig, directories: tuple[Path, ...]) -> tuple[CoordinatorModel, ...]:
    return coordinators_of(mission, knowledge_of(mission, directories), library_of(directories), directories)


def playable(directories: tuple[Path, ...]) -> list[str]:
    """Return the names of all missions, families, experiments and tasks."""
    return sorted({*task_names(), *chain(*(files_of(kind, directories) for kind in KIND_WORDS))})
