"""Fronts: what strategies cost over a range of prices of a collision, and which of them none of the others beats.

Shapes: P prices, K scenarios, V world seeds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.mission_end import mission_cost

PRICES = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Prices of a collision event [s]; the price of contacts keeps its ratio to it."""


@dataclass(frozen=True)
class Front:
    """Strategies over a range of prices."""

    excesses: Mapping[str, tuple[float, ...]]
    """Label -> (P,) mean excess at each of PRICES [s]."""
    events: Mapping[str, float]
    """Label -> mean number of collision events."""

    @property
    def undominated(self) -> tuple[str, ...]:
        """Strategies than which no other has both less time and fewer events; time is the excess at the price 0."""
        points = {label: (self.excesses[label][0], events) for label, events in self.events.items()}
        return tuple(
            label
            for label, (time, events) in points.items()
            if not any(t <= time and e <= events and (t, e) != (time, events) for t, e in points.values())
        )

    def best_at(self, price: float) -> str:
        """Return the strategy of the lowest excess at one of PRICES."""
        place = PRICES.index(price)
        return min(self.excesses, key=lambda label: self.excesses[label][place])


def priced_excess(mission: MissionConfig, result: MissionResult, price: float) -> float:
    """Return the excess cost [s] of a mission if a collision event cost `price` [s]."""
    contact = mission.contact_cost / mission.collision_cost if mission.collision_cost > 0.0 else 0.0
    priced = mission.model_copy(update={"collision_cost": price, "contact_cost": contact * price})
    time = max(result.ticks, 1) / mission.world.control_rate
    events = round(result.collision_events_per_s[0] * time)
    samples = round(result.collision_samples_per_s[0] * time)
    return mission_cost(priced, result.duration_s, events, samples, result.garbage_done) - result.unavoidable_s
