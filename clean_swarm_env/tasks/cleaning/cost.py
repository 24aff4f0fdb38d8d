"""What a cleaning mission costs: seconds, the price of its collisions, and items that are left.

`docs/environment.md#what-a-mission-costs` says why. The reward of learners adds up to the same numbers.
"""

from typing import Final, NamedTuple

from clean_swarm_env.config.events import Land, Respawn, happening
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import expected_items, items_keep_coming, items_of
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings, settings_of
from selforg.compiler.decorators import part

LEFT_LIMITS: Final = 2.0
"""Price of an item that is left, in time limits; all collisions of a mission together cost less."""
NO_ITEM: Final = 0.3
"""Items that count as dumped where none was; less than 1/3, so that a first item pays whatever collisions cost."""


class CostTerms(NamedTuple):
    """The prices of one mission."""

    event: float  # of a collision event at the first distance [s]
    sample: float  # of a pair closer than it, at one count [s]
    limit: float  # time limit [s]
    left: float  # of an item that is left at the end [s]
    items: float  # items that come altogether; 0 where garbage keeps coming
    worth: float  # of an item dumped where garbage keeps coming, for the reward [s]


EVENT, SAMPLE, LIMIT, LEFT, ITEMS, WORTH = range(6)
"""Columns of arrays of `CostTerms`."""


def cost_terms(mission: MissionConfig) -> CostTerms:
    """Return the prices of a mission."""
    price = 1.0 - settings_of(mission).consequences.harmless if isinstance(mission.task, CleaningSettings) else 1.0
    event, sample = price * mission.collision_cost, price * mission.contact_cost / mission.world.physics_rate
    if items_keep_coming(mission):
        return CostTerms(event, sample, mission.time_limit, 0.0, 0.0, mission.time_limit / max(_coming(mission), 1.0))
    left = LEFT_LIMITS * mission.time_limit
    return CostTerms(event, sample, mission.time_limit, left, float(expected_items(mission)), 0.0)


@part
def collision_price(priced: float, limit: float) -> float:
    """Return what collisions cost [s] that are priced at `priced` [s] one by one.

    Up to the time `limit` [s] the price is their sum. Beyond it each further collision costs less, so that all of them
    cost less than two limits.
    """
    return priced if priced <= limit else limit * (2.0 - limit / priced)


def collisions_cost(mission: MissionConfig, events: int, samples: int) -> float:
    """Return what `events` at the first distance cost, and `samples`: pairs closer than it, at all counts [s]."""
    terms = cost_terms(mission)
    return collision_price(terms.event * events + terms.sample * samples, terms.limit)


def mission_cost(mission: MissionConfig, duration: float, events: int, samples: int, done: int) -> float:
    """Return what a mission cost [s].

    Its `duration` [s], the price of its collisions, and two time limits for each item that was not `done`. Where
    garbage keeps coming, all missions last equally long: there the cost is for each item done.
    Costs that could be gamed: docs/decisions/0111-bounded-cost.md.

    Args:
        mission: the mission.
        duration: time at which the last item was dumped, or the time limit [s].
        events: collision events at the first distance.
        samples: pairs closer than it, at all counts together.
        done: items dumped.

    """
    terms, cost = cost_terms(mission), duration + collisions_cost(mission, events, samples)
    if items_keep_coming(mission):
        return cost / max(done, NO_ITEM)
    return cost + terms.left * max(terms.items - done, 0.0)


def unavoidable_cost(mission: MissionConfig, came: int) -> float:
    """Return the part of the cost that no team could avoid, because of the arrival times of garbage [s].

    Where garbage keeps coming, no team dumps more items than `came`. Elsewhere none is done before the last one lands.
    """
    if items_keep_coming(mission):
        return mission.time_limit / max(came, NO_ITEM)
    landings = (event.at for event in mission.events if isinstance(event, Land))
    return min(max(landings, default=0.0), mission.time_limit)


def _coming(mission: MissionConfig) -> float:
    """Return the number of items that are expected to come within the time limit."""
    events = happening(mission.events, mission.time_limit)
    changes = [(min(at, mission.time_limit), event.rate) for at, event in events if isinstance(event, Respawn)]
    times = [0.0, *(at for at, _ in changes), mission.time_limit]
    rates = [items_of(mission).respawn, *(rate for _, rate in changes)]
    arriving = sum(rate * (times[k + 1] - times[k]) / 60.0 for k, rate in enumerate(rates))
    return expected_items(mission) + arriving
