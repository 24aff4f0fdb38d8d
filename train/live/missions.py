"""Missions that are played, and families of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.learning.actions import ActionConfig, Mode
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.by_hand import AddRobot, Change, FollowStrategy, HoldOption
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission_end import RUNNING
from selector.documents.errors import DocumentError, validated
from selector.documents.fields import Closed
from selector.documents.find import files_of
from selector.strategies.registry import STRATEGIES
from selforg.arrays import Ints
from selforg.registry import unknown
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import Decider
from train.deciders.named import FIXED, LEARNED, MACHINE, POLICY, decider_named
from train.evaluation.repeat_trial import DIGEST
from train.live.session import Session, check_files
from train.running.provenance import fingerprints

OFFERED = ("MaxScore", "Random", f"{FIXED}:Off")
"""Strategies that a user may choose where they fit, besides policies and learned strategies."""
SPARE_ROBOTS, SPARE_ITEMS = 20, 40
"""Robots and items that can be added by hand."""
MOST_HEARING = 200
"""Robots up to which each stores by itself what it receives, so that messages can get lost: it takes their square."""


@dataclass(frozen=True)
class PlayedMission:
    """What is played: one scenario, its strategy, and what was done by hand when it was played before."""

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
        return self.strategy.partition(DIGEST)[0]

    @property
    def robots(self) -> int:
        """Number of robots at the start."""
        return self.scenario.mission.robots.count

    def open(self, output: Path, *, minds: bool) -> MissionSession:
        """Return the session, recorded in a file; one that exists is replaced."""
        return MissionSession(self, output, minds=minds)

    def described(self) -> dict[str, Any]:
        """Return what the head of the recording says, from which `mission_again` makes the play."""
        told = _MissionPlay(
            name=self.name,
            start=self.scenario.start,
            seed=self.scenario.seed,
            goal=self.goal or "",
            strategy=decider_named(self.member, self.directories).identity,
            directories=tuple(str(path) for path in self.directories),
            files=fingerprints(self.directories),
        )
        return told.model_dump(mode="json")


class _MissionPlay(Closed):
    """What the head of a recording says about the play, beside mission, scenario and seed."""

    name: str
    start: StartConfiguration
    seed: int
    goal: str
    strategy: str
    directories: tuple[str, ...]
    files: dict[str, str]


def mission_again(recording: RecordedMission) -> PlayedMission:
    """Return the play of a mission that a recording is of, with all that was done by hand.

    Raises:
        ConfigurationError: the recording is damaged, or files on which the course depends have changed.

    """
    where = f"{recording.path}: head"
    told = validated(_MissionPlay, recording.head["about"]["play"], f"{where}: about.play")
    mission = validated(MissionConfig, recording.head["mission"], f"{where}: mission")
    directories = tuple(Path(name) for name in told.directories)
    check_files(recording, directories, told.files)
    scenario = Scenario(told.start.id, told.seed, mission, told.start)
    return PlayedMission(told.name, scenario, told.strategy, told.goal or None, directories, recording.by_hand)


def with_room(mission: MissionConfig) -> MissionConfig:
    """Return the mission with room for what may be added by hand, and, in small teams, messages that can get lost."""
    parts: dict[str, dict[str, Any]] = {
        "robots": {"capacity": mission.rows + SPARE_ROBOTS},
        "garbage": {"capacity": mission.item_rows + SPARE_ITEMS},
        "delivery": {"own_contents": mission.own_contents or mission.rows <= MOST_HEARING},
    }
    changed = {name: {**getattr(mission, name).model_dump(), **change} for name, change in parts.items()}
    return validated(MissionConfig, {**mission.model_dump(), **changed}, "the mission with room for more", own=True)


class MissionSession(Session):
    """One mission that is played, in one world.

    Args:
        play: what is played; its mission has room (`with_room`).
        output: the recording; a file that exists is replaced.
        minds: whether the networks of the robots are recorded, too.

    Attributes:
        batch: the world.
        strategy: the strategy that chooses the options.
        options: names of the options of the decided goal.

    """

    def __init__(self, play: PlayedMission, output: Path, *, minds: bool = True) -> None:
        scenarios = iter((play.scenario,))
        about = {"experiment": play.name, "condition": play.member, "play": play.described()}
        named = decider_named(play.member, play.directories)
        mode: Mode = "velocity" if named.mode == "velocity" else "both"
        settings = RecordSettings(output.parent, minds, about, output.name, thinking=mode == "both")
        self.batch = Batch(
            play.scenario.mission,
            source=lambda _: next(scenarios, None),
            begin_anew=False,
            directories=play.directories,
            record=settings,
            observation=named.observation(play.scenario.mission.terms),
            action=ActionConfig(mode=mode),
        )
        assert self.batch.recorder is not None
        self._recorder, self._play = self.batch.recorder, play
        self.worlds = self.batch.worlds
        self._decided = DecidedGoal(self.batch, play.goal or named.meant_for or None)
        self.goal, self.options = self._decided.problem.goal, self._decided.problem.options
        self.strategy, self._decider = self._decided_by(play.strategy)
        self._by_hand: Ints = np.full(self.batch.rows, -1)  # the option that each robot holds by hand, -1 for none
        self._added = 0
        self._observations = self.batch.reset()
        self._decider.reset(self.worlds.rows_of(0), play.scenario.seed)
        self._course = self._periods()
        super().__init__(self._recorder.beginning, self.worlds.period, play.by_hand)

    @property
    def ticks(self) -> int:
        """Control periods that have been run."""
        return int(self.worlds.ticks[0])

    def facts(self) -> dict[str, Any]:
        """Return strategy and loss."""
        loss = self.worlds.minds.reception.losses[0]
        return {"strategy": self.strategy.partition(DIGEST)[0], "loss": float(loss)}

    def present(self) -> bytes:
        """Return the world as it is now."""
        return self._recorder.present({"by_hand": self._made})

    def close(self) -> None:
        """End the recording."""
        self.batch.close()

    def strategies(self) -> list[str]:
        """Return the strategies that fit this mission, for the user to choose from."""
        fitting = [self._play.member]
        for member in (*OFFERED, *self._filed()):
            with suppress(DocumentError):
                self._decided_by(member)
                fitting.append(member)
        return list(dict.fromkeys(fitting))

    def _filed(self) -> list[str]:
        """Return the strategies of the files in the directories of configurations, by their names."""
        folders = {POLICY: "policies", LEARNED: "strategies", MACHINE: "machines"}
        return [f"{kind}:{name}" for kind in folders for name in files_of(folders[kind], self._play.directories)]

    def _decided_by(self, text: str) -> tuple[str, Decider]:
        """Return a strategy with the digest of its file, and its decider; `text` may have the digest of then."""
        member = text.partition(DIGEST)[0]
        named = decider_named(member, self._play.directories)
        now, drives = named.identity, self.batch.action.mode == "velocity"
        if drives is not (named.mode == "velocity"):
            raise ConfigurationError(f"{member}: expected a strategy that {'drives' if drives else 'chooses options'}")
        if DIGEST in text and now != text:
            raise ConfigurationError(f"{member} is no longer what was played with; the play cannot be repeated")
        teams = np.zeros(self.batch.rows, dtype=np.int64)
        return now, named.build(self._decided.problem, teams)

    def _periods(self) -> Iterator[None]:
        """Run the mission; yield after each control period."""
        batch, progress = self.batch, self.batch.progress
        while progress.outcome[0] == RUNNING:
            actions, held = self._decided.decide(self._decider, self._observations), self._by_hand >= 0
            if held.any():
                actions[held, : self._decided.goals] = self._decided.actions(self._by_hand[held])
            for _ in batch.ticks(actions):
                yield
            self._observations = batch.end_period().observations

    def _run_period(self, notes: Mapping[str, Any]) -> bytes:
        next(self._course)
        return self._recorder.latest(notes)

    def _ended(self) -> Mapping[str, Any] | None:
        over = self.batch.progress.outcome[0] != RUNNING
        return asdict(self.batch.finished[0].result) if over else None

    def _changed(self, change: Change) -> Change:
        if isinstance(change, AddRobot) and self._added == SPARE_ROBOTS:
            raise ValueError(f"a robot more: expected at most {SPARE_ROBOTS} added by hand")
        if isinstance(change, FollowStrategy):
            change = self._follow(change)
        elif isinstance(change, HoldOption):
            self._hold(change)
        else:
            change.make(self.worlds)
        self._added += isinstance(change, AddRobot)
        self._recorder.note_by_hand(change.model_dump())
        return change

    def _follow(self, change: FollowStrategy) -> FollowStrategy:
        """Let a strategy choose; neither orders nor recordings name one by a path, or code of the user's own."""
        fixed = (f"{FIXED}:{option}" for option in self.options)
        known = (self._play.member, *STRATEGIES.names(), *fixed, *self._filed())
        if change.strategy.partition(DIGEST)[0] not in known:
            raise ConfigurationError(f"follow_strategy: {unknown('strategy', change.strategy, known)}")
        self.strategy, self._decider = self._decided_by(change.strategy)
        self._decider.reset(self.worlds.rows_of(0), self._play.scenario.seed)
        self._by_hand[:] = -1
        return change.model_copy(update={"strategy": self.strategy})

    def _hold(self, change: HoldOption) -> None:
        if self.batch.action.mode == "velocity":
            raise ValueError(f"hold_option: {self._play.member} drives the robots; they hold no option")
        if change.option and change.option not in self.options:
            raise ValueError(unknown("option", change.option, self.options))
        rows = np.array(change.robots or range(self.batch.rows))
        if rows.max() >= self.batch.rows:
            raise ValueError(f"robot {rows.max()}: expected a number below {self.batch.rows}")
        self._by_hand[rows] = self.options.index(change.option) if change.option else -1
        if change.option:
            self.worlds.minds.coordinator_of(self.goal).hold(rows, self._by_hand[rows])
