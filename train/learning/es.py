"""Evolution strategies by missions: a linear policy climbs by the costs of antithetic pairs of members.

Salimans et al. 2017, "Evolution Strategies as a Scalable Alternative to Reinforcement Learning",
doi:10.48550/arXiv.1703.03864, with Adam (Kingma & Ba 2015, doi:10.48550/arXiv.1412.6980). All members do the same
scenarios, because costs depend far more on the scenarios than on the members.

Of goals that are decided as one each has weights of its own, and the output of a combination is the sum of theirs.

Shapes: K pairs, P parameters (F weights and a bias of each option of each of the G goals), O options or combinations.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from clean_swarm_env.deciders.decider import DeciderMaker
from clean_swarm_env.deciders.strategies import PolicyDecider
from selector.documents.fields import Closed, Number
from selector.strategies.policy_file import PolicySpec, TrainedPolicy, save_policy
from selector.strategies.streams import normals
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms
from train.learning.config import EsConfig
from train.learning.members import Drawing, MembersTraining, check_lengths

POLICY_FOLDER = "policy"
LEAST_VARIANCE = 1e-3
"""Added to the variance of a component, which may have been the same in all missions of the options alone."""
SLOPE_DECAY, SQUARE_DECAY, SMALL = 0.9, 0.999, 1e-8
"""Adam's weights of the old means, and what keeps its quotient finite."""

Numbers = tuple[Number, ...]


class EsState(Closed):
    """What evolution strategies know after a generation."""

    parameters: Numbers
    """(P,) the point about which members are drawn."""
    average: Numbers
    """(P,) running mean of the points, which is exported."""
    slope: Numbers
    """(P,) Adam's running mean of slopes."""
    square: Numbers
    """(P,) Adam's running mean of their squares."""
    decays: tuple[Number, Number] = (1.0, 1.0)
    """Weights of the zeros with which Adam's two means began."""


class EsTraining(MembersTraining[EsState]):
    """One training of a linear policy."""

    State = EsState
    settings: EsConfig

    def policy(self, parameters: Floats, **training: object) -> TrainedPolicy:
        """Return the policy of `parameters` (P,): no hidden layer, outputs linear in the scaled observation."""
        problem, tables = self.problem, parameters.reshape(-1, len(self.problem.features) + 1)
        matrix = tables[self._rows_of(np.arange(len(problem.options)))].sum(axis=1).astype(np.float32)
        spec = PolicySpec(
            goals={problem.goal: problem.options},
            definitions=problem.definitions,
            observations=problem.features,
            hidden=(),
            mean=self.scale.mean,
            variance=self.scale.variance,
            epsilon=LEAST_VARIANCE,
            training=training,
        )
        return TrainedPolicy(spec, {"options.weight": matrix[:, :-1], "options.bias": matrix[:, -1]})

    def export(self, command: str) -> Path:
        """Write the best policy so far and return its directory."""
        path = self.job.folder.path / POLICY_FOLDER
        save_policy(path, self.policy(np.array(self._best.average), **self.about(command)))
        return path

    def _first(self, order: Ints) -> EsState:
        first = self._table()
        first[self._rows_of(order[:1]), -1] = self.settings.lead
        point, nothing = tuple(first.ravel().tolist()), (0.0,) * first.size
        return EsState(parameters=point, average=point, slope=nothing, square=nothing)

    def _next(self, draw: Drawing, random: np.random.Generator) -> EsState:
        settings, state = self.settings, self.state
        point = np.array(state.parameters)
        noise = np.empty((settings.pairs, len(point)))
        normals(random.random((settings.pairs, 2 * len(point))), noise)
        noise = np.concatenate([noise, -noise])
        members = [partial(PolicyDecider, self.policy(point + settings.sigma * one)) for one in noise]
        costs, _ = self.costs(members, draw(settings.scenarios))
        fitness = relative(costs.ravel(), len(members), settings.limit).reshape(costs.shape).mean(axis=0)
        slope = (fitness[:, None] * noise).sum(axis=0) / (len(members) * settings.sigma)
        return climbed(state, slope, settings.learning_rate, settings.averaged)

    def _check(self, state: EsState, where: str) -> None:
        size = self._table().size
        check_lengths(size, (state.parameters, state.average, state.slope, state.square), where)

    def _table(self) -> Floats:
        """Return zeros for the parameters, a row of weights and a bias for each option of each goal."""
        return np.zeros((sum(map(len, self.goal.parts)), len(self.problem.features) + 1))

    def _rows_of(self, options: Ints) -> Ints:
        """Return the rows (N, G) of the table of parameters that belong to combinations (N,)."""
        first: Ints = np.cumsum([0, *map(len, self.goal.parts[:-1])])
        return self.goal.combined(options) + first

    def _decider_maker(self) -> DeciderMaker:
        return partial(PolicyDecider, self.policy(np.array(self.state.average)))


def climbed(state: EsState, slope: Floats, rate: float, averaged: float) -> EsState:
    """Return the state after a step of Adam along the `slope` (P,) of the fitness.

    The first step of Adam has the length `rate` in each parameter:

    >>> first = EsState(parameters=(0.0, 1.0), average=(0.0, 1.0), slope=(0.0, 0.0), square=(0.0, 0.0))
    >>> [round(value, 6) for value in climbed(first, np.array([3.0, -0.5]), rate=0.1, averaged=0.5).parameters]
    [0.1, 0.9]

    """
    slopes = SLOPE_DECAY * np.array(state.slope) + (1.0 - SLOPE_DECAY) * slope
    squares = SQUARE_DECAY * np.array(state.square) + (1.0 - SQUARE_DECAY) * slope**2
    decays = (SLOPE_DECAY * state.decays[0], SQUARE_DECAY * state.decays[1])
    step = slopes / (1.0 - decays[0]) / (np.sqrt(squares / (1.0 - decays[1])) + SMALL)
    point = np.array(state.parameters) + rate * step
    average = averaged * np.array(state.average) + (1.0 - averaged) * point
    parts = {"parameters": point, "average": average, "slope": slopes, "square": squares}
    return EsState(**{name: tuple(part.tolist()) for name, part in parts.items()}, decays=decays)


def relative(cost: Floats, group: int, limit: float) -> Floats:
    """Return the rewards (M,) of missions, compared with their groups: -ln(cost / median), limited to +-`limit` [-].

    Costs of missions depend far more on the scenarios than on the members. So a reward is the difference to the other
    missions of the scenario: the baseline of REINFORCE with several rollouts (Kool et al. 2019, "Buy 4 REINFORCE
    samples, get a baseline for free"), here with the median, because a few failed missions would change a mean.

    >>> relative(np.array([10.0, 40.0, 20.0, 5.0, 5.5, 5.0]), 3, limit=0.5).round(2).tolist()
    [0.5, -0.5, 0.0, 0.0, -0.1, 0.0]

    """
    grouped = logarithms(cost).reshape(-1, group)
    rewards: Floats = (np.median(grouped, axis=1, keepdims=True) - grouped).ravel()
    return np.clip(rewards, -limit, limit) + 0.0
