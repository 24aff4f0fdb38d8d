"""The movement rules: what one row makes of the pairs it sees. Each rule stands here once, with all that belongs to it.

To add a rule, write its function below, with the decorator `sums` if it sums one formula over all pairs, else with
`combines`. The decorator numbers the function and returns the `MovementRule` that a mechanism names
(`rule = follow_all`). For the arguments of formulas see `Formula`.

One kernel runs all rules and chooses by these numbers, because a kernel for each rule would have to be compiled for
each.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.compiler.records import Words, Written
from selforg.gradients.choosing import (
    CHOOSE_FARTHEST,
    CHOOSE_LEAST_REACH,
    CHOOSE_MOST_REACH,
    CHOOSE_NEAREST,
    CHOOSE_STRONGEST,
    choose,
)
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_sight
from selforg.mechanisms.kernels.moving import (
    NO_ROOM,
    NOT_AT_ALL,
    OWN_GOAL_RADIUS,
    VIEW_DISTANCE,
    Movements,
    Own,
    Steering,
    add,
    full_length,
    move_row,
    open_steering,
    write_answer,
)
from selforg.potentials import attraction_balch, attraction_ge, repulsion_balch, repulsion_fernandez, repulsion_ge
from selforg.randomness import next_direction

ALL_IN_VIEW = (VIEW_DISTANCE, VIEW_DISTANCE, VIEW_DISTANCE)
ATTRACTIVE_IN_VIEW = (NOT_AT_ALL, NOT_AT_ALL, VIEW_DISTANCE)
ATTRACTIVE_AND_NEAR_REPULSIVE = (OWN_GOAL_RADIUS, NOT_AT_ALL, VIEW_DISTANCE)
BY_REPULSIVE = (True, False, False)  # which gradients in view make a rule active
BY_ANY = (True, True, True)

BALCH, GE = 0, 1  # potentials of chemotaxis

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


@combines()
def wander(row: int, found: int, own: Own, sight: Words[Sight], steering: Written[Steering]) -> bool:
    """Look at no gradient: the sum is a random direction of 1 m/s."""
    s = open_steering(steering)
    s.total[0], s.total[1], s.total[2] = next_direction(s.directions, s.cursor, s.low, row)
    return True


@combines()
def sum_all(row: int, found: int, own: Own, sight: Words[Sight], steering: Written[Steering]) -> bool:
    """Sum one formula over all pairs."""
    m, pairs = open_steering(steering), open_sight(sight).pairs
    x, y, z = 0.0, 0.0, 0.0
    for index in range(found):
        distance = pairs[index, c.PAIR_DISTANCE]
        diffusion, goal = pairs[index, c.PAIR_DIFFUSION], pairs[index, c.PAIR_GOAL_RADIUS]
        sign = pairs[index, c.PAIR_SIGN]
        length = run_formula(m.formula, distance, diffusion, goal, sign, own.goal_radius, own.reach, m.view_distance)
        if distance > 0.0 and length > -np.inf:
            scale = length / distance
            x += scale * pairs[index, c.PAIR_DX]
            y += scale * pairs[index, c.PAIR_DY]
            z += scale * pairs[index, c.PAIR_DZ]
        else:
            add(index, length, own.reach if m.by_own_reach else full_length(index, sight), row, sight, steering)
    m.total[0] += x
    m.total[1] += y
    m.total[2] += z
    return True


@sums(sum_all, looks=ALL_IN_VIEW, by_own_reach=True)
def fernandez(
    distance: float, diffusion: float, goal: float, sign: float, own_goal: float, own_reach: float, view: float
) -> float:
    """Repulsion of Fernandez-Marquez et al. (2013) from what is within the view distance."""
    return -repulsion_fernandez(distance - goal, own_reach, distance) if distance - goal <= view else 0.0


@sums(sum_all, looks=ALL_IN_VIEW, by_own_reach=True)
def repulsion(
    distance: float, diffusion: float, goal: float, sign: float, own_goal: float, own_reach: float, view: float
) -> float:
    """Repulsion of Balch & Hybinette (2000) from everything."""
    return -repulsion_balch(distance - own_goal - goal, diffusion)


# The same formula, of nearer gradients, and by the speeds of the mechanism
avoid_repulsive = repulsion._replace(
    looks=(OWN_GOAL_RADIUS, NOT_AT_ALL, NOT_AT_ALL), wakes=BY_REPULSIVE, by_own_reach=False
)
avoid_all = repulsion._replace(
    looks=(OWN_GOAL_RADIUS, OWN_GOAL_RADIUS, OWN_GOAL_RADIUS), wakes=BY_ANY, by_own_reach=False
)
patrol = avoid_all._replace(random=True)


@sums(sum_all, looks=ATTRACTIVE_AND_NEAR_REPULSIVE, wakes=BY_ANY)
def follow_all(
    distance: float, diffusion: float, goal: float, sign: float, own_goal: float, own_reach: float, view: float
) -> float:
    """Attraction and repulsion of Balch & Hybinette (2000), by the sign of the gradient."""
    clearance = distance - own_goal - goal
    if sign >= 0.0:
        return sign * attraction_balch(clearance, diffusion, distance)
    return -repulsion_balch(clearance, diffusion)


@sums(sum_all, looks=ALL_IN_VIEW, ahead=True)
def exploit(
    distance: float, diffusion: float, goal: float, sign: float, own_goal: float, own_reach: float, view: float
) -> float:
    """Attraction of Ge & Cui (2000) to everything ahead."""
    return attraction_ge(distance - own_goal - goal, diffusion)


@combines(looks=ATTRACTIVE_IN_VIEW)
def follow_one(row: int, found: int, own: Own, sight: Words[Sight], steering: Written[Steering]) -> bool:
    """Follow one chosen gradient by the potentials of Balch & Hybinette (2000); False if none is chosen."""
    pairs = open_sight(sight).pairs
    chosen = choose(open_steering(steering).chooses, pairs, found, own.goal_radius)
    if chosen < 0 or pairs[chosen, c.PAIR_SIGN] == 0.0:
        return False
    distance, diffusion = pairs[chosen, c.PAIR_DISTANCE], pairs[chosen, c.PAIR_DIFFUSION]
    clearance = distance - own.goal_radius - pairs[chosen, c.PAIR_GOAL_RADIUS]
    if pairs[chosen, c.PAIR_SIGN] > 0.0:
        length = attraction_balch(clearance, diffusion, distance)
    else:
        length = -repulsion_balch(clearance, diffusion)
    add(chosen, length, full_length(chosen, sight), row, sight, steering)
    return True


follow_strongest = follow_one._replace(looks=ALL_IN_VIEW, chooses=CHOOSE_STRONGEST)
follow_farthest = follow_one._replace(chooses=CHOOSE_FARTHEST)
follow_least_reach = follow_one._replace(chooses=CHOOSE_LEAST_REACH)
follow_most_reach = follow_one._replace(chooses=CHOOSE_MOST_REACH)


@combines(looks=ATTRACTIVE_AND_NEAR_REPULSIVE, wakes=BY_REPULSIVE, formula=BALCH, chooses=CHOOSE_NEAREST)
def chemotaxis_balch(row: int, found: int, own: Own, sight: Words[Sight], steering: Written[Steering]) -> bool:
    """Add attraction to the nearest attractive gradient and all repulsions; False without any.

    Potentials of Ge & Cui (2000) for `chemotaxis_ge`, of Balch & Hybinette (2000) else and where there is no goal.
    """
    m, pairs = open_steering(steering), open_sight(sight).pairs
    ge = m.formula == GE
    goal = choose(m.chooses, pairs, found, own.goal_radius)
    goal_clearance, contributions = 0.0, 0
    if goal >= 0:
        contributions, diffusion = 1, pairs[goal, c.PAIR_DIFFUSION]
        goal_clearance = pairs[goal, c.PAIR_DISTANCE] - own.goal_radius - pairs[goal, c.PAIR_GOAL_RADIUS]
        pull = attraction_balch(goal_clearance, diffusion, pairs[goal, c.PAIR_DISTANCE])
        if ge:
            pull = attraction_ge(goal_clearance, diffusion)
        add(goal, pull, 0.0, row, sight, steering)
    for index in range(found):
        if pairs[index, c.PAIR_SIGN] >= 0.0:
            continue
        contributions += 1
        clearance = pairs[index, c.PAIR_DISTANCE] - own.goal_radius - pairs[index, c.PAIR_GOAL_RADIUS]
        away, to_goal = repulsion_balch(clearance, pairs[index, c.PAIR_DIFFUSION]), 0.0
        if ge and goal >= 0:
            away, to_goal = repulsion_ge(clearance, pairs[index, c.PAIR_DIFFUSION], goal_clearance)
            if pairs[goal, c.PAIR_DISTANCE] > 0.0:
                add(goal, to_goal, 0.0, row, sight, steering)
        add(index, -away, full_length(index, sight), row, sight, steering)
    return contributions > 0


chemotaxis_ge = chemotaxis_balch._replace(formula=GE)


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


run_formula = by_number(FORMULAS)
combine = by_number(COMBINATIONS)


@lean_kernel
def move_rows(
    now: float,
    rows: Ints,
    places: Ints,
    movements: Words[Movements],
    sight: Words[Sight],
    steering: Written[Steering],
    poses: Words[Poses],
    store: Written[Store],
) -> int:
    """Write the movement of `rows` (R,) into the rows `places` (R,) of `movements`.

    Returns how many rows are done, fewer than R if the room for pairs is too short for the next one.
    """
    for index in range(len(rows)):
        row = int(rows[index])
        moves = move_row(row, now, combine, sight, steering, poses, store)
        if moves == NO_ROOM:
            return index
        write_answer(places[index], moves, movements, steering)
    return len(rows)
