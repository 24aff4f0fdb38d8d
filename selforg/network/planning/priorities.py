"""Planning for several goals that may not be reachable together: all of them, then fewer, by priority."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from selforg.network.planning.search import Answer, Plan, Search, State, Unsolvable

MOST_GOALS_COMBINED = 10
"""Up to this number of goals, all subsets are tried (2^10 searches at most); of more, goals are given up one by one."""


@dataclass(frozen=True)
class PriorityPlan:
    """The outcome for the best set of goals that has a plan; `goals` are those that the plan reaches.

    Without a plan for any goal `outcome` is `Unsolvable`, or `Unknown` if a search gave up; `goals` is then empty.
    `proved`: every set that was tried in vain is proved unsolvable.
    """

    outcome: Answer
    goals: tuple[int, ...]
    proved: bool = True


def plan_by_priority(search: Search, state: State, goals: tuple[int, ...]) -> PriorityPlan:
    """Return a plan for all goals together, else for the best set of goals that has one.

    After the whole set, sets are tried by falling sum of priorities, then falling size, then in the order in which the
    goals are registered: the goals with the lowest priorities are given up first. Goals that hold already cost nothing
    by themselves and stay in the set, so that a plan does not destroy them. A set that contains a set already proved
    unsolvable is not searched.

    Args:
        search: the planner with its problem.
        state: facts and numbers as they are now, from `read_state`.
        goals: indices of the goals wanted now, rising.

    """
    unsolvable: list[set[int]] = []
    failure: Answer = Unsolvable()
    for chosen in goal_sets(goals, [search.problem.goals[goal].priority for goal in goals]):
        if any(known.issubset(chosen) for known in unsolvable):
            continue
        outcome = search.plan_from(state, chosen)
        if isinstance(outcome, Plan):
            return PriorityPlan(outcome, chosen, isinstance(failure, Unsolvable))
        if isinstance(outcome, Unsolvable):
            unsolvable.append(set(chosen))
        else:
            failure = outcome
    return PriorityPlan(failure, (), isinstance(failure, Unsolvable))


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
