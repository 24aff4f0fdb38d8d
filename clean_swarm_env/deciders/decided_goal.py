"""The goals of a mission for which a decider chooses options; others keep the option of highest score.

Several goals are decided as one: their names and those of their options are joined by `+`. The joint goal
`ExplorationPatrol+AvoidCollision` has an option `LevyWalk+ORCA`, and as many others as there are combinations.

Shapes: R rows, C goals that the mission coordinates, in the order of the robot's document; G goals that are decided;
O options.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.deciders.decider import Decider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import DocumentError
from selector.documents.fields import JOINT
from selector.documents.plain import must_fit
from selector.documents.trust import BASELINE
from selector.knowledge import must_know_option
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from selforg.registry import unknown

AskedGoal = str | Sequence[str] | None
"""Which goals are decided: one, several joined by `+`, those of a sequence that there are, or the usual one."""


class DecidedGoal:
    """One goal of a batch, or several, and its options as actions.

    Args:
        batch: the worlds.
        goal: name of the goal, or several joined by `+`; the goal that `named_goal` returns unless given. Of a sequence
            of goals, those that the mission coordinates are decided.

    Attributes:
        problem: goal, options and scores; the features are all components of the observation. The score of a
            combination is the sum of its options' scores.
        parts: (G,) for each of the goals that are decided, its options.
        names: (G,) the goals that are decided.
        goals: C.
        columns: (G,) the goals that are decided among those that the mission coordinates.
        worlds: the worlds of the batch.

    Raises:
        DocumentError: the mission does not coordinate the goal, or has several goals of which none is named.

    """

    def __init__(self, batch: Batch, goal: AskedGoal = None) -> None:
        models = {coordinator.model.goal: coordinator.model for coordinator in batch.worlds.coordinators}
        if goal is None or isinstance(goal, str):
            names = [named_goal(tuple(models), name) for name in ([None] if goal is None else goal.split(JOINT))]
        else:
            names = [name for name in goal if name in models] or [named_goal(tuple(models), goal[0])]
        must_fit(len(set(names)) == len(names), "goal", "each goal once", str(goal))
        self.names, self.columns = tuple(names), [list(models).index(name) for name in names]
        self.parts = tuple(tuple(models[name].options) for name in names)
        self._default, self._recorder, self._mode = batch.choices.default, batch.recorder, batch.action.mode
        self.goals, self.worlds = len(self._default), batch.worlds
        inputs = self._recorder.settings.inputs if self._recorder is not None else ()
        self._inputs = [batch.observer.names.index(name) for name in inputs]
        self.problem = replace(models[names[0]].problem, features=batch.observer.names)
        if len(names) > 1:
            options = tuple(JOINT.join(each) for each in product(*self.parts))
            scores = np.array([sum(each) for each in product(*(models[name].scores for name in names))])
            meant = {name: models[name].problem.definitions[name] for name in names}
            self.problem = Problem(JOINT.join(names), options, scores, batch.observer.names, definitions=meant)

    def decide(self, decider: Decider, observations: Observations) -> NDArray[Any]:
        """Return the actions of a batch whose decider sees `observations` (R, F); a recording notes its opinions."""
        options, vectors = decider.decide(observations)
        self.worlds.follow_baseline(decider.is_baseline)
        if self._mode == "velocity":
            return vectors
        if decider.is_baseline:
            options = np.full(len(options), self._baseline)
        if self._recorder is not None:
            self._recorder.note_inputs(observations[:, self._inputs].astype(np.float64))
            self.think(np.eye(len(self.problem.options))[options] if decider.is_baseline else decider.opinions())
        actions = self.actions(options)
        return actions if self._mode == "option" else np.hstack([actions, vectors])

    @cached_property
    def _baseline(self) -> int:
        """The option that is the baseline of the task; the first one where the task itself leads."""
        name = self.worlds.task.baseline_option
        return self.problem.options.index(option_named(self.problem, name)) if name else 0

    def number_of(self, option: str) -> int:
        """Return the combination that is best by score of those with an option; DocumentError if there is none."""
        return self.problem.options.index(option_named(self.problem, option))

    def hold(self, rows: Ints, option: int) -> None:
        """Give a combination to rows (K,) at once, before the next decision."""
        for goal, own in zip(self.names, self.combined(np.array([option]))[0], strict=True):
            self.worlds.minds.coordinator_of(goal).hold(rows, np.full(len(rows), own))

    def check(self, decider: Decider) -> None:
        """Raise DocumentError for a decider that lets a baseline lead where the task or the knowledge has none."""
        if decider.is_baseline and not self.worlds.task.baseline:
            raise DocumentError(f"{BASELINE}: the task {self.worlds.mission.task.name} has none")
        if decider.is_baseline:
            _ = self._baseline

    def actions(self, options: Ints) -> Ints:
        """Return the actions (R, C) of a batch in which `options` (R,) serve the goal."""
        actions = np.tile(self._default, (len(options), 1))
        actions[:, self.columns] = self.combined(options)
        return actions

    def combined(self, options: Ints) -> Ints:
        """Return the option of each goal (N, G) in combinations (N,)."""
        return np.stack(np.unravel_index(options, [len(part) for part in self.parts]), axis=1)

    def think(self, opinions: Floats) -> None:
        """Record the opinions (R, O) of the options.

        Of an option of one goal: the sum of its combinations where these are probabilities, else the best of them.
        """
        assert self._recorder is not None
        table = opinions.reshape(-1, *(len(part) for part in self.parts))
        together = np.sum if np.allclose(opinions.sum(axis=1), 1.0) else np.max
        for k, goal in enumerate(self.names):
            others = tuple(1 + other for other in range(len(self.names)) if other != k)
            self._recorder.think(goal, together(table, axis=others))


def option_named(problem: Problem, name: str) -> str:
    """Return the option of a name, or the best by score of the combinations that hold all options that it names.

    Raises:
        DocumentError: there is none.

    """
    wanted = set(name.split(JOINT))
    fitting = [option for option in problem.options if option == name or wanted <= set(option.split(JOINT))]
    if not fitting:
        must_know_option(problem.goal, name, problem.options, f"goal {problem.goal}")
    return max(fitting, key=lambda option: problem.scores[problem.options.index(option)])


def named_goal(known: Sequence[str], wanted: str | None) -> str:
    """Return the goal `wanted` if given, else AvoidCollision if it is `known`, else the only known goal."""
    if wanted is not None:
        if wanted not in known:
            others = "robots choose options for goals of their network that their knowledge has"
            raise DocumentError(f"goal: {unknown('goal', wanted, known)}; {others}")
        return wanted
    if AVOIDANCE in known or len(known) == 1:
        return AVOIDANCE if AVOIDANCE in known else known[0]
    raise DocumentError(f"goal: expected the name of one of {', '.join(known)}")
