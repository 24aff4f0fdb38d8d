"""Evaporation of one stored gradient: exact time (lazy, path independent) or whole seconds (eager, as the original).

Exact time: the diffusion is a pure function of the clock, and is computed when a gradient is looked at. Whole seconds:
the diffusion depends on when the buffer was used (Q3); every operation evaporates everything, and NEAR_DUE is never
set.
"""

import numpy as np

from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Handle, Written
from selforg.elementary import whole_power
from selforg.gradients.store import columns as c
from selforg.gradients.store.linking import remove
from selforg.gradients.store.records import Store, open_store
from selforg.grid import MOST_CELLS


@part
def start_evaporation(slot: int, now: float, store: Written[Store]) -> None:
    """Set FAR_START and NEAR_DUE of an incoming gradient, then evaporate it up to `now` [s]."""
    s = open_store(store)
    s.far[slot, c.FAR_START] = s.near[slot, c.DIFFUSION]
    s.near[slot, c.NEAR_DUE] = np.inf
    if s.whole_seconds and s.far[slot, c.FAR_PERIOD] > 0.0:
        evaporate_whole_seconds(slot, now, store)  # whatever the factor (B8)
    elif s.far[slot, c.FAR_FACTOR] >= 1.0:
        return
    elif s.far[slot, c.FAR_PERIOD] <= 0.0:
        s.near[slot, c.DIFFUSION] = 0.0
        s.far[slot, c.FAR_START] = 0.0
    else:
        s.near[slot, c.NEAR_DUE] = s.far[slot, c.FAR_CLOCK] + s.far[slot, c.FAR_PERIOD]
        if now >= s.near[slot, c.NEAR_DUE]:
            evaporate(slot, now, store)


@part
def evaporate(slot: int, now: float, store: Written[Store]) -> None:
    """Evaporate a gradient that is due up to `now` [s], in exact time."""
    s = open_store(store)
    clock, period = s.far[slot, c.FAR_CLOCK], s.far[slot, c.FAR_PERIOD]
    periods = np.floor((now - clock) / period)
    # the division may round across a whole number; the product decides, because NEAR_DUE is a product too
    if clock + periods * period > now:
        periods -= 1.0
    elif clock + (periods + 1.0) * period <= now:
        periods += 1.0
    s.near[slot, c.DIFFUSION] = evaporated(s.far[slot, c.FAR_START], s.far[slot, c.FAR_FACTOR], periods)
    s.near[slot, c.NEAR_DUE] = clock + (periods + 1.0) * period


@part
def evaporate_whole_seconds(slot: int, now: float, store: Written[Store]) -> None:
    """Evaporate a gradient up to `now` [s] as the original does: only the whole seconds of its age count."""
    s = open_store(store)
    if s.far[slot, c.FAR_PERIOD] <= 0.0:
        return
    age = now - s.far[slot, c.FAR_CLOCK]
    if age < s.far[slot, c.FAR_PERIOD]:
        return
    periods = np.floor(np.floor(age) / s.far[slot, c.FAR_PERIOD])
    s.near[slot, c.DIFFUSION] = evaporated(s.near[slot, c.DIFFUSION], s.far[slot, c.FAR_FACTOR], periods)
    s.far[slot, c.FAR_CLOCK] += periods * s.far[slot, c.FAR_PERIOD]


@inlined
def evaporated(diffusion: float, factor: float, periods: float) -> float:
    """Return a diffusion [m] after `periods`; an infinite one stays until a factor of 0 ends it."""
    if np.isinf(diffusion):
        return 0.0 if factor == 0.0 and periods > 0.0 else diffusion
    return float(diffusion * whole_power(factor, periods))


@inlined
def evaporated_away(slot: int, store: Handle[Store]) -> bool:
    """Return whether nothing is left of a gradient: no goal area and less diffusion than the least that is kept."""
    s = open_store(store)
    return bool(s.near[slot, c.GOAL_RADIUS] == 0.0 and s.near[slot, c.DIFFUSION] < s.min_diffusion)


@part
def still_there(slot: int, now: float, store: Written[Store]) -> bool:
    """Bring a stored gradient to `now` [s] if it is due; False if it evaporated away, it is removed then."""
    s = open_store(store)
    if now >= s.near[slot, c.NEAR_DUE]:
        evaporate(slot, now, store)
        if evaporated_away(slot, store):
            layer = s.links[slot, c.LINK_LAYER]
            s.layers[layer, c.LAYER_GONE] = min(s.layers[layer, c.LAYER_GONE] + 1, MOST_CELLS)
            remove(slot, store)
            return False
    return True
