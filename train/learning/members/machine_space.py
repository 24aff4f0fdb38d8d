"""The space of machines that a design searches: random machines, and changes of a machine.

A threshold is drawn within two standard deviations about the mean of its component. Numbers are rounded, so that a
machine can be read.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from selector.strategies.machine_file import MachineState, StateMachine, Transition
from selector.strategies.problem import Problem
from train.learning.config import DesignConfig
from train.learning.members.training import ObservationScale

Thing = TypeVar("Thing")
States = dict[str, MachineState]
MOST_CHANGES = 3
"""Most changes that make a new machine from another."""
DECIMALS = 3


class MachineSpace:
    """Draws machines.

    Args:
        problem: goal, options and components of the observation.
        scale: mean and variance of each component.
        settings: the sizes of machines.
        random: what everything is drawn from.

    """

    def __init__(
        self, problem: Problem, scale: ObservationScale, settings: DesignConfig, random: np.random.Generator
    ) -> None:
        self._problem, self._settings, self._random = problem, settings, random
        self._mean, self._spread = np.array(scale.mean), 2.0 * np.sqrt(np.array(scale.variance))
        self._names = [f"state {k + 1}" for k in range(settings.states)]

    def drawn(self) -> StateMachine:
        """Return a machine whose parts are all drawn."""
        names = self._names[: 1 + int(self._random.integers(len(self._names)))]
        states = {}
        for name in names:
            count = int(self._random.integers(self._settings.transitions + 1)) if len(names) > 1 else 0
            ways = tuple(self._way(name, names) for _ in range(count))
            states[name] = MachineState(option=self._one_of(self._problem.options), transitions=ways)
        return StateMachine(goal=self._problem.goal, start=names[0], states=states)

    def changed(self, machine: StateMachine) -> StateMachine:
        """Return a machine that differs from another by one to three changes."""
        states, start = dict(machine.states), machine.start
        for _ in range(1 + int(self._random.integers(MOST_CHANGES))):
            change = self._one_of([self._other_option, self._other_way, self._without_way, self._new_state])
            change(states, self._one_of(list(states)))
            if len(states) > 1 and not self._random.integers(5):
                self._without_state(states, self._one_of([name for name in states if name != start]))
        return StateMachine(goal=machine.goal, start=start, states=states)

    def _other_option(self, states: States, name: str) -> None:
        states[name] = states[name].model_copy(update={"option": self._one_of(self._problem.options)})

    def _other_way(self, states: States, name: str) -> None:
        """Redraw a transition, or add one."""
        if len(states) == 1:
            return
        ways = list(states[name].transitions)
        place = int(self._random.integers(min(len(ways) + 1, self._settings.transitions)))
        ways[place : place + 1] = [self._way(name, list(states))]
        states[name] = states[name].model_copy(update={"transitions": tuple(ways)})

    def _without_way(self, states: States, name: str) -> None:
        ways = list(states[name].transitions)
        if ways:
            del ways[self._random.integers(len(ways))]
            states[name] = states[name].model_copy(update={"transitions": tuple(ways)})

    def _new_state(self, states: States, name: str) -> None:
        """Add a state with a way to it and one back."""
        free = [other for other in self._names if other not in states]
        if free:
            back = self._way(free[0], [name, free[0]])
            states[free[0]] = MachineState(option=self._one_of(self._problem.options), transitions=(back,))
            there = self._way(name, [name, free[0]])
            ways = (there, *states[name].transitions)[: self._settings.transitions]
            states[name] = states[name].model_copy(update={"transitions": ways})

    def _without_state(self, states: States, name: str) -> None:
        del states[name]
        for other, state in states.items():
            ways = tuple(way for way in state.transitions if way.to != name)
            states[other] = state.model_copy(update={"transitions": ways})

    def _way(self, name: str, names: Sequence[str]) -> Transition:
        """Return a transition from a state to another."""
        to = self._one_of([other for other in names if other != name])
        probability = round(float(self._random.random()), DECIMALS)
        if not self._random.integers(4):
            return Transition(to=to, probability=probability)
        k = int(self._random.integers(len(self._problem.features)))
        bound = round(float(self._mean[k] + self._spread[k] * (2.0 * self._random.random() - 1.0)), DECIMALS)
        above, below = (bound, None) if self._random.integers(2) else (None, bound)
        return Transition(to=to, when=self._problem.features[k], above=above, below=below, probability=probability)

    def _one_of(self, things: Sequence[Thing]) -> Thing:
        return things[int(self._random.integers(len(things)))]
