"""The core of all learning borders: W worlds with one frame, stepped by decision periods.

A world whose mission is over begins its next episode in the same step. Rows are robots, R = W * N (world w has the rows
w*N .. (w+1)*N - 1). A world of a batch has, bit for bit, the course that it has alone with the same seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import for_start
from clean_swarm_env.learning.actions import ActionConfig, LearnerActions
from clean_swarm_env.learning.episodes import EnvSettings, EpisodeSource, PictureConfig, Series, episodes_of
from clean_swarm_env.learning.given import (
    GivenMission,
    config_from,
    directories_from,
    of_each,
    seeds_from,
    whole_number,
)
from clean_swarm_env.learning.global_state import GlobalState
from clean_swarm_env.learning.interface import BatchStep, Finished, ManyWorlds
from clean_swarm_env.learning.observation.config import ObservationConfig, usual_terms
from clean_swarm_env.learning.observation.observer import Observations, Observer
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.learning.reward import Rewards
from clean_swarm_env.learning.warm_up import compile_once, run_through
from clean_swarm_env.recording.recorder import MissionRecorder
from clean_swarm_env.world.mission import MissionResult, result_of
from clean_swarm_env.world.mission_end import COMPLETED, RUNNING, TIME_OVER
from clean_swarm_env.world.states import WorldState
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import library_of
from selforg.arrays import KEPT, OUTSIDE, READ, SCRATCH, Flags, Floats, Ints
from selforg.declared import make_arrays
from selforg.program import COUNTING, STOP, Program, Rows, Step
from selforg.registry import unknown


class Batch(ManyWorlds):
    """W worlds with one frame, stepped one decision period at a time.

    Args:
        mission: its name in `configs/missions` ("table1" unless given), its path, its keys, or the model.
        worlds: W.
        begin_anew: whether a world whose mission is over begins its next episode at the end of that period. If not,
            the world stays as it is until `reset`, and counts no more.
        settings: see `EnvSettings`.

    Episode k of a world after `reset` with seed S is always the same: random start k of S, or scenario k of S (of those
    on the torus of `size`).

    Attributes:
        rows, robots, count: R, N and W.
        period, decision_period: lengths of a control period and of a decision period [s].
        ticks_per_step: control periods in a decision period.
        mission: the mission of all worlds, or what their missions have in common.
        options: coordinated goal -> names of its options; `choices` are these as actions.
        observer: names and bounds of the components of an observation.
        observations: (R, F) float32, the last ones, always the same array.
        returns: (R,) sum of the rewards of the mission so far.
        working, took_part: (R,) bool, whether there is a robot that works, and whether it did in the last period.
        worked: (R,) bool, whether it did at the end of the last mission that ended.
        open_team: whether a team may have more robots later than at its start.
        recorder: records the missions; None unless asked for.
        program: the steps of a tick that is counted.
        watch: called after each `reset`, and after each control period of `step`; None unless set.
        series: the episodes that follow from seeds.
        progress: what happened in the last period.
        finished: the missions that ended in the last period.
        doing: (W,) present or last scenario of each world; None where a source has given none yet.

    >>> batch = Batch("table1", worlds=2)
    >>> observations = batch.reset([5, 6])
    >>> step = batch.step(np.zeros(batch.rows, dtype=np.int64))
    >>> step.rewards.shape, step.terminated.tolist()
    ((10,), [False, False])

    """

    observations: Annotated[Observations, "R F", KEPT]
    doing: Annotated[list[Scenario | None], "W", KEPT]
    returns: Annotated[Floats, "R", KEPT]
    choices: Annotated[LearnerActions, READ]
    recorder: Annotated[MissionRecorder | None, OUTSIDE]
    rewards: Annotated[Rewards, OUTSIDE]
    _source: Annotated[EpisodeSource, OUTSIDE]
    worked: Annotated[Flags, "R", SCRATCH]
    _final: Annotated[Observations, "R F", SCRATCH]
    _gained: Annotated[Floats, "R", SCRATCH]
    _state: Annotated[GlobalState | None, OUTSIDE]

    def __init__(
        self,
        mission: GivenMission | None = None,
        worlds: int = 1,
        *,
        begin_anew: bool = True,
        **settings: Unpack[EnvSettings],
    ) -> None:
        known_settings = {*EnvSettings.__optional_keys__, "worlds", "begin_anew"}
        for name in sorted(settings.keys() - known_settings):
            raise TypeError(f"Batch: {unknown('setting', name, sorted(known_settings))}")
        worlds = whole_number(worlds, "worlds", 1)
        compile_once(lambda: run_through(Batch()))
        episodes, directories = episodes_of(mission, settings), directories_from(settings.get("directories"))
        episodes.check_size()
        self.mission = episodes.following((0, 0, 1))[0].mission
        self.series = Series(episodes, worlds)
        self._source = settings.get("source") or self.series
        self.action = config_from(ActionConfig, settings.get("action"), "action")
        self.picture = config_from(PictureConfig, settings.get("picture"), "picture")
        self.begin_anew = begin_anew
        known = knowledge_of(self.mission, directories)
        models = coordinators_of(self.mission, known, library_of(directories), directories)
        record, explained = settings.get("record"), settings.get("explained", False)
        explained = explained or (record is not None and record.minds)
        self.worlds = Worlds(self.mission, models, worlds, directories=directories, explained=explained)
        self.rows, self.robots, self.count = self.worlds.rows, self.worlds.robots, worlds
        self.period, self.decision_period = self.worlds.period, self.mission.decision_period
        self.options: Mapping[str, tuple[str, ...]] = {model.goal: model.options for model in models}
        always = np.stack([coordinator.always for coordinator in self.worlds.coordinators], axis=1)
        self.choices = LearnerActions(models, self.action, always, self.worlds.task.phases or ("any",))
        self.ticks_per_step, self.program = round(self.decision_period / self.period), Program(self._steps)
        self.progress = MissionProgress(self.worlds)
        self.working, self.took_part = self.worlds.team.working, self.progress.took_part
        self.open_team = episodes.fewest < self.robots
        self.rewards = Rewards(settings.get("reward"), self.worlds)
        seen = config_from(ObservationConfig, settings.get("observation"), "observation")
        seen = seen.of(usual_terms(self.mission), driven=self.action.mode == "velocity")
        self.observer = Observer(self.worlds, self.progress, seen)
        # after the observer, which may make robots tell facts
        self.recorder = MissionRecorder(self.worlds, record) if record is not None else None
        make_arrays(self, R=self.rows, F=self.observer.width)
        self.worked[:] = self.working
        self.finished: tuple[Finished, ...] = ()
        self._state = None
        self.watch: Callable[[], object] | None = None
        self.doing = [None] * worlds
        self.states = self.worlds.states_below(self, {"terms": self.observer.names})
        self._begun = False

    @property
    def batches(self) -> tuple[Batch, ...]:  # type: ignore[override]  # an attribute would be a circle
        """The batch itself."""
        return (self,)

    def reset(
        self,
        seeds: int | Sequence[int | None] | None = None,
        starts: Sequence[StartConfiguration | None] | None = None,
        worlds: Ints | None = None,
    ) -> Observations:
        """Begin an episode in every world, or in `worlds` (K,) only, whose `seeds` and `starts` alone count then.

        `seeds` (W,) restart the series of episodes; those of one number are its children. A world without a seed (None)
        continues its series, or begins one whose seed is drawn from the system. `starts` (W,) take the place of random
        starts. The observations (R, F) are valid until the next call. Without `worlds` the counts of the last period
        are gone, too.
        """
        known = seeds_from(seeds, range(0, self.rows, self.robots), self.rows)
        begun = of_each(starts, self.count, "starts")
        own = self._source is self.series
        if not own and any(seed is not None for seed in known):
            raise ValueError("seeds: expected none, because a source says what the worlds do")
        if worlds is None:
            self.finished, worlds = (), np.arange(self.count)
            self.progress.reset_period()
        for world in worlds.tolist():
            if own:
                self.series.reset(world, known[world])
            self._start_episode(world, begun[world])
            self.progress.elapsed[world] = 0
        self._begun = self._begun or len(worlds) == self.count or None not in self.doing
        self.observer.observe(self.observations, worlds)
        if self.watch is not None:
            self.watch()
        return self.observations

    def check_state(self, state: WorldState) -> None:
        """Raise ValueError unless a world can go on from a state."""
        if self.recorder is not None:
            raise ValueError("set_state: expected a batch that records nothing, because a recording has no jumps")
        self.states.check(state)

    def enter(self, states: Mapping[int, WorldState]) -> Observations:
        """Make worlds go on from states that `check_state` has let pass; return the observations (R, F).

        What ended in the last period, and vectors of the last action, are no part of a state.
        """
        for world, state in states.items():
            self.states.put(world, state)
        self._begun = self._begun or len(states) == self.count
        self.finished = ()
        self.worked[:] = self.working
        self.observer.observe(self._final, np.array([*states], dtype=np.int64))  # the phases; a state has what is seen
        return self.observations

    def steps(self, world: int) -> int:
        """Return how many decision periods of its mission a world has done."""
        return -(-int(self.progress.elapsed[world]) // self.ticks_per_step)

    @property
    def over(self) -> Flags:
        """(W,) whether the mission of a world is over and no other has begun."""
        return np.asarray(self.progress.outcome != RUNNING)

    @property
    def alive(self) -> Flags:
        """(R,) whether there is a robot that works; where the mission is over and no other has begun, at its end."""
        return np.where(np.repeat(self.over, self.robots), self.worked, self.working)

    def global_state(self) -> GlobalState:
        """Return what tells the global state of the worlds, and keeps it at the ends of missions from now on."""
        if self._state is None:
            self._state = GlobalState(self.worlds, options=self.action.mode != "velocity")
        return self._state

    def _start_episode(self, world: int, start: StartConfiguration | None = None) -> None:
        """Begin the next episode of a world; robots hold the options of the highest expert score."""
        scenario = self._source(world)
        if scenario is None:
            self.progress.stay(world)
            return
        if start is not None:
            for_start(self.mission, start)
            scenario = replace(scenario, start=start, mission=self.mission)
        self.doing[world] = scenario
        self.worlds.reset(world, scenario.start, scenario.seed, scenario.mission)
        self.worlds.hold(np.tile(self.choices.default, (self.robots, 1)), self.worlds.rows_of(world))
        self.progress.reset(world)
        self.returns[self.worlds.rows_of(world)] = 0.0
        if self.recorder is not None:
            self.recorder.open(world, {"scenario": scenario.id, "seed": scenario.seed})

    def close(self) -> None:
        """End the recordings of missions that are still going on."""
        if self.recorder is not None:
            self.recorder.close()

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period."""
        self._start_period(actions)
        if self.watch is None:
            self.worlds.run(self.program, self.ticks_per_step)
            return self.end_period()
        for _ in self._each_tick():
            self.watch()
        return self.end_period()

    def masks(self) -> Flags:
        """Return which options (R, O) of all goals can serve next; ValueError if actions are vectors."""
        if self.action.mode == "velocity":
            raise ValueError("masks: expected options as actions, got mode 'velocity'")
        return self.choices.masks(self.worlds.task.phase(), self.alive)

    def ticks(self, actions: NDArray[Any]) -> Iterator[Worlds]:
        """Run one decision period, and yield the worlds after each control period.

        In a world whose mission ends the period ends early. `actions` are options (R, C), or (R,) for one goal, whole
        numbers; vectors (R, 2), see `LearnerActions`; or both (R, C + 2), the options first.
        """
        self._start_period(actions)
        yield from self._each_tick()

    def tick(self) -> None:
        """Run one control period, and count it."""
        self.worlds.run(self.program, 1)

    def _start_period(self, actions: NDArray[Any]) -> None:
        if not self._begun:
            raise RuntimeError("step: call reset first")
        self.choices.apply(self.worlds, actions)
        self.finished = ()
        self.progress.reset_period()
        self.rewards.start_period()

    def _each_tick(self) -> Iterator[Worlds]:
        for _ in range(self.ticks_per_step):
            self.tick()
            yield self.worlds
            if len(self.progress.ended) and self.over.all():  # no world runs
                break

    def _steps(self) -> list[Step]:
        """Return the steps of a tick, with those that record and count it."""
        steps, recorder = self.worlds.steps(), self.recorder
        if recorder is not None:
            steps.append(Step(COUNTING, lambda now, _: recorder.record(), Rows.of(np.arange(1))))
        return [*steps, *self.progress.steps(), self.progress.ending(self._keep_ends)]

    def end_period(self) -> BatchStep:
        """Begin the next missions, and return the results of the period."""
        progress = self.progress
        self.rewards.of(self, self._gained)
        self.returns += self._gained
        self.finished = tuple(
            replace(end, returns=self.returns[self.worlds.rows_of(end.world)][: end.result.robots].tolist())
            for end in self.finished  # the first robots to join have the first rows
        )
        terminated, truncated = progress.outcome == COMPLETED, progress.outcome == TIME_OVER
        if self.begin_anew:
            for end in self.finished:
                self._start_episode(end.world)
        self.observer.observe(self.observations)
        if not self.begin_anew and np.count_nonzero(progress.outcome):  # a third of the time of `any`
            over = np.repeat(terminated | truncated, self.robots)
            self.observations[over] = self._final[over]
        return BatchStep(self.observations, self._gained, terminated, truncated, self._final)

    def _keep_ends(self) -> str:
        """Keep figures and last observations of missions that ended with the last tick; return STOP if none goes on."""
        ended, worlds = self.progress.ended, self.worlds
        self.observer.observe(self._final, ended)
        if self._state is not None:
            self._state.keep(ended)
        for world in ended.tolist():
            rows = worlds.rows_of(world)
            self.worked[rows] = self.working[rows]
            scenario, events = self.doing[world], int(worlds.collisions.events[world, 0])
            assert scenario is not None
            totals = {name: int(counts[world]) for name, counts in worlds.task.totals().items()}
            self.finished += (Finished(world, scenario, self.steps(world), result_of(worlds, world), events, totals),)
        return STOP if self.over.all() else ""


def mission_begun(
    mission: MissionConfig, start: StartConfiguration, seed: int, **settings: Unpack[EnvSettings]
) -> Batch:
    """Return one world at the start of one mission; its robots hold the options of the highest expert score.

    >>> batch = mission_begun(mission, random_start(mission, seed=1, index=0), seed=2)
    >>> run_out(batch).completed
    True

    """
    scenario = Scenario(start.id, seed, mission, start)
    settings["source"] = {0: scenario}.get  # which can be pickled
    batch = Batch(mission, begin_anew=False, **settings)
    batch.reset()
    return batch


def run_out(batch: Batch) -> MissionResult:
    """Run the mission of a single world to its end, with the options that its robots hold; return its result."""
    while not batch.over[0]:
        batch.tick()
    return batch.finished[0].result
