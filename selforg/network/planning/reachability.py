"""Reachability: whether a goal can be reached if nothing is ever lost; if not, there is no plan.

Facts keep every value they ever had and numbers reach everything in the direction in which an action moves them (the
delete relaxation of Bonet and Geffner 2001, doi:10.1016/S0004-3702(01)00108-4). The answer takes a few passes over the
actions, however large the space of states is. Without this test the search would not end where no action serves a goal
and another one raises a counter without bound.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from selforg.network.planning.guards import Guard, GuardedAction


@dataclass
class _Reach:
    """What may hold: facts that may be true or false, numbers between `low` and `high` (None: without bound)."""

    true: int
    false: int
    low: list[int | None]
    high: list[int | None]


def reachable(steps: Sequence[GuardedAction], goal: Guard, bits: int, numbers: tuple[int, ...]) -> bool:
    """Return False if no sequence of `steps` can ever make `goal` hold from this state."""
    reach = _Reach(bits, ~bits, list(numbers), list(numbers))
    waiting = list(steps)
    while not _may_hold(goal, reach):
        allowed = [step for step in waiting if _may_hold(step.guard, reach)]
        if not allowed:
            return False
        for step in allowed:
            _apply(step, reach)
        waiting = [step for step in waiting if step not in allowed]
    return True


def _may_hold(guard: Guard, reach: _Reach) -> bool:
    wants_true, wants_false = guard.mask & guard.want, guard.mask & ~guard.want
    if wants_true & ~reach.true or wants_false & ~reach.false:
        return False
    for slot, crossing, above in guard.tests:
        bound = reach.high[slot] if above else reach.low[slot]
        if bound is not None and (bound >= crossing) is not above:
            return False
    return all(any(_may_hold(option, reach) for option in options) for options in guard.choices)


def _apply(step: GuardedAction, reach: _Reach) -> None:
    reach.true |= step.gain
    reach.false |= ~step.keep
    for slot, change in step.changes:
        (reach.high if change > 0 else reach.low)[slot] = None
