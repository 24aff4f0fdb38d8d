"""A mission that goes step by step, is changed by hand, and is recorded so that it can run again."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from clean_swarm_env.config.tasks import item_rows
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import Decider
from clean_swarm_env.deciders.named import (
    DIGEST,
    FIXED,
    LEARNED,
    MACHINE,
    POLICY,
    NamedDecider,
    decider_named,
    without_digest,
)
from clean_swarm_env.deciders.what_if import WhatIf, actions_of
from clean_swarm_env.learning.actions import ActionConfig, Mode
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig, usual_terms
from clean_swarm_env.recording.file import end_of
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.by_hand import CHANGES, Change, FollowStrategy, HoldOption, change_of
from clean_swarm_env.world.mission_end import RUNNING
from clean_swarm_env.world.task import task_class
from selector.documents.errors import DocumentError, one_line, validated, within
from selector.documents.find import files_of
from selector.documents.plain import short
from selector.strategies.registry import STRATEGIES
from selforg.arrays import Ints
from selforg.registry import unknown
from train.live.chosen import SPARE_ROBOTS, PlayedMission, usual

OFFERED = ("MaxScore", "Random")
"""Strategies that a user may choose where they fit, besides fixed options and those of files."""


class Session:
    """One mission that is played, in one world.

    Args:
        play: what is played; its mission has room (`with_room`).
        output: the recording; a file that exists is replaced.
        minds: whether the networks of the robots are recorded, too.

    Attributes:
        batch: the world.
        strategy: the strategy that chooses the options.
        options: names of the options of the decided goal.
        beginning: the bytes with which the recording begins.
        period: length of a control period [s].
        result: the figures of the mission, None while it goes on.

    """

    def __init__(self, play: PlayedMission, output: Path, *, minds: bool = True) -> None:
        self._play, scenarios = play, iter((play.scenario,))
        about = {"experiment": play.name, "condition": play.member, "play": play.described()}
        named = decider_named(play.member, play.directories)
        mode: Mode = "velocity" if named.mode == "velocity" else "both"
        self._what_if: WhatIf | None = None
        self._seen_terms, policies = self._seen(named)
        own = any(issubclass(task_class(play.scenario.mission), kind.changes) for kind in CHANGES)
        settings = RecordSettings(output.parent, minds, about, output.name, mode == "both", policies, put=own)
        self.batch = Batch(
            play.scenario.mission,
            source=lambda _: next(scenarios, None),
            begin_anew=False,
            directories=play.directories,
            record=settings,
            observation=self._seen_terms,
            action=ActionConfig(mode=mode),
        )
        assert self.batch.recorder is not None
        self._recorder = self.batch.recorder
        self.worlds = self.batch.worlds
        self._decided = DecidedGoal(self.batch, named.decides(play.goal))
        self.goal, self.options = self._decided.problem.goal, self._decided.problem.options
        self.strategy, self._decider = self._decided_by(play.strategy)
        self._by_hand: Ints = np.full(self.batch.rows, -1)  # the option that each robot holds by hand, -1 for none
        self._added = 0
        self._observations = self.batch.reset()
        self._decider.reset(self.worlds.rows_of(0), play.scenario.seed)
        self._course = self._periods()
        self.beginning, self.period = self._recorder.beginning, self.worlds.period
        self.result: Mapping[str, Any] | None = None
        self._coming = list(play.by_hand)
        self._made: list[dict[str, Any]] = []  # since the last frame

    @property
    def ticks(self) -> int:
        """Control periods that have been run."""
        return int(self.worlds.ticks[0])

    def tick(self) -> bytes:
        """Run one control period and return it as blocks of a recording; nothing once the mission is over."""
        if self.result is not None:
            return b""
        while self._coming and self._coming[0].tick <= self.ticks:
            self._make(self._coming.pop(0))
        next(self._course)
        frame = self._recorder.latest({"by_hand": self._made, "made": time.time()})
        self._made = []
        if self.batch.progress.outcome[0] == RUNNING:
            return frame
        self.result = self.batch.finished[0].result.as_mapping()
        return frame + end_of(self.result)

    def do(self, order: Mapping[str, Any]) -> None:
        """Make a change by hand before the next control period; `order` has the keys of a `Change` but its tick.

        ValueError, of one line, says what is impossible.
        """
        try:
            change = change_of({**order, "tick": self.ticks})
        except ValidationError as error:
            raise ValueError(one_line(error, "by hand")) from error
        if self.result is not None:
            raise ValueError("the mission is over")
        self._make(change)

    def what_if(self, robot: object) -> list[dict[str, Any]]:
        """Return what happens next for each option that a robot could take; ValueError, of one line, if it cannot."""
        if isinstance(robot, bool) or not isinstance(robot, int):
            raise ConfigurationError(f"robot: expected a whole number, got {short(robot)}")
        if self.result is not None:
            raise ConfigurationError("the mission is over")
        self._what_if = self._what_if or WhatIf(self.batch, self._decided, self._seen_terms, self._play.directories)
        return self._what_if.options(robot, self._decider, self._observations, self._by_hand)

    def present(self) -> bytes:
        """Return the world as it is now."""
        return self._recorder.present({"by_hand": self._made})

    def close(self) -> None:
        """End the recording."""
        self.batch.close()

    def offered(self) -> dict[str, Any]:
        """Return the strategies that fit this mission, by their own names, the best one, and one with which it jams."""
        best, jams = usual(self._play.scenario.mission, self._play.directories)
        return {"strategies": self._fitting((*self._filed(), *self._fixed(), *OFFERED)), "best": best, "jams": jams}

    def _fixed(self) -> list[str]:
        """Return the strategies that take the same option all the time; of several goals, one of each goal alone."""
        return [f"{FIXED}:{option}" for part in self._decided.parts for option in part]

    def _fitting(self, members: Iterable[str]) -> list[str]:
        """Return the strategy of the play and those of `members` that fit this mission, each once."""
        fitting = []
        for member in dict.fromkeys((self._play.member, *members)):
            with suppress(DocumentError):
                self._decided_by(member)
                fitting.append(member)
        return fitting

    def _seen(self, named: NamedDecider) -> tuple[ObservationConfig, dict[str, Mapping[str, Any]]]:
        """Return what robots observe so that any policy can follow, and the networks of the policies."""
        mission, directories = self._play.scenario.mission, self._play.directories
        seen = named.observation(usual_terms(mission))
        if named.mode == "velocity" or named.sees or not item_rows(mission):
            return seen, {}
        names = [name for name in (self._play.member, *self._filed()) if name.startswith(POLICY)]
        policies = {name: decider_named(name, directories) for name in names}
        others = (term for policy in policies.values() for term in policy.terms)
        terms = dict.fromkeys((*(term.name for term in seen.terms or ()), *usual_terms(mission), *others))
        observation = validated(ObservationConfig, {"terms": tuple(terms)}, "observation", own=True)
        return observation, {name: policy.network for name, policy in policies.items() if policy.network}

    def _filed(self) -> list[str]:
        """Return the strategies of the files in the directories of configurations, by their names."""
        folders = {POLICY: "policies", LEARNED: "strategies", MACHINE: "machines"}
        return [f"{kind}:{name}" for kind in folders for name in files_of(folders[kind], self._play.directories)]

    def _decided_by(self, text: str) -> tuple[str, Decider]:
        """Return a strategy with the digest of its file, and its decider; `text` may have the digest of then."""
        member = without_digest(text)
        named = decider_named(member, self._play.directories)
        now, drives = named.identity, self.batch.action.mode == "velocity"
        if drives is not (named.mode == "velocity"):
            raise ConfigurationError(f"{member}: expected a strategy that {'drives' if drives else 'chooses options'}")
        if named.sees and member != self._play.member:
            raise ConfigurationError(f"{member}: expected a policy that sees terms with their usual settings")
        if DIGEST in text and now != text:
            raise ConfigurationError(f"{member} has changed since; the play cannot be repeated")
        teams = np.zeros(self.batch.rows, dtype=np.int64)
        with within(member):
            named.check_team(self.batch.mission.robots.count)
            return now, named.build(self._decided.problem, teams)

    def _periods(self) -> Iterator[None]:
        """Run the mission; yield after each control period."""
        batch, progress = self.batch, self.batch.progress
        while progress.outcome[0] == RUNNING:
            for _ in batch.ticks(actions_of(self._decided, self._decider, self._observations, self._by_hand)):
                yield
            self._observations = batch.end_period().observations

    def _make(self, change: Change) -> None:
        """Make a change by hand; ValueError if it is impossible."""
        if change.do == "add_robot" and self._added == SPARE_ROBOTS:
            raise ValueError(f"a robot more: expected at most {SPARE_ROBOTS} added by hand")
        if isinstance(change, FollowStrategy):
            change = self._follow(change)
        elif isinstance(change, HoldOption):
            self._hold(change)
        else:
            change.make(self.worlds)
        self._added += change.do == "add_robot"
        self._made.append(change.model_dump())
        self._recorder.note_by_hand(self._made[-1])

    def _follow(self, change: FollowStrategy) -> FollowStrategy:
        """Let a strategy choose; neither orders nor recordings name one by a path, or code of the user's own."""
        known = (self._play.member, *STRATEGIES.names(), *self._fixed(), *self._filed())
        if without_digest(change.strategy) not in known:
            raise ConfigurationError(f"follow_strategy: {unknown('strategy', change.strategy, self._fitting(known))}")
        self.strategy, self._decider = self._decided_by(change.strategy)
        self._decider.reset(self.worlds.rows_of(0), self._play.scenario.seed)
        self._by_hand[:] = -1
        return change.model_copy(update={"strategy": self.strategy})

    def _hold(self, change: HoldOption) -> None:
        if self.batch.action.mode == "velocity":
            raise ValueError(f"hold_option: {self._play.member} drives the robots; they hold no option")
        rows = np.array(change.robots or range(self.batch.rows))
        if rows.max() >= self.batch.rows:
            raise ValueError(f"robot {rows.max()}: expected a number below {self.batch.rows}")
        option = self._decided.number_of(change.option) if change.option else -1
        self._by_hand[rows] = option
        if change.option:
            self._decided.hold(rows, option)
