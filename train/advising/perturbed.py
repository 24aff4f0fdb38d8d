"""Perturbed worlds: the mission as it might be with real robots, to see whether a choice holds outside the simulator.

Each world has messages that get lost or come late, errors of poses, wheels that slip, and other speeds, all drawn at
once. Such "pseudo-realities" tell in simulation alone which choices would suffer from the gap to reality (Ligot and
Birattari 2020, Simulation-only experiments to mimic the effects of the reality gap in the automatic design of robot
swarms, doi 10.1007/s11721-019-00175-w).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.robots import RobotModel
from clean_swarm_env.config.tasks import with_changes
from selector.documents.errors import validated
from selforg.arrays import Flags, Floats
from train.analysis.intervals import Ratio

WORLDS, STARTS = 10, 10
"""Perturbed worlds, and starts in each."""
ARMS = 8
"""Strategies of the last round, coarsely, before they are known."""
HOLDS_UP_TO = 1.1
"""Times the cost of the best of a world up to which a choice holds there."""
MOST_DELAY = 2
"""Control periods by which messages are late at most."""
STRONGEST = {"loss": 0.5, "pose_noise": 0.2, "pose_drift": 0.8, "slip": 0.2, "speed": 0.2}
"""Largest value of what is drawn evenly from 0 on: errors of poses in radii of the robot, others as shares; robots are
faster or slower by `speed`."""
DRAWN = 0xFFFFFFF5
"""Spawn key of the draws of a world; other streams have other keys."""
IN_WORLD = ", world "
"""Stands between an arm and the number of the world, in the conditions of runs."""


def drawn_world(seed: int, number: int) -> dict[str, float]:
    """Return the numbers of world `number` (from 1); `delay` in control periods, `speed` as a factor."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(DRAWN, number)))
    own = {name: float(np.round(rng.uniform(0.0, most), 3)) for name, most in STRONGEST.items()}
    side = float(rng.choice((-1.0, 1.0)))
    return {"delay": float(rng.integers(MOST_DELAY + 1)), **own, "speed": round(1.0 + side * own["speed"], 3)}


def perturbed(mission: MissionConfig, seed: int, number: int) -> MissionConfig:
    """Return a mission in world `number` (from 1): with errors beside those that it has, also after its events."""
    drawn, robots = drawn_world(seed, number), mission.robots

    def erring(model: RobotModel) -> dict[str, float]:
        sizes = {"pose_noise": model.radius, "pose_drift": model.radius, "slip": 1.0}
        errors = {key: float(np.hypot(getattr(model, key), drawn[key] * size)) for key, size in sizes.items()}
        return errors | {key: getattr(model, key) * drawn["speed"] for key in ("max_speed", "max_turn_rate")}

    def lost(loss: float) -> float:
        return 1.0 - (1.0 - loss) * (1.0 - drawn["loss"])

    events = [one.model_dump() for one in mission.events]
    groups = [{**model.model_dump(), **erring(model)} for model in robots.groups]
    changes = {
        "robots": {"groups": groups} if groups else erring(robots),
        "delivery": {
            "loss": lost(mission.delivery.loss),
            "delay": mission.delivery.delay + drawn["delay"] / mission.world.control_rate,
        },
        "events": [{**one, "loss": lost(one["loss"])} if one["do"] == "deliver" else one for one in events],
    }
    whole = with_changes(mission.model_dump(), changes)
    return validated(MissionConfig, whole, f"world {number}", own=True)


@dataclass(frozen=True)
class Robustness:
    """What the arms of an advice cost in perturbed worlds. Shapes: P worlds, n starts of each."""

    held: str
    """The arm that is held."""
    costs: Mapping[str, Floats]
    """Arm -> excess (P, n) of its missions [s]."""
    usual: Floats
    """(n,) excess of the held arm on the same starts in the mission as it is [s]."""

    @cached_property
    def means(self) -> dict[str, Floats]:
        """Arm -> mean excess (P,) [s]."""
        return {arm: own.mean(axis=1) for arm, own in self.costs.items()}

    @cached_property
    def best(self) -> list[str]:
        """(P,) the cheapest arm of each world."""
        arms = list(self.means)
        return [arms[place] for place in np.argmin(list(self.means.values()), axis=0)]

    @property
    def holds(self) -> Flags:
        """(P,) whether the held arm costs about as little as the best one of the world."""
        least = np.min(list(self.means.values()), axis=0)
        return np.asarray(self.means[self.held] - least <= (HOLDS_UP_TO - 1.0) * np.abs(least))

    @property
    def ratio(self) -> Ratio:
        """The ratio of the held arm's costs to those in the mission as it is; its interval is over worlds."""
        return Ratio.of(self.means[self.held], np.full(len(self.best), self.usual.mean()))

    @property
    def content(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        excess = {arm: own.round(3).tolist() for arm, own in self.means.items()}
        return {"holds": self.holds.tolist(), "ratio": self.ratio.content, "excess_s": excess}
