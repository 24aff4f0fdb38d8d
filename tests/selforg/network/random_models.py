"""Random networks and random lives for them: everything a model can say, in small."""

import warnings
from typing import Any

import numpy as np

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Interface, NetworkSettings, Sensor, Weights
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional, Tree
from selforg.network.model.model import NetworkModel

EVENTS = ("finish", "enable", "set_priority", "start_by_hand", "enable_goal", "hold", "remove", "set_plan")
"""Methods of a network."""


class Draw:
    """Draws pieces of a model; continuous numbers, so that nothing ties by accident, and the special ones."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        facts, numbers = int(rng.integers(1, 4)), int(rng.integers(1, 4))
        self.sensors = [*(Sensor(f"f{k}", "fact") for k in range(facts)), *(Sensor(f"n{k}") for k in range(numbers))]

    def chance(self, probability: float) -> bool:
        return bool(self.rng.random() < probability)

    def one_of(self, *choices: Any) -> Any:
        return choices[self.rng.integers(len(choices))]

    def limits(self) -> dict[str, float]:
        if self.chance(0.8):
            return {}
        low, high = np.sort(self.rng.random(2))
        return {"low": float(low), "high": float(high)}

    def activator(self, fact: bool) -> Activator:
        if fact:
            wanted = self.chance(0.5)
            return self.one_of(Boolean(wanted, **self.limits()), Boolean(wanted), Equal(float(wanted)), Threshold(0.5))
        level, span = self.level(), float(self.rng.uniform(0.5, 6.0))
        return self.one_of(
            Threshold(level, self.chance(0.5), self.one_of(0.0, span), **self.limits()),
            Linear(level, level + self.one_of(-span, span), **self.limits()),
            Linear(level, level + self.one_of(-span, span)),
            Equal(level),
            Greedy(self.chance(0.5), self.one_of(0.0, 1.0)),
        )

    def level(self) -> float:
        return float(self.rng.integers(-4, 5)) if self.chance(0.5) else float(self.rng.uniform(-5.0, 5.0))

    def tree(self, depth: int = 2) -> Tree:
        if depth == 0 or self.chance(0.6):
            sensor = self.one_of(*self.sensors)
            return Condition(sensor.name, self.activator(sensor.kind == "fact"))
        if self.chance(0.35):
            return Negation(self.tree(depth - 1))
        return self.one_of(Conjunction, Disjunction)(*(self.tree(depth - 1) for _ in range(self.rng.integers(1, 4))))

    def preconditions(self) -> tuple[Tree | Optional, ...]:
        trees = [self.tree() for _ in range(self.rng.choice(4, p=[0.25, 0.4, 0.25, 0.1]))]
        return tuple(Optional(tree) if self.chance(0.15) else tree for tree in trees)

    def effects(self) -> tuple[Effect, ...]:
        return tuple(
            Effect(self.one_of(*self.sensors).name, self.one_of(-1.0, 1.0, 0.0, *self.rng.uniform(-1.2, 1.2, 4)))
            for _ in range(self.rng.choice(4, p=[0.1, 0.5, 0.3, 0.1]))
        )

    def behaviour(self, name: str) -> Behaviour:
        others = [Interface(self.preconditions(), self.effects()) for _ in range(self.one_of(0, 0, 0, 2))]
        return Behaviour(
            name,
            self.preconditions(),
            self.effects(),
            ready_threshold=self.one_of(0.8, 0.5, 0.0, 1.0, float(self.rng.random())),
            priority=int(self.rng.integers(0, 3)),
            interruptable=self.chance(0.85),
            timeout=self.one_of(None, None, 0, 2, 4),
            alternatives=others,
        )

    def goal(self, name: str) -> Goal:
        trees = tuple(self.tree() for _ in range(self.one_of(1, 1, 2)))
        level = self.one_of(1.0, 1.0, float(self.rng.random()))
        return Goal(name, trees, int(self.rng.integers(0, 4)), self.chance(0.7), level)

    def settings(self) -> NetworkSettings:
        weights = Weights() if self.chance(0.5) else Weights(*self.rng.uniform(0.0, 1.5, 6).tolist())
        return NetworkSettings(
            self.one_of("default", "uniform"),
            weights,
            self.one_of(0.9, float(self.rng.random())),
            self.one_of(7.0, 1.5, float(self.rng.uniform(0.5, 4.0))),
            self.one_of(0.8, 0.9, float(self.rng.uniform(0.5, 1.0)), 1.0),
            self.one_of(None, 1, 2, 3),
            self.chance(0.3),
        )

    def model(self) -> NetworkModel:
        behaviours = [self.behaviour(f"b{k}") for k in range(self.rng.integers(1, 7))]
        goals = [self.goal(f"g{k}") for k in range(self.rng.integers(1, 4))]
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".*larger than 1")  # on purpose: the rule holds beyond 1 too
            return NetworkModel(self.sensors, behaviours, goals, self.settings())

    def readings(self, before: dict[str, float]) -> dict[str, float]:
        """Some of the sensors change."""
        changed = {
            sensor.name: float(self.chance(0.5)) if sensor.kind == "fact" else self.level()
            for sensor in self.sensors
            if self.chance(0.3)
        }
        return before | changed

    def events(self, model: NetworkModel) -> list[tuple[str, Any, tuple[Any, ...]]]:
        """What happens to the network from outside before a step: (kind, whom, with what)."""
        if self.chance(0.7):
            return []
        kind, behaviour = self.one_of(*EVENTS), self.one_of(*model.behaviours)
        if kind == "remove" and self.chance(0.8):
            return []
        names = [b.name for b in model.behaviours]
        values = {
            "set_priority": (int(self.rng.integers(0, 5)),),
            "hold": (int(self.rng.integers(-1, len(behaviour.alternatives))) if behaviour.alternatives else -1,),
            "set_plan": ([self.one_of(*names) for _ in range(self.rng.integers(0, 5))], int(self.rng.integers(0, 3))),
            "finish": (),
            "remove": (),
        }.get(kind, (self.chance(0.5),))
        whom = self.one_of(*model.goals).name if kind == "enable_goal" else behaviour.name
        return [(kind, whom, values)]
