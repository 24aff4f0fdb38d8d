"""W worlds with one goal of self-organisation, stepped by decision periods as missions are.

All episodes last the time of the scene, so all worlds begin and end together. Rows are robots, R = W * N.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.starts import run_seed
from clean_swarm_env.goals.goal_state import GoalState
from clean_swarm_env.goals.observer import GoalObserver
from clean_swarm_env.goals.play import Play
from clean_swarm_env.goals.settings import GoalAction, GoalObservation, GoalRewards, GoalSettings, key_of, setting_of
from clean_swarm_env.learning.actions import ActionConfig, OptionActions
from clean_swarm_env.learning.batch import compile_missions
from clean_swarm_env.learning.given import check_settings, config_from, directories_from, seeds_from, whole_number
from clean_swarm_env.learning.interface import NO_JUMPS, AnyBatch, BatchStep, Ended, FigureColumns
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.learning.reward import OwnRewards, own_rewards
from clean_swarm_env.scenes import find
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.scene import Scene
from clean_swarm_env.scenes.served import KNOWLEDGE, expertise
from selforg.arrays import Flags, Floats, Ints
from selforg.sealing import check_alike, sealed, unsealed

TICKS_PER_STEP = 5
"""Control periods in a decision period, which thus lasts 1 s."""


@dataclass(frozen=True)
class GoalEnd(Ended):
    """An episode that ended in the last period."""

    figures: dict[str, Any]
    """The figures of its world at the end."""

    @property
    def statistics(self) -> dict[str, Any]:
        """The figures that borders report at the end."""
        return self.figures


class GoalBatch(AnyBatch):
    """The scene of one goal in W worlds, whose robots learn.

    Args:
        goal: its name, as `clean-swarm run` takes it.
        worlds: W.
        observation: terms of the observation.
        reward: weights of the measures, see `GoalRewards`, or a function of the batch that returns the rewards (R,).
        action: what an action is.
        settings: see `GoalSettings`.

    Episode 0 of a world after `reset` with seed S is the run of `clean-swarm run GOAL --seed S`; with the default
    option held all the time it has the same measures.

    Attributes:
        play: the episode under way.

    >>> batch = GoalBatch("Foraging", worlds=2)
    >>> batch.reset([5, 6]).shape == (24, len(batch.observer.names))
    True
    >>> step = batch.step(np.full(24, batch.choices.default[0]))
    >>> step.truncated.tolist()
    [False, False]

    """

    action: GoalAction
    observer: GoalObserver

    def __init__(
        self,
        goal: str,
        worlds: int = 1,
        *,
        observation: GoalObservation | Mapping[str, Any] | None = None,
        reward: Mapping[str, Any] | OwnRewards | str | None = None,
        action: GoalAction | Mapping[str, Any] | None = None,
        **settings: Unpack[GoalSettings],
    ) -> None:
        check_settings(settings, GoalSettings, f"goal {goal}")
        self.mission, self.period, self.decision_period = None, CONTROL_PERIOD, TICKS_PER_STEP * CONTROL_PERIOD
        self.count, self._kind = whole_number(worlds, "worlds", 1), find(goal)
        self.setting = setting_of(self._kind, settings)
        self.action = config_from(GoalAction, action, "action")
        self.begin_anew = settings.get("begin_anew", True)
        self._record = settings.get("record")
        directories, knowledge = directories_from(settings.get("directories")), settings.get("knowledge")
        self._expert = expertise(goal, None, directories, str(knowledge or KNOWLEDGE))
        self.options: Mapping[str, tuple[str, ...]] = {goal: self._expert.model.options}
        self.choices = OptionActions([self._expert.model], ActionConfig())
        self._own_rewards = own_rewards(reward)
        self._rewards = GoalRewards(self._kind, None if self._own_rewards else reward)  # type: ignore[arg-type]
        compile_missions()
        self.play = self._played([0] * self.count)  # until `reset`, for names and sizes
        self.robots = self.setting.robots
        self.rows = self.count * self.robots
        seen = config_from(GoalObservation, observation, "observation")
        self.observer = GoalObserver(seen if self.action.mode != "velocity" else seen.driven(), self.play)
        self.observations: Observations = np.zeros((self.rows, len(self.observer.names)), dtype=np.float32)
        self._final, self._gained = np.zeros_like(self.observations), np.zeros(self.rows)
        self.working = self.took_part = np.ones(self.rows, dtype=np.bool_)  # all robots, always
        self.phases = np.zeros(self.rows, dtype=np.int64)  # one for all, in which every option can serve
        self._collisions: Ints = np.zeros(self.rows, dtype=np.int64)  # of the last period
        self._series: list[tuple[int, int] | None] = [None] * self.count  # seed and number of the next episode
        self._finished: list[GoalEnd] = []
        self._seeds: list[int] = []  # of the episode under way
        self._begun = self._ran = False
        self._before = self._measured()  # at the beginning of the period

    def reset(
        self, seeds: Sequence[int | None] | None = None, starts: Sequence[StartConfiguration | None] | None = None
    ) -> Observations:
        """Begin an episode in every world and return the observations (R, F), valid until the next call.

        A world without a seed (None) continues its series of episodes, or begins one with a seed from the system.
        """
        if any(start is not None for start in starts or ()):
            raise ValueError("start: expected none with a goal, whose scene places the robots")
        for world, seed in enumerate(seeds_from(seeds, self.count)):
            if seed is not None or self._series[world] is None:
                self._series[world] = (int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed, 0)
        self._finished.clear()
        self._collisions[:] = 0
        self._start_episode()
        self.observer.observe(self.play, self.observations)
        return self.observations

    def reset_worlds(
        self,
        worlds: Ints,
        seeds: Sequence[int | None] | None = None,
        starts: Sequence[StartConfiguration | None] | None = None,
    ) -> Observations:
        """Begin an episode in all worlds: `worlds` (K,) must name them all."""
        if len(worlds) != self.count:
            raise ValueError(f"goal {self._kind.goal}: all {self.count} worlds begin together, got {len(worlds)}")
        return self.reset(seeds, starts)

    def ticks(self, actions: NDArray[Any]) -> Iterator[Scene]:
        """Run one decision period, which ends early with the episode; yield the scene after each control period.

        `actions` are options (R,), vectors (R, 2) for mode "velocity", or (R, 3) for "both", the option first.
        """
        if not self._begun:
            raise RuntimeError("step: call reset first")
        self._finished.clear()
        scene = self.play.scene
        self.play.act(actions, self.choices)
        self._ran, self._before, self._collisions = not scene.over, self._measured(), -scene.arena.entered
        if self._record is not None and self._ran:
            self.play.record(self._record, self._seeds)
        for _ in range(TICKS_PER_STEP):
            if not scene.over:
                self.play.tick()
                yield scene

    def end_period(self) -> BatchStep:
        """Begin the next episode where one is over, and return what the period gave."""
        scene = self.play.scene
        self._collisions += scene.arena.entered
        if self._own_rewards is None:
            self._gained = self._rewards.of(self._measured() - self._before, self._collisions)
        else:
            self._gained = self._own_rewards(self)
        over = np.full(self.count, scene.over)
        if scene.over and self._ran:
            self._end()
        self.observer.observe(self.play, self.observations)
        return BatchStep(self.observations, self._gained, np.zeros_like(over), over, self._final)

    def _end(self) -> None:
        """Keep the figures and the last observations of the episode, and begin the next one if that is wanted."""
        self.close()
        self.observer.observe(self.play, self._final)
        columns = self.team_figures()
        self._finished += [
            GoalEnd(world, dict(zip(columns, values, strict=True)))
            for world, values in enumerate(zip(*columns.values(), strict=True))
        ]
        if self.begin_anew:
            self._start_episode()

    def close(self) -> None:
        """End the recording of an episode, also of one that is still going on."""
        self.play.close()

    def _start_episode(self) -> None:
        self.close()
        self._seeds = []
        for world, following in enumerate(self._series):
            assert following is not None
            seed, number = following
            self._seeds.append(run_seed(seed, f"episode {number}") if number else seed)
            self._series[world] = (seed, number + 1)
        self.play, self._begun = self._played(self._seeds), True

    def _played(self, seeds: Sequence[int]) -> Play:
        """Return a new episode in worlds with these seeds."""
        try:
            explained = self._record is not None and self._record.minds
            return Play(self._kind(self.setting, seeds), self._expert, self.action.mode, explained=explained)
        except ConfigurationError as error:
            raise ConfigurationError(str(error).removeprefix("--")) from error  # options of the command line

    def _measured(self) -> Floats:
        """Return the measures (K, W) as they stand."""
        values = self.play.scene.measured()
        return np.stack([values[measure.name] for measure in self._kind.measures])

    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the state of all worlds as sealed bytes that say their version; they cannot be taken one by one."""
        self._check_all(worlds)
        own = (self._likeness(), self.play.unrecorded(), self._series, self.observations, self._begun)
        return sealed("goal", own)

    def open_state(self, state: bytes, worlds: Sequence[int] | None = None) -> tuple[Any, ...]:
        """Return a state, opened, of a batch with the same goal, setting, options and terms; see `set_state`."""
        if self._record is not None:
            raise ValueError(NO_JUMPS)
        self._check_all(worlds)
        likeness, *whole = unsealed("goal", state)
        check_alike(self._likeness(), likeness)
        return tuple(whole)

    def enter_state(self, opened: tuple[Any, ...]) -> Observations:
        """Go on from what `open_state` has returned; what the last period counted is no part of a state."""
        self.play, self._series[:], self.observations[:], self._begun = opened
        self._collisions[:] = 0
        self._finished.clear()
        return self.observations

    def _likeness(self) -> dict[str, Any]:
        """Return what batches must have in common to go on from each other's states."""
        own = {"goal": self._kind.goal, "setting": self.setting, "worlds": self.count, "options": self.options}
        return own | {"action": self.action.mode, "terms": self.observer.names}

    def _check_all(self, worlds: Sequence[int] | None) -> None:
        if worlds is not None and list(worlds) != list(range(self.count)):
            raise ValueError(f"worlds: expected all {self.count} together with a goal, got {list(worlds)}")

    def steps(self, world: int) -> int:
        """Return how many decision periods of its episode a world has done."""
        return -(-self.play.scene.arena.ticks // TICKS_PER_STEP)

    @property
    def over(self) -> Flags:
        """(W,) whether the episode is over and no other has begun."""
        return np.full(self.count, self.play.scene.over)

    @property
    def finished(self) -> tuple[GoalEnd, ...]:
        """The episodes that ended in the last period."""
        return tuple(self._finished)

    def team_figures(self) -> FigureColumns:
        """Return time, collisions, measures as they stand, and whether all meet their targets, of each world."""
        measures, arena = self._kind.measures, self.play.scene.arena
        values = dict(zip(measures, self._measured().tolist(), strict=True))
        met = [
            all(m.met(v) for m, v in zip(measures, of_world, strict=True))
            for of_world in zip(*values.values(), strict=True)
        ]
        time = arena.ticks * CONTROL_PERIOD
        counted = {"mission_collision_events": arena.collisions.events[:, 0].tolist(), "completed": met}
        times = {"time_s": [time] * self.count, "duration_s": [time] * self.count}
        return times | counted | {key_of(m.name): values[m] for m in measures}

    def own_figures(self) -> FigureColumns:
        """Return the collision events of each robot in the last period."""
        return {"own_collisions": self._collisions.tolist()}

    def global_state(self) -> GoalState:
        """Return what tells the global state of the worlds."""
        return GoalState(self, options=self.action.mode != "velocity")
