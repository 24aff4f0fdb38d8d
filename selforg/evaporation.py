"""Evaporation of one stored gradient: exact time (lazy, path independent) or whole seconds (eager, as the original).

Exact time: the diffusion is a pure function of the clock, so it may be worked out whenever somebody looks. Whole
seconds depend on when the buffer was touched (Q3); every operation then evaporates everything, and DUE is never set.

`numbers` is the table of stored gradients, (M, GRADIENT_COLUMNS).
"""

import numpy as np

from selforg.arrays import Floats
from selforg.columns import CLOCK, DIFFUSION, DUE, FACTOR, GOAL, PERIOD, START
from selforg.compiled import kernel


@kernel
def start_evaporation(numbers: Floats, slot: int, now: float, whole_seconds: bool) -> None:
    """Set START and DUE of an incoming gradient, then evaporate it up to `now` [s]."""
    numbers[slot, START] = numbers[slot, DIFFUSION]
    numbers[slot, DUE] = np.inf
    if numbers[slot, FACTOR] >= 1.0:
        return
    if numbers[slot, PERIOD] <= 0.0:
        numbers[slot, DIFFUSION] = 0.0
        numbers[slot, START] = 0.0
    elif whole_seconds:
        evaporate_whole_seconds(numbers, slot, now)
    else:
        numbers[slot, DUE] = numbers[slot, CLOCK] + numbers[slot, PERIOD]
        if now >= numbers[slot, DUE]:
            evaporate(numbers, slot, now)


@kernel
def evaporate(numbers: Floats, slot: int, now: float) -> None:
    """Bring a gradient with `now` >= DUE to `now` [s], exactly."""
    clock, period = numbers[slot, CLOCK], numbers[slot, PERIOD]
    periods = np.floor((now - clock) / period)
    # the division may round across a whole number, the product (which is what DUE holds) decides
    if clock + periods * period > now:
        periods -= 1.0
    elif clock + (periods + 1.0) * period <= now:
        periods += 1.0
    numbers[slot, DIFFUSION] = numbers[slot, START] * numbers[slot, FACTOR] ** periods
    numbers[slot, DUE] = clock + (periods + 1.0) * period


@kernel
def evaporate_whole_seconds(numbers: Floats, slot: int, now: float) -> None:
    """Bring a gradient to `now` [s] as the original does: only the whole seconds of its age count."""
    if numbers[slot, FACTOR] >= 1.0 or numbers[slot, PERIOD] <= 0.0:
        return
    age = now - numbers[slot, CLOCK]
    if age < numbers[slot, PERIOD]:
        return
    periods = np.floor(np.floor(age) / numbers[slot, PERIOD])
    numbers[slot, DIFFUSION] *= numbers[slot, FACTOR] ** periods
    numbers[slot, CLOCK] += periods * numbers[slot, PERIOD]


@kernel
def evaporated_away(numbers: Floats, slot: int, min_diffusion: float) -> bool:
    """Tell whether nothing is left of a gradient: no goal area and less diffusion than `min_diffusion` [m]."""
    return bool(numbers[slot, GOAL] == 0.0 and numbers[slot, DIFFUSION] < min_diffusion)
