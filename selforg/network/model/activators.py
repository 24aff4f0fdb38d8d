"""Activators: how a sensor's reading becomes a satisfaction and a wish.

An activator is a description; the rule itself is the compiled `activate`, chosen by the activator's `kind`.
Satisfaction lies in [low, high] (default [0, 1]); the wish in [-1, 1] is the signed size of the change that is wanted
(0: nothing).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from selforg.compiler.decorators import inlined
from selforg.parameters import AtLeastZero, Finite, UpToOne
from selforg.plugins import Promises, are_numbers
from selforg.registry import Registry

BOOLEAN_RULE, THRESHOLD_RULE, LINEAR_RULE, GREEDY_RULE, EQUAL_RULE = range(5)
"""Kinds of activators."""


@dataclass(frozen=True, kw_only=True)
class Activator(ABC):
    """The base of all activators: the satisfaction when it is not fulfilled and when it is.

    A registered activator can be declared in documents: its keys are its fields. One of a new class shares the rule of
    another, by its `kind` and `parameters`.
    """

    promises: ClassVar[Promises] = {
        "__init__": ("a kind that is one of our rules", lambda one, *_: one.kind in range(EQUAL_RULE + 1)),
        "parameters": ("three finite numbers", lambda one, answer: are_numbers(answer, 3)),
    }
    low: UpToOne = 0.0
    high: UpToOne = 1.0
    kind: ClassVar[int]

    def __post_init__(self) -> None:
        if not 0.0 <= self.low <= self.high <= 1.0:
            raise ValueError(f"{type(self).__name__}: expected 0 <= low <= high <= 1, got {self.low} and {self.high}")

    example: ClassVar[Mapping[str, Any]] = {}
    """Arguments with which the contract tests build the class."""

    @property
    @abstractmethod
    def parameters(self) -> tuple[float, float, float]:
        """The two numbers that `activate` needs, and the sign of the wanted change."""

    @property
    def direction(self) -> float:
        """Sign of the wanted change."""
        return self.parameters[2]


ACTIVATORS: Registry[Activator] = Registry("activator", base=Activator)


@ACTIVATORS.register
@dataclass(frozen=True)
class Boolean(Activator):
    """Fulfilled while a fact is `desired`."""

    desired: bool = True
    kind: ClassVar[int] = BOOLEAN_RULE

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Return the desired value as a number, one that is not used, and the sign."""
        return float(self.desired), 0.0, 1.0 if self.desired else -1.0


@ACTIVATORS.register
@dataclass(frozen=True)
class Threshold(Activator):
    """Fulfilled at or above `threshold` (at or below, if not `minimum`).

    The wish is the missing amount, divided by `value_range` and clamped to [-1, 1]; without a range it is +1 or -1.
    """

    threshold: Finite
    minimum: bool = True
    value_range: AtLeastZero = 0.0
    kind: ClassVar[int] = THRESHOLD_RULE

    example: ClassVar[Mapping[str, Any]] = {"threshold": 2.0}

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Return the threshold and the range, in the sensor's unit, and the sign."""
        return self.threshold, self.value_range, 1.0 if self.minimum else -1.0


@ACTIVATORS.register
@dataclass(frozen=True)
class Linear(Activator):
    """Rises from `low` at `zero` to `high` at `full` (which may lie below `zero`)."""

    zero: Finite
    full: Finite
    kind: ClassVar[int] = LINEAR_RULE

    example: ClassVar[Mapping[str, Any]] = {"zero": 1.0, "full": 3.0}

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.zero == self.full:
            raise ValueError(f"Linear: expected different readings zero and full, got {self.zero} for both")

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Return the readings of no and of full satisfaction, and the sign."""
        return self.zero, self.full, 1.0 if self.full > self.zero else -1.0


@ACTIVATORS.register
@dataclass(frozen=True)
class Greedy(Activator):
    """Never fulfilled, always wishes on; with `step_size` 0 fulfilled as well."""

    maximise: bool = True
    step_size: Finite = 1.0
    kind: ClassVar[int] = GREEDY_RULE

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Return the step size, a number that is not used, and the sign."""
        return self.step_size, 0.0, 1.0 if self.maximise else -1.0


@ACTIVATORS.register
@dataclass(frozen=True)
class Equal(Activator):
    """Fulfilled while a reading is exactly `value`."""

    value: Finite
    kind: ClassVar[int] = EQUAL_RULE

    example: ClassVar[Mapping[str, Any]] = {"value": 2.0}

    @property
    def parameters(self) -> tuple[float, float, float]:
        """Return the value, a number that is not used, and the sign."""
        return self.value, 0.0, 1.0


@inlined
def activate(
    kind: int, reading: float, a: float, b: float, low: float, high: float, direction: float
) -> tuple[float, float]:
    """Return satisfaction and wish at one reading; `a`, `b` and `direction` are the activator's `parameters`."""
    if kind == LINEAR_RULE:
        slope = (reading - a) / (b - a)
        satisfaction = min(max(low + slope * (high - low), low), high)
        missing = (b - reading) / abs(b - a)
        wish = min(max(missing, 0.0), 1.0) if direction > 0.0 else min(max(missing, -1.0), 0.0)
        return satisfaction, wish
    if kind == GREEDY_RULE:
        return (1.0 if a == 0.0 else 0.0), direction
    fulfilled = reading == a
    wish = direction
    if kind == THRESHOLD_RULE:
        fulfilled = reading >= a if direction > 0.0 else reading <= a
        if b != 0.0:
            wish = min(max((a - reading) / b, -1.0), 1.0)
    return (high, 0.0) if fulfilled else (low, wish)
