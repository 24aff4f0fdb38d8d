"""Runs of a goal in its scene, with the mechanism of an option and with the baseline, from the same starts.

Shapes: W runs, one for each seed; all runs are in one batch.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.recording.scene_recording import SceneRecorder
from clean_swarm_env.scenes import Measure, Scene, Setting, find
from clean_swarm_env.scenes.baselines import Controller
from clean_swarm_env.scenes.ground import GroundKind
from clean_swarm_env.scenes.served import KNOWLEDGE, ServedTeam, expertise
from selector.knowledge import Knowledge, load_knowledge
from selector.store.exact_sums import REWARD_LIMIT
from selforg.arrays import Floats
from train.analysis.statistics import Summary, summarise
from train.knowledge_store import NO_STORE, Memory, StoreRequest, as_plain

BASELINE = "baseline"
"""What recordings of baselines are called."""


@dataclass(frozen=True)
class GoalRequest:
    """The request of the user; where a field is None, the scene has the value."""

    goal: str
    """Name of the goal."""
    option: str | None = None
    """Name of the option that serves it; the one of the highest score unless given."""
    robots: int | None = None
    """Number of robots."""
    seconds: float | None = None
    """Simulated time [s]."""
    ground: GroundKind | None = None
    """Kind of ground."""
    seed: int = 0
    """Seed of the first run; the others follow."""
    runs: int = 20
    """Number of runs, each with a seed of its own."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    knowledge: str = KNOWLEDGE
    """Name of the expert knowledge with the goal and the option."""
    store: StoreRequest = NO_STORE
    """The knowledge store; runs give back their scores."""
    record: Path | None = None
    """Directory in which every run is recorded; none is unless given."""

    @property
    def seeds(self) -> range:
        """Seeds of the runs."""
        return range(self.seed, self.seed + self.runs)

    @property
    def setting(self) -> Setting:
        """Setting of the scene with the changes of the request."""
        changes: dict[str, Any] = {
            name: value for name in ("robots", "seconds", "ground") if (value := getattr(self, name)) is not None
        }
        return replace(find(self.goal).setting, **changes)

    def memory(self) -> Memory | None:
        """Return the memory of these runs, whose context is the setting of the scene; None without a store."""
        setting, known = self.setting, load_knowledge(self.knowledge, self.directories)
        of_goal = Knowledge({self.goal: known.options(self.goal)}, known.source).with_learned(
            {goal: learned for goal, learned in known.learned.items() if goal == self.goal}
        )
        context = f"scene {setting.robots} robots, {setting.seconds:g} s, {setting.ground}"
        return self.store.memory(of_goal, context, f"goal {self.goal}, seeds {self.seeds[0]}-{self.seeds[-1]}")


@dataclass(frozen=True)
class MeasureComparison:
    """One measure of the mechanism and of the baseline, and their difference on the same starts."""

    measure: Measure
    mechanism: Summary
    baseline: Summary
    difference: Summary

    @property
    def met(self) -> bool:
        """Whether the mean reaches the target."""
        return self.measure.met(self.mechanism.mean)

    @property
    def beats(self) -> bool | None:
        """Whether the 95 % interval of the difference is on the better side of zero; None where there is none."""
        if self.difference.ci95 is None or self.measure.guard:
            return None
        low, high = self.difference.ci95
        return high < 0.0 if self.measure.better == "lower" else low > 0.0


@dataclass(frozen=True)
class GoalOutcome:
    """The result of running a goal."""

    scene: type[Scene]
    option: str
    setting: Setting
    seeds: Sequence[int]
    comparisons: tuple[MeasureComparison, ...]
    known: Knowledge | None = None
    """What a knowledge store knew of the options at the beginning."""

    @property
    def own_setting(self) -> bool:
        """Whether the setting is the one for which the targets are stated."""
        return self.setting == self.scene.setting

    @property
    def reached(self) -> bool:
        """Whether every target is met and every baseline that is to be beaten is."""
        return all(c.met and c.beats is not False for c in self.comparisons)


def run_goal(request: GoalRequest) -> GoalOutcome:
    """Run a goal in its scene.

    Raises:
        ConfigurationError: goal, option or setting do not exist or fit.

    """
    scene = find(request.goal)
    setting, memory = request.setting, request.memory()
    known = memory.knowledge if memory is not None else None
    expert = expertise(request.goal, request.option, request.directories, known or request.knowledge)
    if memory is not None:
        memory.check_new([expert.name])
    explained = request.record is not None
    served = _values(request, expert.name, lambda made: ServedTeam(made, expert, explained=explained))
    rival = _values(request, BASELINE)
    if memory is not None:
        if memory.learns:
            memory.give((request.goal, expert.name, score) for score in scores_of(scene, served).tolist())
        memory.close()
    compared = tuple(_compared(measure, served[measure.name], rival[measure.name]) for measure in scene.measures)
    return GoalOutcome(scene, expert.name, setting, request.seeds, compared, known)


def _values(request: GoalRequest, name: str, make: Callable[[Scene], Controller] | None = None) -> Mapping[str, Floats]:
    """Run the scene with what `make` returns, or with the baseline; return the measures (W,), and record if asked."""
    scene = find(request.goal)(request.setting, request.seeds)
    scene.start(make)
    recorder = SceneRecorder(scene, name, request.record, request.seeds) if request.record is not None else None
    while not scene.over:
        scene.advance()
        if recorder is not None:
            recorder.record()
    if recorder is not None:
        recorder.close()
    return scene.measured()


def score_goal(request: GoalRequest, memory: Memory) -> None:
    """Run every option of a goal in its scene and give the scores to the store, all at once."""
    memory.check_new()
    scene, rewards = find(request.goal), []
    for option in memory.knowledge.options(request.goal):
        expert = expertise(request.goal, option.name, request.directories, memory.knowledge)
        run = scene(request.setting, request.seeds).run(partial(ServedTeam, expert=expert))
        rewards += [(request.goal, option.name, score) for score in scores_of(scene, run.values).tolist()]
    memory.give(rewards)


def scores_of(scene: type[Scene], values: Mapping[str, Floats]) -> Floats:
    """Return the scores (W,) of runs: by the measure that is farthest from its target, in units of the target [-].

    The score is 1 where that measure just meets its target, 0 where it is as far away as the target is from 0.
    """
    scores = []
    for measure in scene.measures:
        sign = -1.0 if measure.better == "lower" else 1.0
        scores.append(1.0 + sign * (values[measure.name] - measure.target) / (abs(measure.target) or 1.0))
    lowest: Floats = np.min(scores, axis=0)
    return np.maximum(lowest, -REWARD_LIMIT)


def _compared(measure: Measure, served: Floats, rival: Floats) -> MeasureComparison:
    return MeasureComparison(measure, summarise(served), summarise(rival), summarise(np.subtract(served, rival)))


def as_mapping(outcome: GoalOutcome) -> dict[str, Any]:
    """Return the outcome as plain data for JSON."""
    setting = outcome.setting
    return {
        "goal": outcome.scene.goal,
        "option": outcome.option,
        "scene": outcome.scene.story,
        "baseline": outcome.scene.baseline,
        "robots": setting.robots,
        "seconds": setting.seconds,
        "arena": setting.ground,
        "seeds": list(outcome.seeds),
        "targets_are_for_this_setting": outcome.own_setting,
        "reached": outcome.reached,
        "known": as_plain(outcome.known.learned) if outcome.known is not None else None,
        "measures": [
            {
                "name": c.measure.name,
                "unit": c.measure.unit,
                "better": c.measure.better,
                "target": c.measure.target,
                "target_from": c.measure.reason,
                "target_met": c.met,
                "beats_baseline": c.beats,
                "mechanism": asdict(c.mechanism),
                "baseline": asdict(c.baseline),
                "difference": asdict(c.difference),
            }
            for c in outcome.comparisons
        ],
    }
