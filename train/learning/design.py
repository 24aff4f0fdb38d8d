"""Automatic design of finite state machines by iterated races, as AutoMoDe does it for swarms.

Francesca et al. 2014, doi:10.1007/s11721-014-0092-4; see `train.learning.racing`. In each race new machines and the
best ones so far meet scenarios on which none of them was chosen.

In new machines a threshold is drawn within two standard deviations about the mean of its component. Numbers are
rounded, so that a machine can be read.

Shapes: C candidates, N scenarios of a block.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field

from clean_swarm_env.deciders.decider import DeciderMaker
from clean_swarm_env.deciders.machines import MachineDecider
from selector.documents.fields import Closed
from selector.documents.reading import as_yaml
from selector.strategies.machine_file import MachineState, StateMachine, Transition
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms
from train.learning.config import DesignConfig
from train.learning.members import Drawing, MembersTraining, ObservationScale
from train.learning.racing import race

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


MACHINE_FILE = "machine.yaml"


class DesignState(Closed):
    """What a design knows after a race."""

    kept: Annotated[tuple[StateMachine, ...], Field(min_length=1)]
    """The best machines, best first."""


class DesignTraining(MembersTraining[DesignState]):
    """One design of a machine."""

    State = DesignState
    settings: DesignConfig

    def export(self, command: str) -> Path:
        """Write the best machine so far and return its file."""
        usual = self.curriculum.batches[0].worlds.task.terms
        seen = tuple(term.name for term in self.config.observation.terms or () if term.name not in usual)
        about = {"description": self.config.description, "terms": seen, "training": self.about(command)}
        machine = self._best.kept[0].model_copy(update=about)
        self.job.folder.write(MACHINE_FILE, as_yaml(machine.model_dump(mode="json", exclude_defaults=True)))
        return self.job.folder.path / MACHINE_FILE

    def _first(self, order: Ints) -> DesignState:
        alone = [MachineState(option=self.problem.options[option]) for option in order[: self.settings.kept]]
        return DesignState(
            kept=tuple(StateMachine(goal=self.problem.goal, start="state 1", states={"state 1": one}) for one in alone)
        )

    def _next(self, draw: Drawing, random: np.random.Generator) -> DesignState:
        settings, kept = self.settings, self.state.kept
        space = MachineSpace(self.problem, self.scale, settings, random)
        machines = [*kept]
        for _ in range(settings.candidates):
            parent = kept[random.integers(len(kept))]
            new = space.drawn() if random.random() < settings.fresh else space.changed(parent)
            if new not in machines:
                machines.append(new)
        done: list[list[Floats]] = [[] for _ in machines]

        def measure(alive: Sequence[int], _: int) -> Floats:
            """Let candidates do one block more; return the logarithms (C, n) of all their costs."""
            costs = self.costs([partial(MachineDecider, machines[k]) for k in alive], draw(settings.race.block))[0]
            for k, own in zip(alive, logarithms(costs).T, strict=True):
                done[k].append(own)
            return np.array([np.concatenate(done[k]) for k in alive])

        left = race(len(machines), measure, settings.race)
        left.sort(key=lambda k: float(np.mean(done[k])))
        return DesignState(kept=tuple(machines[k] for k in left[: settings.kept]))

    def _check(self, state: DesignState, where: str) -> None:
        for machine in state.kept:
            machine.check_fits(self.problem, where)

    def _decider_maker(self) -> DeciderMaker:
        return partial(MachineDecider, self.state.kept[0])
