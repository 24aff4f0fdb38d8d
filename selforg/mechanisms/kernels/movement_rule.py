"""How a movement rule is declared: with decorators that number its function, and say what else belongs to the rule.

One kernel runs all rules and chooses by these numbers, because a kernel for each rule would have to be compiled for
each. The rules themselves are in `selforg.mechanisms.kernels.rules`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Words
from selforg.gradients.choosing import CHOOSE_NEAREST
from selforg.gradients.store.records import Sight
from selforg.mechanisms.kernels.steering import Own, Steering

# How far beyond its reach a gradient can make a rule different from zero
NOT_AT_ALL = 0
OWN_GOAL_RADIUS = 1  # as far as Balch and Ge repulsion: they are zero where the clearance exceeds the diffusion
VIEW_DISTANCE = 2

Formula: TypeAlias = Callable[[float, float, float, float, float, float, float], float]
"""(distance, diffusion, goal radius [m], attraction [-], own goal radius, own reach, view distance [m]) -> length [m or
-] of a contribution: towards the gradient if positive; negative infinity is full repulsion."""
Combination: TypeAlias = Callable[[int, int, Own, Words[Sight], Words[Steering]], bool]
"""(row, number of pairs, own radii, sight, steering) -> whether any gradient contributes; adds to the sum."""

FORMULAS: list[Formula] = []
COMBINATIONS: list[Combination] = []


class MovementRule(NamedTuple):
    """What a movement rule is, for the kernel that runs all rules.

    Attributes:
        combination: number of the function that makes a vector of pairs.
        formula: number of the formula that the combination sums; of chemotaxis: whose potentials.
        looks: how far, for attractions -1, 0, +1: NOT_AT_ALL, OWN_GOAL_RADIUS or VIEW_DISTANCE.
        wakes: whether a gradient in view, of attraction -1, 0, +1, makes the rule active though it adds nothing.
        by_own_reach: full repulsion and the longest vector are the own reach, not the gradient's and the highest speed.
        random: where the sum is zero the direction is random, at the highest speed.
        ahead: only pairs within the view angles count.
        chooses: rule of `selforg.gradients.choosing` by which one gradient is followed.

    """

    combination: int
    formula: int = 0
    looks: tuple[int, int, int] = (NOT_AT_ALL, NOT_AT_ALL, NOT_AT_ALL)
    wakes: tuple[bool, bool, bool] = (False, False, False)
    by_own_reach: bool = False
    random: bool = False
    ahead: bool = False
    chooses: int = CHOOSE_NEAREST


def combines(**fields: Any) -> Callable[[Combination], MovementRule]:  # noqa: ANN401  (the fields of MovementRule)
    """Make a function from pairs to a vector a movement rule, as a decorator; `fields` are those of `MovementRule`."""

    def entered(combination: Combination) -> MovementRule:
        COMBINATIONS.append(part(combination))
        return MovementRule(len(COMBINATIONS) - 1, **fields)

    return entered


def sums(combination: MovementRule, **fields: Any) -> Callable[[Formula], MovementRule]:  # noqa: ANN401  (likewise)
    """Make a formula of one pair a movement rule, as a decorator; `combination` is the rule that sums formulas."""

    def entered(formula: Formula) -> MovementRule:
        FORMULAS.append(inlined(formula))
        return combination._replace(formula=len(FORMULAS) - 1, **fields)

    return entered


def by_number(functions: list[Any]) -> Callable[..., Any]:
    """Return a compiled function that takes a number and arguments, and calls the function of that number.

    functions: two or more, which take the same arguments and return the same type.
    """
    *others, last = functions
    before, here = by_number(others) if len(others) > 1 else without_number(others[0]), len(others)

    @inlined
    def called(number, *arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN002, ANN202
        return last(*arguments) if number == here else before(number, *arguments)

    return called


def without_number(function: Any) -> Callable[..., Any]:  # noqa: ANN401  (compiled code)
    """Return a compiled function that takes a number and calls `function` with the other arguments."""

    @inlined
    def called(number, *arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN002, ANN202
        return function(*arguments)

    return called
