"""Planning for several goals that may not be reachable together: all of them, then fewer, by priority."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from selforg.network.planning.search import Answer, Plan, Search, Unsolvable

MOST_GOALS_COMBINED = 10
"""Up to here every subset is tried in order; of more goals, one after the other is given up (2^10 searches at most)."""


@dataclass(frozen=True)
class PriorityPlan:
    """The outcome for the best set of goals that has a plan: `goals` are those it reaches, `given_up` the others.

    Without a plan for any goal `outcome` is `Unsolvable`, or `Unknown` if a search gave up; `goals` is then empty.
    `proved`: every set that was tried in vain is proved unsolvable. `attempts`: how many sets were searched; the
    original counts each as a call of its planner.
    """

    outcome: Answer
    goals: tuple[int, ...]
    given_up: tuple[int, ...]
    proved: bool = True
    attempts: int = 0


def plan_by_priority(
    search: Search,
    facts: npt.NDArray[np.bool_],
    numbers: npt.NDArray[np.float64],
    goals: Sequence[int] | None = None,
) -> PriorityPlan:
    """Return a plan for all goals together, else for the best set of goals that has one.

    After the whole set, sets are tried by falling sum of priorities, then falling size, then in the order in which the
    goals are registered: the goals with the lowest priorities are given up first. Goals that hold already cost nothing
    by themselves and stay in the set, so that a plan does not destroy them. A set that contains one already proved
    unsolvable is not searched again.

    Args:
        search: the planner with its problem.
        facts: (F,) bool, the facts as they are now.
        numbers: (K,) float, the readings as they are now, finite.
        goals: indices of the goals wanted now; None: all of the problem.

    """
    wanted = tuple(range(len(search.problem.goals))) if goals is None else tuple(sorted(set(goals)))
    state = search.read_state(facts, numbers)
    unsolvable: list[set[int]] = []
    failure: Answer = Unsolvable()
    attempts = 0
    for chosen in goal_sets(wanted, [search.problem.goals[goal].priority for goal in wanted]):
        if any(known.issubset(chosen) for known in unsolvable):
            continue
        attempts += 1
        outcome = search.plan_from(state, chosen)
        if isinstance(outcome, Plan):
            given_up = tuple(goal for goal in wanted if goal not in chosen)
            return PriorityPlan(outcome, chosen, given_up, isinstance(failure, Unsolvable), attempts)
        if isinstance(outcome, Unsolvable):
            unsolvable.append(set(chosen))
        else:
            failure = outcome
    return PriorityPlan(failure, (), wanted, isinstance(failure, Unsolvable), attempts)


def goal_sets(goals: tuple[int, ...], priorities: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Yield sets of goals in the order in which they are tried, the whole set first, each without repetition."""
    yield goals
    importance = dict(zip(goals, priorities, strict=True))
    if len(goals) > MOST_GOALS_COMBINED:
        kept = sorted(goals, key=lambda goal: (-importance[goal], goal))
        for size in range(len(kept) - 1, 0, -1):
            yield tuple(sorted(kept[:size]))
        return
    sets = [chosen for size in range(1, len(goals)) for chosen in combinations(goals, size)]
    yield from sorted(sets, key=lambda chosen: (-sum(importance[goal] for goal in chosen), -len(chosen), chosen))
