"""Goals of self-organisation that are played, each in its scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.starts import nearest_distance
from clean_swarm_env.goals.play import Play
from clean_swarm_env.learning.batch import whole_mission
from clean_swarm_env.learning.warm_up import compile_once
from clean_swarm_env.recording.by_hand import Change, FollowStrategy, HoldOption, PutRobot
from clean_swarm_env.recording.channels import MILLI, AnyArray, Channel, point_channels, whole_channel
from clean_swarm_env.recording.file import RecordingFile
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.scenes import Setting, find
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.scene import Gradients
from clean_swarm_env.scenes.served import expertise
from selector.documents.errors import validated
from selector.documents.fields import Closed
from selforg.arrays import Ints
from selforg.registry import unknown
from train.evaluation.entrants import FIXED
from train.live.session import Session, check_files
from train.running.provenance import fingerprints

IN_SCENES = "expected put_robot, hold_option or follow_strategy, because this is the scene of a goal"


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
    def setting(self) -> Setting:
        """The scene's own setting."""
        return find(self.name).setting

    @property
    def robots(self) -> int:
        """Number of robots."""
        return self.setting.robots

    def open(self, output: Path, *, minds: bool) -> GoalSession:
        """Return the session, recorded in a file; robots of scenes have no networks to record."""
        return GoalSession(self, output)


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

    def __init__(self, played: PlayedGoal, output: Path) -> None:
        compile_once(whole_mission)
        expert = expertise(played.name, played.option, played.directories)
        self.scene = find(played.name)(played.setting, (played.seed,))
        self._play = Play(self.scene, expert, "option")
        self._team, self._arena = self._play.team, self.scene.arena
        self._names = expert.model.options
        robots = ("robot", self._arena.robots)
        heading = Channel("heading", robots[:1], robots[1:], MILLI, 1, "rad", "where the robot looks")
        self._channels = (
            *point_channels("", (robots,), "where the robot is", order=2),
            heading,
            whole_channel("present", robots, "1 where the robot is there, at work or failed"),
            whole_channel("working", robots, "1 where the robot is at work"),
            whole_channel(f"held/{played.name}", robots, "the option that serves the goal in the robot"),
        )
        told = _GoalPlay(
            goal=played.name,
            option=expert.name,
            seed=played.seed,
            directories=tuple(str(path) for path in played.directories),
            files=fingerprints(played.directories),
        )
        self._file = RecordingFile(output, self._head(played.name, told.model_dump(mode="json")), self._channels)
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

    def close(self) -> None:
        """End the recording."""
        self._file.close(self.result)

    def _changed(self, change: Change) -> Change:
        if isinstance(change, PutRobot):
            self._put(change)
        elif isinstance(change, HoldOption):
            self._hold(np.array(change.robots or range(self._arena.rows)), change.option)
        elif isinstance(change, FollowStrategy):
            self._hold(np.arange(self._arena.rows), change.strategy.removeprefix(f"{FIXED}:"))
        else:
            raise ConfigurationError(IN_SCENES)
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
        arena, first, ones = self._arena, self.ticks, np.ones(self._arena.robots, dtype=np.int64)
        values: list[AnyArray] = [*arena.positions.T.copy(), arena.headings.copy(), ones, ones, self._team.held.copy()]
        self._play.tick()
        whole = [channel.whole(value[None]) for channel, value in zip(self._channels, values, strict=True)]
        return self._file.add(first, np.concatenate(whole, axis=1), notes)

    def _ended(self) -> Mapping[str, Any] | None:
        if not self.scene.over:
            return None
        figures = {name: float(values[0]) for name, values in self.scene.measured().items()}
        met = all(measure.met(figures[measure.name]) for measure in self.scene.measures)
        return {"completed": met, "duration_s": self.scene.chosen.seconds, "measures": figures}

    def _head(self, name: str, told: Mapping[str, Any]) -> dict[str, Any]:
        """Return the head: a mission without items and stations, whose only goal is that of the scene."""
        body, side, coordinator = self._arena.body, self.scene.ground.side, self._team.coordinator
        return {
            "about": {"experiment": name, "condition": told["option"], "seed": told["seed"], "play": told},
            "period": CONTROL_PERIOD,
            "ticks_per_decision": 1,
            "width": side,
            "height": side,
            "field": self.scene.ground.field_side,
            "things": [thing for gradients in self.scene.around for thing in _things(gradients)],
            "robots": self._arena.robots,
            "items": 0,
            "minds": False,
            "options": {name: self._names},
            "views": {name: [content.view_distance for content in coordinator.contents]},
            "mission": {
                "name": name,
                "robots": {
                    "radius": body.radius,
                    "pose_goal_radius": body.pose_goal_radius,
                    "pose_diffusion": body.pose_diffusion,
                },
            },
        }


def _things(gradients: Gradients) -> Iterator[dict[str, Any]]:
    """Yield the gradients that are in the first world from the start on, as plain data."""
    places = gradients.places[0]
    radii = np.broadcast_to(gradients.goal_radius, len(places))
    for (x, y), radius in zip(places.tolist(), radii.tolist(), strict=True):
        yield {"channel": gradients.channel, "attraction": gradients.attraction, "x": x, "y": y, "radius": radius}
