"""What a selector is rewarded for: the mission's cost, in parts that are named and weighted, and shaping terms.

The shaping terms are plain counts. They are not differences of a potential, so that they may change which behaviour is
best: a robot paid for picking could carry things about. They are 0 unless asked for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.progress import (
    AVOIDING,
    COLLISION,
    COMPLETED,
    CONTACT,
    DUMPED,
    EVENTS,
    PICKED,
    RECYCLED,
    Progress,
)
from selector.documents.fields import Closed, Number, Share
from selforg.compiler.decorators import kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


class RewardConfig(Closed):
    """Weights of the reward's terms; each robot gets their sum once a decision period."""

    dumped: Number = 1.0
    """For each item dumped by the team [1/item]."""
    time: Number = -0.01
    """For each second that passed before the mission was over [1/s]."""
    collision: Number = -0.1
    """For each collision event in which the robot took part [1/event]."""
    completed: Number = 0.0
    """Once, when all garbage is dumped [-]."""
    own_picked: Number = 0.0
    """Shaping: for each item that the robot picked [1/item]."""
    own_recycled: Number = 0.0
    """Shaping: for each item that the robot recycled [1/item]."""
    own_dumped: Number = 0.0
    """Shaping: for each item that the robot itself dumped [1/item]."""
    contact: Number = 0.0
    """Shaping: for each second in which somebody was closer than the collision distance [1/s]."""
    avoiding: Number = 0.0
    """Shaping: for each second in which the robot avoided others [1/s]."""
    shared: Share = 0.0
    """Share of a robot's own terms (collisions and shaping) that goes to all robots of its world alike [-]."""


class Rewards:
    """Rewards (R,) of a batch of worlds, from what its progress counted in a period.

    Attributes:
        own: (E,) weight of each kind of event of a robot, in the order of EVENTS.

    """

    def __init__(self, config: RewardConfig, period: float) -> None:
        """`period` [s]: of one tick."""
        self.config = config
        self._period = period
        self.own: Floats = np.zeros(len(EVENTS))
        self.own[[PICKED, RECYCLED, DUMPED, COLLISION]] = (
            config.own_picked, config.own_recycled, config.own_dumped, config.collision,
        )  # fmt: skip
        self.own[[CONTACT, AVOIDING]] = config.contact * period, config.avoiding * period

    def of(self, progress: Progress, rewards: Floats) -> None:
        """Fill `rewards` (R,) with those of the period that `progress` counted; who took no part in it gets none."""
        config = self.config
        add_up(
            self.own, progress.events, progress.ticks, progress.dumped, progress.outcome, progress.took_part,
            config.dumped, config.time * self._period, config.completed, config.shared, rewards,
        )  # fmt: skip


@kernel
def add_up(
    own: Floats, events: Ints, ticks: Ints, dumped: Ints, outcome: Ints, took_part: Flags, for_dumped: float,
    for_tick: float, for_completing: float, shared: float, rewards: Floats,
) -> None:  # fmt: skip
    """Fill `rewards` (R,); see `RewardConfig`. ticks, dumped and outcome (W,) of the period, events (E, R)."""
    robots = rewards.shape[0] // ticks.shape[0]
    for world in range(ticks.shape[0]):
        team = for_dumped * dumped[world] + for_tick * ticks[world]
        if outcome[world] == COMPLETED and ticks[world] > 0:
            team += for_completing
        total, members = 0.0, 0
        for row in range(world * robots, (world + 1) * robots):
            rewards[row] = 0.0
            if not took_part[row]:
                continue
            for kind in range(own.shape[0]):
                rewards[row] += own[kind] * events[kind, row]
            total += rewards[row]
            members += 1
        for row in range(world * robots, (world + 1) * robots):
            if took_part[row]:
                rewards[row] = team + (1.0 - shared) * rewards[row] + shared * total / members
