"""The reward of a selector: the cost of the mission, and shaping terms.

In a mission, the mean payment over the robots of a world adds up to the mission's cost (`Task.cost`) times the weight
`cost`. For cleaning that is exact where the mission can be completed; where garbage keeps coming, an item is worth the
mean time between two arrivals. The price of collisions is shared among the robots that took part in them.

What a task counts (`Task.achievements`) has weights, too: `own_NAME` for each time that the robot itself did it, and
`NAME` for its team where the task counts that.

Terms of one's own (`REWARD_TERMS`) have weights beside these: `reward: {cost: -0.01, my_term: 0.5}`.

The shaping terms are plain counts, not differences of a potential. So they may change which behaviour is best: a robot
paid for picking could carry items about. Their weights are 0 unless given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from reprlib import repr as brief
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import ConfigDict, Field, create_model, model_validator

from clean_swarm_env.config.task_names import TASKS_HOME
from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.learning.given import config_from
from clean_swarm_env.learning.progress import Period, open_period
from clean_swarm_env.world.mission_end import COMPLETED
from clean_swarm_env.world.parts.measure import key_of
from clean_swarm_env.world.task import Task
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import DocumentError, unknown_key
from selector.documents.fields import Closed, Number, Share
from selector.documents.imported import imported, registered
from selector.documents.trust import is_import
from selforg.arrays import READ, Floats
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.plugins import contract
from selforg.registry import Registry

REWARD_TERMS: Registry[Any] = Registry("reward term")
"""Functions of a batch at the end of a decision period that return what each robot is paid (R,), by their names.

    @REWARD_TERMS.register
    def eastward(batch):
        return batch.worlds.physics.positions[:, 0] / batch.worlds.extent[0]
"""


class WeightsConfig(Closed, extra="allow"):
    """Weights of terms, and of registered reward terms, or of `module:function`."""

    __pydantic_extra__: dict[str, Number] = Field(init=False)

    @model_validator(mode="before")
    @classmethod
    def _are_registered(cls, given: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
        """Replace `module:function` by its registered name, and name the known terms beside an unknown one."""
        if not isinstance(given, Mapping):
            return given
        named = {registered(key, REWARD_TERMS) if is_import(str(key)) else key: given[key] for key in given}
        for key in named.keys() - cls.model_fields.keys():
            if key not in REWARD_TERMS and key not in cls.known():
                raise unknown_key(str(key), (*cls.known(), *REWARD_TERMS.names()))
        return named

    @classmethod
    def known(cls) -> tuple[str, ...]:
        """Return the names of weights beside those of registered terms."""
        return tuple(cls.model_fields)


class RewardConfig(WeightsConfig):
    """Weights of the reward's terms; each robot gets their sum once a decision period.

    It takes weights of what any task counts as well; `weights_of` has those of one task.
    """

    model_config = ConfigDict(use_attribute_docstrings=True)
    cost: Number = -0.01
    """For each second by which the cost of the mission grew: time, collisions, and at the end what is left [1/s]."""
    time: Number = 0.0
    """Shaping: for each second that passed before the mission was over [1/s]."""
    completed: Number = 0.0
    """Shaping: once, when the task is done [-]."""
    collision: Number = 0.0
    """Shaping: for each collision event in which the robot took part [1/event]."""
    price: Number = 0.0
    """Shaping: for each second that the robot's own collisions add to the cost, none where they cost nothing [1/s]."""
    contact: Number = 0.0
    """Shaping: for each second in which somebody was closer than the collision distance [1/s]."""
    avoiding: Number = 0.0
    """Shaping: for each second in which the robot avoided others [1/s]."""
    shared: Share = 0.0
    """Share of a robot's own terms (collisions and shaping) that goes to all robots of its world alike [-]."""

    @classmethod
    def known(cls) -> tuple[str, ...]:
        """Return the names of weights, those of what some task counts included."""
        import_module(TASKS_HOME)
        kinds: list[Any] = list(TASKS)
        return (*super().known(), *(name for kind in kinds for part in counted_by(kind) for name in part))


def counted_by(task: type[Task[Any, Any]] | Task[Any, Any]) -> tuple[list[str], list[str]]:
    """Return the names of the weights of what a task counts: of teams, and of each robot."""
    teams = [achievement.name for achievement in task.achievements if achievement.team]
    return teams, [f"own_{achievement.name}" for achievement in task.achievements]


def weights_of(task: Task[Any, Any]) -> type[WeightsConfig]:
    """Return the model of the weights of a task: 1 for measures, for which a task without a cost pays, others 0.

    Cost and price are known where the task has them. What it counts stands in the order in which files have it.
    """
    teams, own = counted_by(task)
    fields: dict[str, Any] = {} if task.priced else {key_of(one.name): (Number, 1.0) for one in task.measures}
    for name, field in RewardConfig.model_fields.items():
        if task.priced or name not in ("cost", "price"):
            fields[name] = (field.annotation, field)
        fields |= dict.fromkeys({"cost": teams, "price": own}.get(name, ()), (Number, 0.0))
    return create_model("RewardConfig", __base__=WeightsConfig, **fields)


OwnRewards = Callable[[Any], Floats]
"""A function of a batch at the end of a period that returns the rewards (R,)."""
GivenReward = RewardConfig | Mapping[str, Any] | OwnRewards | str
"""Weights of the reward's terms, a function of the batch, or `module:function`."""


def own_rewards(chosen: object) -> OwnRewards | None:
    """Return the user's own function, given as it is or as `module:name`, with its result checked; None for weights.

    The function is called at the end of each decision period, before worlds whose missions ended start their next
    episode. Robots that took no part in the period are paid nothing.
    """
    function = imported(chosen, "reward") if isinstance(chosen, str) else chosen
    if not callable(function):
        return None

    def rewards(batch: Any) -> Floats:  # noqa: ANN401  (a Batch, which stands above this module)
        with contract(function, ""):
            given = function(batch)
        paid = np.asarray(given, dtype=np.float64)
        if paid.shape != (batch.rows,) or not np.isfinite(paid).all():
            where = f"reward: {getattr(function, '__name__', '')}".removesuffix(": ")
            raise DocumentError(f"{where}: expected finite numbers of shape {(batch.rows,)}, got {brief(given)}")
        return np.where(batch.took_part, paid, 0.0)

    return rewards


class Prices(NamedTuple):
    """Weights of the reward by ticks in place of seconds; see `RewardConfig`."""

    own: Annotated[Floats, "E", READ]  # for each event of a robot, in the order of `Period.events`
    team: Annotated[Floats, "A", READ]  # for each achievement of the team
    cost: float  # for each second of the mission's cost
    tick: float
    completed: float
    price: float  # for each second of the price of a robot's own collisions
    shared: float


open_prices = opening(Prices)


class Rewards:
    """Rewards (R,) by weights of what the progress of a batch counted in a period, or by the user's own function.

    A task without a cost pays how much each measure has improved, in units of its target, or its own reward. So the sum
    over a mission is the measure at the end, less the measure at the start, by its target; the sign is that of
    "better". All robots of a world are paid alike for it.

    Attributes:
        weights: name of a term, or key of a measure -> weight.
        prices: the record `Prices`, with its handle.

    """

    def __init__(self, given: GivenReward | None, worlds: Worlds) -> None:
        """Turn the weights of the task of `worlds` into prices, or check the function."""
        self._own, self._worlds, task = own_rewards(given), worlds, worlds.task
        weights: Any = given.model_dump(exclude_unset=True) if isinstance(given, RewardConfig) else given
        chosen = config_from(weights_of(task), None if self._own else weights, "reward")
        further = ((own_rewards(REWARD_TERMS.find(name)), weight) for name, weight in chosen.__pydantic_extra__.items())
        self._further = [(function, weight) for function, weight in further if function is not None]
        paid: dict[str, float] = chosen.model_dump()
        self.weights = paid
        own = [*(paid[name] for name in counted_by(task)[1]), paid["collision"]]
        self.prices = Packed(
            Prices(
                own=np.array([*own, paid["contact"] * worlds.period, paid["avoiding"] * worlds.period]),
                team=np.array([paid.get(achievement.name, 0.0) for achievement in task.achievements]),
                cost=paid.get("cost", 0.0),
                tick=paid["time"] * worlds.period,
                completed=paid["completed"],
                price=paid.get("price", 0.0),
                shared=paid["shared"],
            )
        )
        self._measures = () if task.priced or self._own else task.measures
        signs = [1.0 if measure.better == "higher" else -1.0 for measure in self._measures]
        units = [abs(measure.target) or 1.0 for measure in self._measures]
        self._gains = np.array([paid[key_of(measure.name)] for measure in self._measures]) * signs / units
        self._before: Floats = np.zeros((len(units), worlds.worlds))

    def start_period(self) -> None:
        """Note the measures as they are."""
        self._before = self._measured()

    def of(self, batch: Any, rewards: Floats) -> None:  # noqa: ANN401  (a Batch, which stands above this module)
        """Fill `rewards` (R,) with those of the last period of a batch; robots that took no part get none."""
        if self._own is not None:
            rewards[:] = self._own(batch)
        else:
            pay(batch.progress.period.handle, self.prices.handle, rewards)
        if self._measures:
            rewards += np.where(batch.took_part, self._improved(batch), 0.0)
        for term, weight in self._further:
            rewards += weight * term(batch)

    def _improved(self, batch: Any) -> Floats:  # noqa: ANN401
        """Return what robots (R,) are paid for the measures."""
        own, now = self._worlds.task.reward(), self._measured()
        if own is not None:
            return own
        for end in batch.finished:  # such a world has gone on until the end of the period
            now[:, end.world] = list(end.result.measures.values())
        return np.repeat(self._gains @ (now - self._before), self._worlds.robots)

    def _measured(self) -> Floats:
        """Return the present measures (K, W)."""
        values = self._worlds.task.result() if self._measures else {}
        return np.array([values[measure.name] for measure in self._measures])


@lean_kernel
def pay(period: Handle[Period], prices: Handle[Prices], rewards: Floats) -> None:
    """Fill `rewards` (R,) of a period; see `RewardConfig`."""
    counted, price = open_period(period), open_prices(prices)
    robots = rewards.shape[0] // counted.ticks.shape[0]
    for world in range(counted.ticks.shape[0]):
        team = 0.0
        for kind in range(price.team.shape[0]):
            team += price.team[kind] * counted.team[kind, world]
        team += price.tick * counted.ticks[world]
        team += price.cost * counted.cost[world]
        if counted.outcome[world] == COMPLETED and counted.ticks[world] > 0:
            team += price.completed
        bumps, total, members = 0.0, 0.0, 0
        for row in range(world * robots, (world + 1) * robots):
            if counted.took_part[row]:
                bumps += counted.bumps[row]
                members += 1
        collisions = price.cost * counted.price[world]
        if bumps == 0.0:  # contacts between two ticks only, or with robots that take no part
            team += collisions
        for row in range(world * robots, (world + 1) * robots):
            rewards[row] = 0.0
            if not counted.took_part[row]:
                continue
            rewards[row] += price.price * counted.bumps[row]
            for kind in range(price.own.shape[0]):
                rewards[row] += price.own[kind] * counted.events[kind, row]
            if bumps > 0.0:
                rewards[row] += collisions * members * counted.bumps[row] / bumps
            total += rewards[row]
        for row in range(world * robots, (world + 1) * robots):
            if counted.took_part[row]:
                rewards[row] = team + (1.0 - price.shared) * rewards[row] + price.shared * total / members
