"""Goals of self-organisation that are played, each in its scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from clean_swarm_env.goals.play import Play

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.starts import nearest_distance
from clean_swarm_env.learning.batch import compile_missions
from clean_swarm_env.recording.by_hand import Change, FollowStrategy, HoldOption, PutRobot
from clean_swarm_env.recording.file import RecordingFile, part_of
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.scene_recording import SceneFrames
from clean_swarm_env.scenes import find
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.served import expertise
from selector.documents.errors import validated
from selector.documents.fields import Closed
from selforg.arrays import Ints
from selforg.registry import unknown
from train.deciders.named import FIXED
from train.live.session import Session, check_files
from train.running.provenance import fingerprints


@dataclass(frozen=True)
class PlayedGoal:
    """What is played: a goal in its scene, served by an option."""

    name: str
    option: str | None
    """Option that serves the goal; the one of the highest score unless given."""
    seed: int
    directories: tuple[Path, ...] = ()
    by_hand: Sequence[Change] = ()

    @property
    def robots(self) -> int:
        """Number of robots."""
        return find(self.name).setting.robots

    def open(self, output: Path, *, minds: bool) -> GoalSession:
        """Return the session, recorded in a file."""
        return GoalSession(self, output, minds=minds)


class _GoalPlay(Closed):
    """What the head of a recording says about the play of a goal."""

    goal: str
    option: str
    seed: int
    directories: tuple[str, ...]
    files: dict[str, str]


def goal_again(recording: RecordedMission) -> PlayedGoal:
    """Return the play of a goal that a recording is of, with all that was done by hand.

    Raises:
        ConfigurationError: the recording is damaged, or files on which the course depends have changed.

    """
    told = validated(_GoalPlay, recording.head["about"]["play"], f"{recording.path}: head: about.play")
    directories = tuple(Path(name) for name in told.directories)
    check_files(recording, directories, told.files)
    return PlayedGoal(told.goal, told.option, told.seed, directories, recording.by_hand)


class GoalSession(Session):
    """A scene in one world, whose robots consist of a coordinator that runs the option each robot holds.

    Attributes:
        scene: the scene.

    """

    def __init__(self, played: PlayedGoal, output: Path, *, minds: bool) -> None:
        compile_missions()
        expert = expertise(played.name, played.option, played.directories)
        self.scene = find(played.name)(find(played.name).setting, (played.seed,))
        self._play = Play(self.scene, expert, "option", explained=minds)
        self._team, self._arena = self._play.team, self.scene.arena
        self._names = expert.model.options
        self._frames_of = SceneFrames(self.scene, expert.name)
        told = _GoalPlay(
            goal=played.name,
            option=expert.name,
            seed=played.seed,
            directories=tuple(str(path) for path in played.directories),
            files=fingerprints(played.directories),
        )
        head = self._frames_of.head(0, {"seed": played.seed, "play": told.model_dump(mode="json")})
        self._file = RecordingFile(output, head, self._frames_of.frames.channels)
        super().__init__(self._file.beginning, CONTROL_PERIOD, played.by_hand)

    @property
    def ticks(self) -> int:
        """Control periods that have been run."""
        return self._arena.ticks

    def facts(self) -> dict[str, Any]:
        """Return the option that all robots hold, if they do; no messages get lost."""
        held = set(self._team.held.tolist())
        return {"strategy": f"{FIXED}:{self._names[held.pop()]}" if len(held) == 1 else "", "loss": 0.0}

    def strategies(self) -> list[str]:
        """Return the options, each as the strategy that always takes it."""
        return [f"{FIXED}:{name}" for name in self._names]

    def present(self) -> bytes:
        """Return the world as it is now."""
        self._frames_of.note_poses()
        now = self._frames_of.frames.present(0)
        return part_of(self.ticks, now, {**self._frames_of.notes, "by_hand": self._made})

    def close(self) -> None:
        """End the recording."""
        self._frames_of.close()
        self._file.close(self.result)

    def _changed(self, change: Change) -> Change:
        if isinstance(change, PutRobot):
            self._put(change)
        elif isinstance(change, HoldOption):
            self._hold(np.array(change.robots or range(self._arena.rows)), change.option)
        elif isinstance(change, FollowStrategy):
            self._hold(np.arange(self._arena.rows), change.strategy.removeprefix(f"{FIXED}:"))
        else:
            raise ConfigurationError("expected put_robot, hold_option or follow_strategy in the scene of a goal")
        return change

    def _put(self, change: PutRobot) -> None:
        arena, extent = self._arena, np.full(2, self.scene.ground.side)
        if change.robot >= arena.rows:
            raise ConfigurationError(f"robot {change.robot}: expected a robot that is there")
        place = np.array([change.x, change.y]) % extent
        others = np.delete(arena.positions, change.robot, axis=0)
        if arena.body.contacts == "solid" and nearest_distance(place, others, extent) < 2.0 * arena.body.radius:
            raise ConfigurationError(f"robot {change.robot}: another robot is at the place")
        arena.physics.remove(change.robot)
        x, y = place.tolist()
        arena.physics.add(change.robot, x, y, float(arena.headings[change.robot]))

    def _hold(self, robots: Ints, option: str) -> None:
        if option not in self._names:
            raise ConfigurationError(unknown("option", option, self._names))
        if robots.max() >= self._arena.rows:
            raise ConfigurationError(f"robot {robots.max()}: expected a number below {self._arena.rows}")
        held = self._team.held.copy()
        held[robots] = self._names.index(option)
        self._team.hold(held)

    def _run_period(self, notes: Mapping[str, Any]) -> bytes:
        first, frames = self.ticks, self._frames_of.frames
        self._frames_of.note_poses()
        self._play.tick()
        self._frames_of.record()
        packed = frames.pack(0)
        frames.restart((0,))
        return self._file.add(first, packed, {**self._frames_of.notes, **notes})

    def _ended(self) -> Mapping[str, Any] | None:
        return self._frames_of.result(0) if self.scene.over else None
