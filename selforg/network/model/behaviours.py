"""The parts of a network: sensors, behaviours with effects, goals, and the settings by which it decides."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

from selforg.network.model.conditions import Optional, Tree
from selforg.parameters import check_choice

SensorKind = Literal["fact", "number"]
Algorithm = Literal["default", "uniform"]


@dataclass(frozen=True)
class Sensor:
    """A named reading per robot: a fact (true or false) or a number."""

    name: str
    kind: SensorKind = "number"

    def __post_init__(self) -> None:
        check_choice(f"sensor {self.name!r}: kind", self.kind, get_args(SensorKind))


@dataclass(frozen=True)
class Effect:
    """What a behaviour is expected to do to a sensor: a signed change, on the scale of the wishes."""

    sensor: str
    change: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.change):
            raise ValueError(f"effect on {self.sensor!r}: expected a finite change, got {self.change}")


@dataclass(frozen=True)
class Interface:
    """What a behaviour shows to the network that holds it: what it needs and what it does."""

    preconditions: tuple[Tree | Optional, ...] = ()
    effects: tuple[Effect, ...] = ()


@dataclass(frozen=True)
class Behaviour:
    """Something a robot can do.

    Attributes:
        name: unique in its network.
        preconditions: ready when the product of the mandatory ones reaches `ready_threshold`.
        effects: expected changes.
        ready_threshold: [0, 1].
        priority: counts only between behaviours that influence the same sensor.
        interruptable: may be stopped before it ends itself.
        timeout: steps after which it is stopped [steps]; None: never.
        cost: for the planner, > 0.
        planner_independent: left out of planning.
        alternatives: for a coordinator: the interfaces of the configurations it can hold, of which each robot has one
            at a time. They come on top of `preconditions` and `effects`.

    """

    name: str
    preconditions: Sequence[Tree | Optional] = ()
    effects: Sequence[Effect] = ()
    ready_threshold: float = 0.8
    priority: int = 0
    interruptable: bool = True
    timeout: int | None = None
    cost: float = 1.0
    planner_independent: bool = False
    alternatives: Sequence[Interface] = field(default=())

    def __post_init__(self) -> None:
        if not 0.0 <= self.ready_threshold <= 1.0:
            raise ValueError(f"behaviour {self.name!r}: ready_threshold must lie in [0, 1], got {self.ready_threshold}")
        if self.timeout is not None and self.timeout < 0:
            raise ValueError(f"behaviour {self.name!r}: timeout must be >= 0 steps or None, got {self.timeout}")
        if not 0.0 < self.cost < math.inf:
            raise ValueError(f"behaviour {self.name!r}: cost must be positive and finite, got {self.cost}")

    @property
    def interfaces(self) -> list[tuple[int, Interface]]:
        """The interface that always holds (tag -1) and those of the alternatives (tag 0, 1, ...)."""
        always = Interface(tuple(self.preconditions), tuple(self.effects))
        return [(-1, always), *enumerate(self.alternatives)]


@dataclass(frozen=True)
class Goal:
    """What a robot wants. A satisfied goal that is not permanent switches off."""

    name: str
    conditions: Sequence[Tree]
    priority: int = 0
    permanent: bool = True
    satisfaction_threshold: float = 1.0

    def __post_init__(self) -> None:
        if not self.conditions:
            raise ValueError(f"goal {self.name!r}: expected at least one condition, got none")


@dataclass(frozen=True)
class Weights:
    """How much each term counts in the activation of a behaviour."""

    situation: float = 1.0
    goal: float = 1.0
    conflictor: float = 1.0
    predecessor: float = 1.0
    successor: float = 1.0
    plan: float = 1.0


@dataclass(frozen=True)
class NetworkSettings:
    """How a network decides.

    Attributes:
        algorithm: "default" (products of effect and wish) or "uniform" (their Euclidean length).
        activation_decay: share of its activation that a behaviour keeps from step to step, in [0, 1].
        activation_threshold: at the start; unbounded later.
        threshold_decay: factor on the threshold when nothing runs (and divisor when something starts), in (0, 1].
        max_parallel: behaviours that may run at once; None: any number.
        goal_priority: goals' priorities scale what they add, mapped onto [1, 2].
        strict_progress: a step of the plan is passed only when its effects were seen (the original passes positive
            effects at once, Q22).

    """

    algorithm: Algorithm = "default"
    weights: Weights = field(default_factory=Weights)
    activation_decay: float = 0.9
    activation_threshold: float = 7.0
    threshold_decay: float = 0.8
    max_parallel: int | None = None
    goal_priority: bool = False
    strict_progress: bool = False

    def __post_init__(self) -> None:
        check_choice("algorithm", self.algorithm, get_args(Algorithm))
        if not math.isfinite(self.activation_threshold):
            raise ValueError(f"activation_threshold must be finite, got {self.activation_threshold}")
        if not 0.0 < self.threshold_decay <= 1.0:
            raise ValueError(f"threshold_decay must lie in (0, 1], got {self.threshold_decay}")
        if not 0.0 <= self.activation_decay <= 1.0:
            raise ValueError(f"activation_decay must lie in [0, 1], got {self.activation_decay}")
        if self.max_parallel is not None and self.max_parallel < 1:
            raise ValueError(f"max_parallel must be at least 1 or None, got {self.max_parallel}")


def column_of(columns: Mapping[str, int], name: str, where: str) -> int:
    """Return the column of the sensor `name`, to which `where` refers; ValueError for an unknown one."""
    if name not in columns:
        raise ValueError(f"{where}: unknown sensor {name!r} (known: {', '.join(columns)})")
    return columns[name]
