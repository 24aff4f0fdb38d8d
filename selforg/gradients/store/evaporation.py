"""Evaporation of one stored gradient: exact time (lazy, path independent) or whole seconds (eager, as the original).

Exact time: the diffusion is a pure function of the clock, so it may be worked out whenever somebody looks. Whole
seconds depend on when the buffer was touched (Q3); every operation then evaporates everything, and DUE is never set.

`near` and `far` are the rows of stored gradients, see `selforg.gradients.store.columns`.
"""

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import part
from selforg.gradients.store.columns import CLOCK, DIFFUSION, DUE, FACTOR, GOAL, PERIOD, START


@part
def start_evaporation(near: Floats, far: Floats, slot: int, now: float, whole_seconds: bool) -> None:
    """Set START and DUE of an incoming gradient, then evaporate it up to `now` [s]."""
    far[slot, START] = near[slot, DIFFUSION]
    near[slot, DUE] = np.inf
    if far[slot, FACTOR] >= 1.0:
        return
    if far[slot, PERIOD] <= 0.0:
        near[slot, DIFFUSION] = 0.0
        far[slot, START] = 0.0
    elif whole_seconds:
        evaporate_whole_seconds(near, far, slot, now)
    else:
        near[slot, DUE] = far[slot, CLOCK] + far[slot, PERIOD]
        if now >= near[slot, DUE]:
            evaporate(near, far, slot, now)


@part
def evaporate(near: Floats, far: Floats, slot: int, now: float) -> None:
    """Bring a gradient with `now` >= DUE to `now` [s], exactly."""
    clock, period = far[slot, CLOCK], far[slot, PERIOD]
    periods = np.floor((now - clock) / period)
    # the division may round across a whole number, the product (which is what DUE holds) decides
    if clock + periods * period > now:
        periods -= 1.0
    elif clock + (periods + 1.0) * period <= now:
        periods += 1.0
    near[slot, DIFFUSION] = far[slot, START] * far[slot, FACTOR] ** periods
    near[slot, DUE] = clock + (periods + 1.0) * period


@part
def evaporate_whole_seconds(near: Floats, far: Floats, slot: int, now: float) -> None:
    """Bring a gradient to `now` [s] as the original does: only the whole seconds of its age count."""
    if far[slot, FACTOR] >= 1.0 or far[slot, PERIOD] <= 0.0:
        return
    age = now - far[slot, CLOCK]
    if age < far[slot, PERIOD]:
        return
    periods = np.floor(np.floor(age) / far[slot, PERIOD])
    near[slot, DIFFUSION] *= far[slot, FACTOR] ** periods
    far[slot, CLOCK] += periods * far[slot, PERIOD]


@part
def evaporated_away(near: Floats, slot: int, min_diffusion: float) -> bool:
    """Tell whether nothing is left of a gradient: no goal area and less diffusion than `min_diffusion` [m]."""
    return bool(near[slot, GOAL] == 0.0 and near[slot, DIFFUSION] < min_diffusion)
