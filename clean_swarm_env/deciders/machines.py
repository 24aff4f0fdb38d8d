"""Deciders without strategies: one option, or a finite state machine.

Shapes: R rows, F components of an observation; S states; T transitions of the state that has most.
"""

from __future__ import annotations

import numpy as np

from clean_swarm_env.deciders.decider import OptionDecider
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import validated
from selector.strategies.machine_file import StateMachine
from selector.strategies.probing import Prober, Probing
from selector.strategies.problem import Problem
from selector.strategies.streams import Keys, row_keys, uniforms
from selforg.arrays import Flags, Ints


class FixedDecider(OptionDecider):
    """All rows hold one option.

    Args:
        option: its number.
        problem, teams: see `Decider`.

    """

    def __init__(self, option: int, problem: Problem, teams: Ints) -> None:
        super().__init__(problem, teams)
        self._option = option

    def _choose(self, observations: Observations) -> Ints:
        return np.full(len(observations), self._option)


class MachineDecider(OptionDecider):
    """Each row is in a state of the machine, and takes the option of this state.

    Args:
        machine: the machine.
        problem, teams: see `Decider`.
        probing: in place of that of the machine.

    Raises:
        DocumentError: the machine does not fit the problem.

    """

    def __init__(self, machine: StateMachine, problem: Problem, teams: Ints, probing: Probing | None = None) -> None:
        super().__init__(problem, teams)
        if probing is not None:
            content = machine.model_dump() | {"probing": probing.model_dump()}
            machine = validated(StateMachine, content, "machine", own=True)
        machine = machine.for_goal(problem.goal)
        machine.check_fits(problem, "machine")
        names, states = list(machine.states), list(machine.states.values())
        self._first = names.index(machine.start)
        self._options: Ints = np.array([problem.options.index(state.option) for state in states])
        shape = (len(states), max(len(state.transitions) for state in states))
        self._to, self._column = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64)
        self._above, self._below = np.full(shape, -np.inf), np.full(shape, np.inf)
        self._probability = np.zeros(shape)  # of a transition that does not exist
        for s, state in enumerate(states):
            for t, way in enumerate(state.transitions):
                self._to[s, t], self._probability[s, t] = names.index(way.to), way.probability
                self._column[s, t] = problem.features.index(way.when) if way.when is not None else 0
                self._above[s, t] = -np.inf if way.above is None else way.above
                self._below[s, t] = np.inf if way.below is None else way.below
        self._prober = Prober(machine.probing, problem, teams)
        self._used: Flags = np.isin(np.arange(len(problem.options)), self._options)
        self._states: Ints = np.full(len(teams), self._first)
        self._keys: Keys = row_keys(np.random.SeedSequence(0), len(teams))
        self._decided: Keys = np.zeros(len(teams), dtype=np.uint64)

    def reset(self, rows: Ints, seed: int) -> None:
        """Put `rows` (N,) into the first state, with new keys of random numbers."""
        self._states[rows], self._decided[rows] = self._first, 0
        self._keys[rows] = row_keys(np.random.SeedSequence([seed, 1]), len(rows))
        self._prober.reset(rows, seed)

    def _choose(self, observations: Observations) -> Ints:
        """Return the options (R,) of the states after this decision's transitions."""
        states = self._states
        if self._to.shape[1]:
            seen = np.take_along_axis(observations.astype(np.float64), self._column[states], axis=1)  # (R, T)
            drawn = uniforms(self._keys, self._decided, self._to.shape[1])
            open_ways = (
                (seen > self._above[states]) & (seen < self._below[states]) & (drawn < self._probability[states])
            )
            first = open_ways.argmax(axis=1)
            self._states = np.where(open_ways.any(axis=1), self._to[states, first], states)
            self._decided += np.uint64(1)
        return self._prober.held(self._prober.choose(self._options[self._states], self._used), observations)
